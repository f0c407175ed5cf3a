"""The decoder as the control loop runs it: one seed, NumPy alone, a few microseconds."""

from abc import ABC, abstractmethod
from pathlib import Path
from typing import Final, cast, final

import numpy as np

from latentarm.models.layout import ORDERS, DecoderForm
from latentarm.models.normaliser import Normaliser
from latentarm.models.numpy_networks import Layer, halve_hidden, network_output, propagate
from latentarm.models.saving import read_model
from latentarm.models.trained import TrainedModel
from latentarm.types import FloatArray, StrPath

NORM_FLOOR: Final = 1e-12
"""Added under the root of a squared column length, so that a column of zeros divides by a number."""

BEND_SIZE: Final = 0.3
"""What the network's bend is multiplied by: it begins small."""


@final
class Decoder:
    """``a_h = phi(u, c)`` in rad/s, with u in [-1, 1] spanning what the demonstrations used.

    Normalisers and the latent scale are folded into the first and last layers, save for the isometric model,
    which looks at the arm first. Nothing is checked in
    `decode`: the control loop has checked its input, and a wrong shape raises in NumPy.

    Attributes:
        kind: kind of model.
        context: kind of context, ``state`` or ``state_belief``.
        latent_dim: d.
        context_dim: c.
        action_dim: m.
    """

    __slots__ = ("_form", "action_dim", "context", "context_dim", "kind", "latent_dim")

    def __init__(self, trained: TrainedModel, seed: int = 0) -> None:
        """Take one seed's decoder out of a trained model.

        Args:
            trained: the model.
            seed: index of the seed, 0..S-1.

        Raises:
            UserError: there is no such seed.
        """
        trained.check_seed_index(seed)
        self.kind = trained.kind
        self.context = cast(str, trained.parameters["context"])
        self.latent_dim = trained.dimensions.latent
        self.context_dim = trained.dimensions.context
        self.action_dim = trained.dimensions.action
        self._form: _Form = _FORMS[trained.layout.decoder](trained, seed)

    def decode(self, z: FloatArray, context: FloatArray) -> FloatArray:
        """Joint velocities of latent actions in contexts.

        Args:
            z: (..., d), in input units.
            context: (..., c); leading axes broadcast against those of ``z``.

        Returns:
            (..., m), rad/s.
        """
        return self._form(z, context)


def load_decoder(folder: StrPath, seed: int = 0) -> Decoder:
    """Read one seed's decoder from a folder that a model was saved to. Loads no torch.

    Args:
        folder: holds ``config.json`` and ``model.safetensors``.
        seed: index of the seed, 0..S-1.

    Raises:
        UserError: the files are missing, broken or foreign, or there is no such seed.
    """
    return Decoder(read_model(Path(folder)), seed)


class _Form(ABC):
    """One way from (u, c) to an action, with its weights."""

    @abstractmethod
    def __init__(self, trained: TrainedModel, seed: int) -> None: ...

    @abstractmethod
    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray: ...


@final
class _Latent(_Form):
    """phi(z) of PCA, AE and VAE."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        layers = _scale_output(_layers(trained, seed), trained.actions.scale)
        weight, bias = _scale_latent(layers[0], trained, seed)
        (self._weight, self._bias), *self._rest = halve_hidden([(weight, bias), *layers[1:]])

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        action = propagate(z @ self._weight + self._bias, self._rest)
        if context.ndim == 1:
            return action
        shape = np.broadcast_shapes(action.shape[:-1], context.shape[:-1])
        return np.broadcast_to(action, (*shape, action.shape[-1]))


@final
class _LatentContext(_Form):
    """phi(z, c) of the conditioned autoencoders."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        layers = _scale_output(_layers(trained, seed), trained.actions.scale)
        d = trained.dimensions.latent
        weight, bias = layers[0]
        # Two products instead of one over (z, c) joined: cheaper than joining, and they broadcast.
        from_latent, bias = _scale_latent((weight[:d], bias), trained, seed)
        from_context, bias = _scale_context((weight[d:], bias), trained)
        weight = np.concatenate([from_latent, from_context])
        (weight, self._bias), *self._rest = halve_hidden([(weight, bias), *layers[1:]])
        self._from_latent, self._from_context = weight[:d].copy(), weight[d:].copy()

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        first = z @ self._from_latent + (context @ self._from_context + self._bias)
        return propagate(first, self._rest)


