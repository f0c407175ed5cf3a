"""One small network as the control loop runs it: NumPy alone."""

from collections.abc import Sequence

import numpy as np

from latentarm.types import FloatArray

Layer = tuple[FloatArray, FloatArray]
"""Weight (in, out) and bias (out,)."""


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
