"""Small networks in the control loop: one seed, NumPy only, with scalings folded in."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.types import FloatArray

if TYPE_CHECKING:
    from latentarm.models.kind import Shape, TrainedModel

NORM_FLOOR: Final = 1e-12
"""Added to a squared column length under the root, so that a column of zeros does not divide by zero."""

Layer = tuple[FloatArray, FloatArray]  # weight (in, out) and bias (out,)


def network_shapes(networks: "Mapping[str, Shape]", seeds: int) -> "dict[str, Shape]":
    """Shape, with the leading seed axis, of every weight and bias by name (``decoder.0.weight``, ...)."""
    return {
        f"{network}.{layer}.{part}": (seeds, rows, width)
        for network, sizes in networks.items()
        for layer, (before, width) in enumerate(pairwise(sizes))
        for part, rows in (("weight", before), ("bias", 1))
    }


def halve_hidden(layers: Sequence[Layer]) -> list[Layer]:
    """Fold SiLU's halving into every layer that an activation follows."""
    return [*((weight / 2, bias / 2) for weight, bias in layers[:-1]), layers[-1]]


def propagate(values: FloatArray, layers: Sequence[Layer]) -> FloatArray:
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


def network_output(values: FloatArray, layers: Sequence[Layer]) -> FloatArray:
    """Through all layers, whose weights `halve_hidden` gave."""
    (weight, bias), *rest = layers
    return propagate(values @ weight + bias, rest)


def layers_of(trained: "TrainedModel", seed: int, network: str = "decoder") -> list[Layer]:
    """A network's weights (in, out) and biases (out,) of one seed, copied out of the stack."""
    tensors, count = trained.tensors, 0
    layers: list[Layer] = []
    while f"{network}.{count}.weight" in tensors:
        weight, bias = tensors[f"{network}.{count}.weight"], tensors[f"{network}.{count}.bias"]
        layers.append((weight[seed].copy(), bias[seed, 0].copy()))
        count += 1
    return layers


def scale_output(layers: list[Layer], scale: FloatArray) -> list[Layer]:
    """Make a network whose last layer gives normalised actions give rad/s."""
    weight, bias = layers[-1]
    return [*layers[:-1], (weight * scale, bias * scale)]


def scale_latent(layer: Layer, trained: "TrainedModel", seed: int) -> Layer:
    """Make a first layer that takes z take u instead: z = centre + scale u."""
    weight, bias = layer
    latents = trained.latents
    return latents.scale[seed, 0][:, None] * weight, bias + latents.centre[seed, 0] @ weight


def scale_context(layer: Layer, trained: "TrainedModel") -> Layer:
    """Make a first layer that takes a normalised context take a raw one."""
    weight, bias = layer
    scaled = weight / trained.tensors["context.scale"][:, None]
    return scaled, bias - trained.tensors["context.centre"] @ scaled