@final
class _Matrix(_Form):
    """M(c) z of the state-conditioned linear model, the columns of M orthonormal."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        layers = _layers(trained, seed)
        first = _scale_context(layers[0], trained)
        (self._weight, self._bias), *self._rest = halve_hidden([first, *layers[1:]])
        joints = trained.dimensions.action
        self._parts = [slice(axis * joints, (axis + 1) * joints) for axis in range(trained.dimensions.latent)]
        self._gain: FloatArray = trained.latents.scale[seed, 0] * trained.actions.scale

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        raw = propagate(context @ self._weight + self._bias, self._rest)
        columns = _orthonormal([raw[..., part] for part in self._parts])
        scaled = z * self._gain
        action = scaled[..., :1] * columns[0]
        for axis in range(1, len(columns)):
            action = action + scaled[..., axis : axis + 1] * columns[axis]
        return action


@final
class _Homogeneous(_Form):
    """‖z‖ R(c, z / ‖z‖) of the homogeneous model."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        self._contexts = trained.tool_contexts
        layers = _layers(trained, seed)
        first = _scale_context(layers[0], trained)
        (self._weight, self._bias), *self._rest = halve_hidden([first, *layers[1:]])
        self._speed = float(trained.actions.scale[0])
        self._latents, self._joints = trained.dimensions.latent, trained.dimensions.action

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        jacobian = self._contexts.jacobian(context[..., : self._joints])
        columns = self._columns(context, jacobian)
        radius = np.sqrt(np.vecdot(z, z))[..., None]
        led = np.matvec(columns, odd_degrees(z / np.maximum(radius, NORM_FLOOR)))
        twist = np.matvec(jacobian, led)
        size = np.vecdot(twist, twist) + self._contexts.damping * np.vecdot(led, led)
        return self._speed * radius * led / np.sqrt(size + NORM_FLOOR)[..., None]

    def _columns(self, context: FloatArray, jacobian: FloatArray) -> FloatArray:
        """M_1(c) and the bends M_3(c), M_5(c), ..., (..., m, (1 + orders) d)."""
        raw = propagate(context @ self._weight + self._bias, self._rest)
        columns = raw.reshape(*raw.shape[:-1], -1, self._joints).swapaxes(-1, -2).copy()
        columns[..., self._latents :] *= BEND_SIZE
        twists = jacobian @ columns
        for axis in range(self._latents):
            column, twist = columns[..., axis], twists[..., axis]
            size = np.vecdot(twist, twist) + self._contexts.damping * np.vecdot(column, column)
            scale = 1 / np.sqrt(size + NORM_FLOOR)[..., None]
            column *= scale
            twist *= scale
            after, after_twist = columns[..., axis + 1 :], twists[..., axis + 1 :]
            along = np.vecmat(twist, after_twist) + self._contexts.damping * np.vecmat(column, after)
            after -= column[..., None] * along[..., None, :]
            after_twist -= twist[..., None] * along[..., None, :]
        return columns


