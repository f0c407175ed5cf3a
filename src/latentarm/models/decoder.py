"""The decoder as the control loop runs it: one seed, NumPy alone, a few microseconds."""

from abc import ABC, abstractmethod
from pathlib import Path
from typing import Final, cast, final

import numpy as np

from latentarm.models.layout import DecoderForm
from latentarm.models.saving import read_model
from latentarm.models.trained import TrainedModel
from latentarm.types import FloatArray

Layer = tuple[FloatArray, FloatArray]

NORM_FLOOR: Final = 1e-12
"""Added under the root of a squared column length, so that a column of zeros divides by a number."""


@final
class Decoder:
    """``a_h = phi(u, c)`` in rad/s, with u in [-1, 1] spanning what the demonstrations used.

    Normalisers and the latent scale are folded into the first and last layers. Nothing is checked in
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


def load_decoder(folder: Path, seed: int = 0) -> Decoder:
    """Read one seed's decoder from a folder that a model was saved to. Loads no torch.

    Args:
        folder: holds ``config.json`` and ``model.safetensors``.
        seed: index of the seed, 0..S-1.

    Raises:
        UserError: the files are missing, broken or foreign, or there is no such seed.
    """
    return Decoder(read_model(folder), seed)


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
        (self._weight, self._bias), *self._rest = _halve_hidden([(weight, bias), *layers[1:]])

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        action = _propagate(z @ self._weight + self._bias, self._rest)
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
        (weight, self._bias), *self._rest = _halve_hidden([(weight, bias), *layers[1:]])
        self._from_latent, self._from_context = weight[:d].copy(), weight[d:].copy()

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        first = z @ self._from_latent + (context @ self._from_context + self._bias)
        return _propagate(first, self._rest)


@final
class _Matrix(_Form):
    """M(c) z of the state-conditioned linear model, the columns of M orthonormal."""

    def __init__(self, trained: TrainedModel, seed: int) -> None:
        layers = _layers(trained, seed)
        first = _scale_context(layers[0], trained)
        (self._weight, self._bias), *self._rest = _halve_hidden([first, *layers[1:]])
        joints = trained.dimensions.action
        self._parts = [slice(axis * joints, (axis + 1) * joints) for axis in range(trained.dimensions.latent)]
        self._gain: FloatArray = trained.latents.scale[seed, 0] * trained.actions.scale

    def __call__(self, z: FloatArray, context: FloatArray) -> FloatArray:
        raw = _propagate(context @ self._weight + self._bias, self._rest)
        columns = _orthonormal([raw[..., part] for part in self._parts])
        scaled = z * self._gain
        action = scaled[..., :1] * columns[0]
        for axis in range(1, len(columns)):
            action = action + scaled[..., axis : axis + 1] * columns[axis]
        return action


_FORMS: Final[dict[DecoderForm, type[_Form]]] = {
    "linear": _Latent,
    "latent": _Latent,
    "latent_context": _LatentContext,
    "matrix": _Matrix,
}


def _propagate(values: FloatArray, layers: list[Layer]) -> FloatArray:
    """Through the layers after the first; ``values`` are the first one's halved pre-activations.

    SiLU is x sigmoid(x) = h + h tanh(h) with h = x / 2: the halving is in the weights.
    """
    for weight, bias in layers:
        curved = np.tanh(values)
        curved *= values
        curved += values
        values = curved @ weight
        values += bias
    return values


def _orthonormal(columns: list[FloatArray]) -> list[FloatArray]:
    """Gram-Schmidt over d columns, each (..., m)."""
    done: list[FloatArray] = []
    for raw in columns:
        column = raw
        for other in done:
            column = column - np.vecdot(column, other)[..., None] * other
        done.append(column / np.sqrt(np.vecdot(column, column) + NORM_FLOOR)[..., None])
    return done


def _layers(trained: TrainedModel, seed: int) -> list[Layer]:
    """The decoder's weights (in, out) and biases (out,) of one seed, copied out of the stack."""
    tensors, count = trained.tensors, 0
    layers: list[Layer] = []
    while f"decoder.{count}.weight" in tensors:
        weight, bias = tensors[f"decoder.{count}.weight"], tensors[f"decoder.{count}.bias"]
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
    contexts = trained.contexts
    scaled = weight / contexts.scale[:, None]
    return scaled, bias - contexts.centre @ scaled


def _halve_hidden(layers: list[Layer]) -> list[Layer]:
    """Fold SiLU's halving into every layer that an activation follows."""
    return [*((weight / 2, bias / 2) for weight, bias in layers[:-1]), layers[-1]]
