"""A learned alignment as the control loop runs it: NumPy alone."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Final, final

from latentarm.core.types import FloatArray
from latentarm.models.kind import Shape
from latentarm.models.numpy_networks import Layer, halve_hidden, propagate

NETWORK: Final = "alignment"  # the network's name in ``<network>.<layer>.weight``


def layer_shapes(latent: int, context: int, hidden: tuple[int, ...]) -> dict[str, Shape]:
    """Shape of every weight of f by name: a perceptron from (u, normalised c) to z, with hidden layers."""
    shapes: dict[str, Shape] = {}
    for layer, (inputs, outputs) in enumerate(pairwise((latent + context, *hidden, latent))):
        shapes[f"{NETWORK}.{layer}.weight"] = (inputs, outputs)
        shapes[f"{NETWORK}.{layer}.bias"] = (1, outputs)
    return shapes


def tensor_shapes(latent: int, context: int, hidden: tuple[int, ...]) -> dict[str, Shape]:
    """Shape of every tensor of a learned alignment by name: its weights, and the contexts' normaliser."""
    return {
        **layer_shapes(latent, context, hidden),
        "context.centre": (context,),
        "context.scale": (context,),
    }


@final
class LearnedAlignment:
    """``z = f(u, c)`` of one person (equation 4).

    The call does not validate: the control loop has checked its input, and NumPy raises on a wrong shape.
    """

    def __init__(self, tensors: Mapping[str, FloatArray]) -> None:
        self.tensors = {name: tensors[name].copy() for name in sorted(tensors)}
        layers = self._layers()
        self.context_dim = len(tensors["context.centre"])
        self.latent_dim = len(layers[-1][1])
        self.hidden = tuple(len(bias) for _, bias in layers[:-1])
        (weight, bias), *self._rest = halve_hidden(layers)
        # Two products instead of one over (u, c) joined: cheaper than joining, and they broadcast.
        self._from_input = weight[: self.latent_dim].copy()
        self._from_context: FloatArray = weight[self.latent_dim :] / tensors["context.scale"][:, None]
        self._bias: FloatArray = bias - tensors["context.centre"] @ self._from_context

    def __call__(self, u: FloatArray, context: FloatArray) -> FloatArray:
        """Latent actions (..., d) of inputs (..., d) in contexts (..., c), whose leading axes broadcast."""
        return propagate(u @ self._from_input + (context @ self._from_context + self._bias), self._rest)

    def _layers(self) -> list[Layer]:
        layers: list[Layer] = []
        while f"{NETWORK}.{len(layers)}.weight" in self.tensors:
            stem = f"{NETWORK}.{len(layers)}"
            layers.append((self.tensors[f"{stem}.weight"], self.tensors[f"{stem}.bias"][0]))
        return layers