@final
class _Isometry(_Form):
    """g(r) R(c, r) z / r of the isometric model."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        self._contexts = trained.tool_contexts
        self._twist = halve_hidden(_layers(trained, seed, "decoder"))
        self._posture = halve_hidden(_layers(trained, seed, "posture"))
        ((weight, bias),) = _layers(trained, seed, "gain")
        self._saturation = float(np.logaddexp(0.0, weight[0, 0] + bias[0]))
        self._speed = float(trained.actions.scale[0] / np.tanh(self._saturation))
        self._latents = trained.dimensions.latent

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        straight, bend, bend_twist = self._geometry(context)
        radius = np.sqrt(np.vecdot(z, z))[..., None]
        direction = z / np.maximum(radius, NORM_FLOOR)
        turn = 2 * np.minimum(radius, 1.0) - 1
        aside = np.matvec(bend, direction)
        twist = np.matvec(bend_twist, direction)
        aside_size = np.vecdot(twist, twist) + self._contexts.damping * np.vecdot(aside, aside)
        led = np.matvec(straight, direction) + turn * aside
        speed = self._speed * np.tanh(self._saturation * radius)
        return speed * led / np.sqrt(1 + turn**2 * aside_size[..., None])

    def _geometry(self, context: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """M (..., m, d), N (..., m, d) and the tools' weighted twists (..., 6 k, d) along N."""
        sizes, damping, d = self._contexts.sizes, self._contexts.damping, self._latents
        observed, lead = self._contexts.apply(context), context.shape[:-1]
        seen = observed[..., : sizes.seen]
        jacobian = observed[..., sizes.jacobian].reshape(*lead, sizes.twists, sizes.joints)
        lift = observed[..., sizes.lift].reshape(*lead, sizes.joints, sizes.twists)
        twist = network_output(seen, self._twist).reshape(*lead, 2 * d, sizes.twists)
        posture = network_output(seen, self._posture).reshape(*lead, 2 * d, sizes.joints)
        columns = lift @ twist.mT + posture.mT
        straight, straight_twist = columns[..., :d], jacobian @ columns[..., :d]

        def inner(first: int, second: int) -> FloatArray:
            """``a^T G b`` of two of the first columns, (..., 1)."""
            joints = np.vecdot(straight[..., first], straight[..., second])
            twists = np.vecdot(straight_twist[..., first], straight_twist[..., second])
            return (twists + damping * joints)[..., None]

        for axis in range(d):
            for other in range(axis):
                along = inner(axis, other)
                straight[..., axis] -= along * straight[..., other]
                straight_twist[..., axis] -= along * straight_twist[..., other]
            size = np.sqrt(inner(axis, axis) + NORM_FLOOR)
            straight[..., axis] /= size
            straight_twist[..., axis] /= size
        bend = BEND_SIZE * columns[..., d:]
        bend_twist = jacobian @ bend
        along = straight_twist.mT @ bend_twist + damping * (straight.mT @ bend)
        return straight, bend - straight @ along, bend_twist - straight_twist @ along


_FORMS: Final[dict[DecoderForm, type[_Form]]] = {
    "linear": _Latent,
    "latent": _Latent,
    "latent_context": _LatentContext,
    "matrix": _Matrix,
    "isometry": _Isometry,
    "homogeneous": _Homogeneous,
}


def _orthonormal(columns: list[FloatArray]) -> list[FloatArray]:
    """Gram-Schmidt over d columns, each (..., m)."""
    done: list[FloatArray] = []
    for raw in columns:
        column = raw
        for other in done:
            column = column - np.vecdot(column, other)[..., None] * other
        done.append(column / np.sqrt(np.vecdot(column, column) + NORM_FLOOR)[..., None])
    return done


def odd_degrees(direction: FloatArray) -> FloatArray:
    """Chebyshev polynomials ``T_n`` of each entry for n = 1 and `ORDERS`, (..., d) to (..., (1 + orders) d).

    For d = 2 and a direction at the angle theta these are cos(n theta) and, but for the sign, sin(n theta).
    """
    twice = 4 * np.square(direction) - 2
    before, degree, parts = direction, direction, [direction]
    for _ in ORDERS:
        before, degree = degree, twice * degree - before
        parts.append(degree)
    return np.concatenate(parts, axis=-1)


def _layers(trained: TrainedModel, seed: int, network: str = "decoder") -> list[Layer]:
    """A network's weights (in, out) and biases (out,) of one seed, copied out of the stack."""
    tensors, count = trained.tensors, 0
    layers: list[Layer] = []
    while f"{network}.{count}.weight" in tensors:
        weight, bias = tensors[f"{network}.{count}.weight"], tensors[f"{network}.{count}.bias"]
        layers.append((weight[seed].copy(), bias[seed, 0].copy()))
        count += 1
    return layers


def _scale_output(layers: list[Layer], scale: FloatArray) -> list[Layer]:
    weight, bias = layers[-1]
    return [*layers[:-1], (weight * scale, bias * scale)]


def _scale_latent(layer: Layer, trained: TrainedModel, seed: int) -> Layer:
    """Let a first layer that takes z take u instead: z = centre + scale u."""
    weight, bias = layer
    latents = trained.latents
    return latents.scale[seed, 0][:, None] * weight, bias + latents.centre[seed, 0] @ weight


def _scale_context(layer: Layer, trained: TrainedModel) -> Layer:
    """Let a first layer that takes a normalised context take a raw one."""
    weight, bias = layer
    contexts = Normaliser(trained.tensors["context.centre"], trained.tensors["context.scale"])
    scaled = weight / contexts.scale[:, None]
    return scaled, bias - contexts.centre @ scaled
