"""Normalisation of contexts and actions, and the scaling of latent actions to inputs."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.context import GRIPPER, OBJECT, OBJECTS, OBJECTS_IN_TOOL, ContextLayout
from latentarm.core.types import BoolArray, FloatArray

CONSTANT_SPREAD: Final = 1e-6
"""A feature that varies less than this (rad, or probability) is constant: dividing by its spread would
turn rounding into signal."""


@final
@dataclass(frozen=True)
class Normaliser:
    """An affine map of each feature: ``(x - centre) / scale``."""

    centre: FloatArray  # (k,) or (1,)
    scale: FloatArray  # (k,) or (1,), positive

    def apply(self, values: FloatArray) -> FloatArray:
        """Normalise values (..., k)."""
        return (values - self.centre) / self.scale

    def invert(self, normalised: FloatArray) -> FloatArray:
        """Undo `apply`, (..., k)."""
        return normalised * self.scale + self.centre

    def tensors(self) -> dict[str, FloatArray]:
        """Both arrays by name, as a normaliser of contexts is saved."""
        return {"context.centre": self.centre, "context.scale": self.scale}


def context_normaliser(context: FloatArray) -> Normaliser:
    """Zero mean and unit spread for every context feature on its own; a constant one is only centred.

    Args:
        context: (N, c).
    """
    spread = context.std(axis=0)
    return Normaliser(centre=context.mean(axis=0), scale=np.where(spread > CONSTANT_SPREAD, spread, 1.0))


STILL: Final = {GRIPPER: 0.001, OBJECTS: 0.005, OBJECTS_IN_TOOL: 0.005}
"""A position or an opening that varies less than this, m, in the training data tells nothing; so does an
entry of a rotation that varies less than ten times as much."""

LEAST_SCALE: Final = {GRIPPER: 0.005, OBJECTS: 0.05, OBJECTS_IN_TOOL: 0.05}
"""Least scale of a position or an opening, m; that of an entry of a rotation is ten times as large. Without
it a cup that moved by a centimetre in training and stands 30 cm elsewhere would be seen at 30 times the
training's spread, where no network has learned anything."""

UNSEEN: Final = 1e9
"""Scale of an entry that tells nothing. A network's weights for it stay as they were drawn, since it was zero
in training; with this scale it is zero wherever the thing stands."""

_UNITS: Final = np.repeat([1.0, 10.0], [3, OBJECT - 3])
"""Of a pose's entries: positions, and entries of a rotation."""


def feature_normaliser(recorded: FloatArray, framed: FloatArray, layout: ContextLayout) -> Normaliser:
    """A normaliser of each feature of a context on its own.

    Joints and belief have zero mean and unit spread, as `context_normaliser` has them. The gripper's opening
    is centred in its range and divided by half of it. Poses of things have zero mean and are divided by their
    spread, or by `LEAST_SCALE` where that is larger.

    What did not vary (`STILL`) is not seen at all: the decoder is then what it would be without. In the
    tool's frame even a thing that stands still varies with the joints, and tells nothing that these do not;
    so what varied is decided in the base frame there too, for position and rotation as a whole.

    Args:
        recorded: (N, c), contexts with all poses in the base frame.
        framed: (N, c), the same with poses for `OBJECTS_IN_TOOL` in the tool's frame; what is normalised.
        layout: of these contexts.
    """
    plain = context_normaliser(framed)
    centre, scale = plain.centre.copy(), plain.scale.copy()
    for feature in layout.features:
        if feature not in STILL:
            continue
        columns = layout.columns(feature)
        spread, unit = framed[:, columns].std(axis=0), np.ones(1)
        told = spread > STILL[feature]
        if feature == GRIPPER:
            low, high = framed[:, columns].min(axis=0), framed[:, columns].max(axis=0)
            centre[columns], spread = (low + high) / 2, (high - low) / 2
        else:
            unit = np.tile(_UNITS, len(layout.objects))
            told = recorded[:, columns].std(axis=0) > unit * STILL[feature]
        if feature == OBJECTS_IN_TOOL:
            position, rotation = np.split(told.reshape(-1, OBJECT), [3], axis=1)
            told = np.repeat(
                np.stack([position.any(axis=1), rotation.any(axis=1)], axis=1), [3, OBJECT - 3], axis=1
            ).ravel()
        scale[columns] = np.where(told, np.maximum(spread, unit * LEAST_SCALE[feature]), UNSEEN)
    return Normaliser(centre, scale)


