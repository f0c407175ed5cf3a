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
    """Zero mean and unit spread for each feature of contexts (N, c); a constant one is only centred."""
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
    """A normaliser of each feature of contexts (N, c) on its own.

    ``recorded`` has all poses in the base frame, ``framed`` those for `OBJECTS_IN_TOOL` in the tool's frame;
    the latter is normalised.

    Joints and belief get zero mean and unit spread by `context_normaliser`. The gripper's opening is centred
    in its range and divided by half of it. Poses of things get zero mean and are divided by their spread, or
    by `LEAST_SCALE` where that is larger.

    A feature that did not vary (`STILL`) is hidden: the decoder is then the same as without it. In the tool's
    frame even a thing that stands still varies with the joints, and tells nothing more; so its variation is
    judged in the base frame there too, for position and rotation as a whole.
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
    """One scale for all joints and no offset, from actions (N, m), rad/s, not all zero.

    One scale keeps the loss proportional to ``‖a - a_h‖^2`` of equations 6-8 in rad/s: a scale per joint
    would weigh joints more the less they move. Without an offset, zero action stays zero, which models with
    phi(0, c) = 0 need.
    """
    return Normaliser(centre=np.zeros(1), scale=np.sqrt(np.square(action).mean()).reshape(1))


SPAN_QUANTILE: Final = 0.99  # u in [-1, 1] spans this share of the demonstrations; the rest are outliers
EFFECT_SAMPLES: Final = 512
"""Training contexts, at most, in which the effect of a latent dimension is measured."""

SMALLEST_SCALE: Final = 1e-9  # least range of a latent dimension, so that a dead one does not divide by zero
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

    From latents (S, N, d) and the z (S, d) that becomes u = 0; its centre and scale are (S, 1, d).
    """
    distance = np.abs(latents - centre[:, None])
    scale = np.quantile(distance, SPAN_QUANTILE, axis=1)
    return Normaliser(centre=centre[:, None], scale=np.maximum(scale, SMALLEST_SCALE)[:, None])


def unit_scale(latents: FloatArray) -> Normaliser:
    """The identity between z and u, for latents (S, N, d) that are inputs already."""
    seeds, _, dimensions = latents.shape
    return Normaliser(centre=np.zeros((seeds, 1, dimensions)), scale=np.ones((seeds, 1, dimensions)))


def effect_of_dimensions(
    decode: Callable[[FloatArray], FloatArray], inputs: FloatArray, action_size: float
) -> FloatArray:
    """RMS of ``‖phi(u_j = 1) - phi(u_j = -1)‖ / 2`` (S, d), as a share of the demonstrated speed.

    ``inputs`` (S, N, d) are those of the demonstrations in N fixed contexts, where ``decode`` gives actions;
    ``action_size`` is the root mean square of ‖a‖.
    """
    effects: list[FloatArray] = []
    for axis in range(inputs.shape[-1]):
        up, down = inputs.copy(), inputs.copy()
        up[..., axis], down[..., axis] = 1.0, -1.0
        change = np.linalg.norm(decode(up) - decode(down), axis=-1) / 2
        effects.append(np.sqrt(np.square(change).mean(axis=1)) / action_size)
    return np.stack(effects, axis=-1)


def find_collapsed(effect: FloatArray, latents: FloatArray, *, gaussian: bool) -> BoolArray:
    """Which dimensions (S, d) have collapsed, by their effect (S, d) and the encoder's means (S, N, d).

    A Gaussian encoder may also collapse to its prior.
    """
    dead = effect < DEAD_EFFECT
    if gaussian:
        dead |= latents.var(axis=1) < INACTIVE_VARIANCE
    return dead


def describe_collapse(kind: str, seeds: tuple[int, ...], collapsed: BoolArray) -> str:
    """One sentence that names the dead dimensions."""
    dead = [
        f"seed {seed}: " + ", ".join(f"z{axis + 1}" for axis in np.flatnonzero(row))
        for seed, row in zip(seeds, collapsed, strict=True)
        if row.any()
    ]
    return (
        f"The {kind} model has collapsed latent dimensions ({'; '.join(dead)}): input on them moves nothing; "
        "use fewer latent dimensions, a smaller KL weight, or other seeds."
    )