def action_normaliser(action: FloatArray) -> Normaliser:
    """One scale for all joints and no offset.

    One scale keeps the loss proportional to ``‖a - a_h‖^2`` of equations 6-8 in rad/s: a scale per joint
    would weigh joints more the less they move. Without an offset, zero action stays zero, which models with
    phi(0, c) = 0 need.

    Args:
        action: (N, m), rad/s, not all zero.
    """
    return Normaliser(centre=np.zeros(1), scale=np.sqrt(np.square(action).mean()).reshape(1))


SPAN_QUANTILE: Final = 0.99
"""u in [-1, 1] reaches this share of what the demonstrations used; the rest are outliers."""

EFFECT_SAMPLES: Final = 512
"""Training contexts, at most, in which the effect of a latent dimension is measured."""

SMALLEST_SCALE: Final = 1e-9
"""Least range of a latent dimension, so that a dead one does not divide by zero."""

DEAD_EFFECT: Final = 0.01
"""A dimension whose full deflection changes the action by less than this share of the demonstrated speed is
dead: nobody could steer with it."""

INACTIVE_VARIANCE: Final = 1e-2
"""Variance of the posterior mean below which a variational dimension has collapsed to the prior
(the "active units" criterion of Burda et al., Importance Weighted Autoencoders, 2016)."""


class CollapseWarning(UserWarning):
    """A latent dimension learned nothing: the input on that axis will move nothing."""


def latent_scale(latents: FloatArray, centre: FloatArray) -> Normaliser:
    """The map between z as trained and the input u, so that u in [-1, 1] spans the demonstrations.

    Args:
        latents: (S, N, d), the encoder's means on the training pairs.
        centre: (S, d), the z that becomes u = 0.

    Returns:
        Normaliser with centre (S, 1, d) and scale (S, 1, d).
    """
    distance = np.abs(latents - centre[:, None])
    scale = np.quantile(distance, SPAN_QUANTILE, axis=1)
    return Normaliser(centre=centre[:, None], scale=np.maximum(scale, SMALLEST_SCALE)[:, None])


def unit_scale(latents: FloatArray) -> Normaliser:
    """The map between z and u of a model whose z is the input as it is.

    Args:
        latents: (S, N, d).
    """
    seeds, _, dimensions = latents.shape
    return Normaliser(centre=np.zeros((seeds, 1, dimensions)), scale=np.ones((seeds, 1, dimensions)))


def effect_of_dimensions(
    decode: Callable[[FloatArray], FloatArray], inputs: FloatArray, action_size: float
) -> FloatArray:
    """How much each latent dimension moves the arm, as a share of the demonstrated speed.

    Args:
        decode: from inputs u (S, N, d) to actions (S, N, m) in N fixed contexts.
        inputs: (S, N, d), the inputs that the demonstrations used there.
        action_size: root mean square norm ``‖a‖`` of the demonstrated actions, same unit as decoded ones.

    Returns:
        (S, d), RMS of ``‖phi(u_j = 1) - phi(u_j = -1)‖ / 2`` over ``action_size``.
    """
    effects: list[FloatArray] = []
    for axis in range(inputs.shape[-1]):
        up, down = inputs.copy(), inputs.copy()
        up[..., axis], down[..., axis] = 1.0, -1.0
        change = np.linalg.norm(decode(up) - decode(down), axis=-1) / 2
        effects.append(np.sqrt(np.square(change).mean(axis=1)) / action_size)
    return np.stack(effects, axis=-1)


def find_collapsed(effect: FloatArray, latents: FloatArray, *, gaussian: bool) -> BoolArray:
    """Which dimensions have collapsed.

    Args:
        effect: (S, d), see `effect_of_dimensions`.
        latents: (S, N, d), the encoder's means on the training pairs.
        gaussian: whether the encoder is Gaussian and may also collapse to its prior.

    Returns:
        (S, d).
    """
    dead = effect < DEAD_EFFECT
    if gaussian:
        dead |= latents.var(axis=1) < INACTIVE_VARIANCE
    return dead


def describe_collapse(kind: str, seeds: tuple[int, ...], collapsed: BoolArray) -> str:
    """One sentence that names the dead dimensions.

    Args:
        kind: kind of model.
        seeds: S seeds.
        collapsed: (S, d), at least one True.
    """
    dead = [
        f"seed {seed}: " + ", ".join(f"z{axis + 1}" for axis in np.flatnonzero(row))
        for seed, row in zip(seeds, collapsed, strict=True)
        if row.any()
    ]
    return (
        f"The {kind} model has collapsed latent dimensions ({'; '.join(dead)}): input on them moves nothing; "
        "use fewer latent dimensions, a smaller KL weight, or other seeds."
    )
