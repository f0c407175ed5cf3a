"""Many small networks as one: every weight carries a leading seed axis."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final, cast, final

import torch
from torch import Tensor

from latentarm.core.types import FloatArray
from latentarm.models.perceptron import Perceptrons

if TYPE_CHECKING:
    from latentarm.models.kind import Shape

Layer = tuple[Tensor, Tensor]  # weight (S, in, out) and bias (S, 1, out)
Networks = Mapping[str, Sequence[Layer]]  # layers, input first, by the network's name ("encoder", "decoder")
ALIGNMENT: Final = 16
"""Each layer starts at a multiple of this many floats within its seed's row (64 bytes). The matrix
kernels may round differently at other alignments; this keeps a seed's result free of its neighbours. The bias
follows the weight directly, so that the two can be one matrix."""


def mlp(layers: Sequence[Layer], *inputs: Tensor) -> Tensor:
    """S perceptrons with SiLU hidden units, x sigmoid(x), and a linear output (S, B, out).

    The inputs (S, B, k) lie side by side. SiLU is smooth, so the arm follows the stick smoothly. The gradient
    with respect to weights that are being trained is written out and can be taken once; for a loss that has a
    gradient in it see `mlp_along`.
    """
    if layers[0][0].requires_grad or not torch.is_grad_enabled():
        parameters = [parameter for layer in layers for parameter in layer]
        return cast(Tensor, Perceptrons.apply(len(inputs), *inputs, *parameters))
    *hidden, (weight, bias) = layers
    values = inputs[0] if len(inputs) == 1 else torch.cat(inputs, dim=-1)
    for hidden_weight, hidden_bias in hidden:
        values = torch.nn.functional.silu(torch.baddbmm(hidden_bias, values, hidden_weight))
    return torch.baddbmm(bias, values, weight)


def mlp_along(layers: Sequence[Layer], inputs: Tensor, direction: Tensor) -> tuple[Tensor, Tensor]:
    """The output of `mlp` and its derivative along a direction (forward mode), (S, B, out) each."""
    *hidden, (weight, bias) = layers
    values, slope = inputs, direction
    for hidden_weight, hidden_bias in hidden:
        before = torch.baddbmm(hidden_bias, values, hidden_weight)
        gate = torch.sigmoid(before)
        values = before * gate
        slope = torch.bmm(slope, hidden_weight) * (gate + values * (1 - gate))
    return torch.baddbmm(bias, values, weight), torch.bmm(slope, weight)


def group_layers(tensors: Mapping[str, Tensor]) -> dict[str, list[Layer]]:
    """Networks from tensors named ``<network>.<layer>.weight`` and ``.bias``; others are ignored."""
    networks: dict[str, list[Layer]] = {}
    for network in {name.partition(".")[0] for name in tensors if name.endswith(".0.weight")}:
        stems = [f"{network}.{nth}" for nth in range(len(tensors)) if f"{network}.{nth}.weight" in tensors]
        networks[network] = [(tensors[f"{stem}.weight"], tensors[f"{stem}.bias"]) for stem in stems]
    return networks


def networks_from_arrays(arrays: Mapping[str, FloatArray]) -> Networks:
    """Networks in float64 on the CPU from arrays as `FlatNetworks.arrays` gives them."""
    return group_layers({name: torch.from_numpy(array) for name, array in arrays.items()})


@final
class FlatNetworks:
    """All weights of S models in one (S, P) float32 buffer, and the layers as views into it.

    One buffer makes the optimiser a handful of operations whatever the number of layers, and the copy of a
    seed's best weights a single one. `fill_gradient` fills ``gradient``; ``networks`` are leaves of the graph
    that share memory with ``values``, and ``offsets`` tells where in a row each tensor begins.
    """

    def __init__(self, shapes: "Mapping[str, Shape]", device: torch.device) -> None:
        """Lay out zeros for tensors of the given shapes, each (S, in, out)."""
        self._shapes = dict(shapes)
        self.offsets: dict[str, int] = {}
        seeds, length = next(iter(shapes.values()))[0], 0
        for name, (_, *rest) in shapes.items():
            if not name.endswith(".bias"):
                length = math.ceil(length / ALIGNMENT) * ALIGNMENT
            self.offsets[name] = length
            length += math.prod(rest)
        length = math.ceil(length / ALIGNMENT) * ALIGNMENT
        self.values = torch.zeros(seeds, length, device=device)
        self.gradient = torch.zeros_like(self.values)
        self._leaves = {name: one.detach().requires_grad_() for name, one in self.views(self.values).items()}
        self._gradient_views = list(self.views(self.gradient).values())
        self.networks: Networks = group_layers(self._leaves)

    def views(self, flat: Tensor) -> dict[str, Tensor]:
        """The tensors by name, as views into a buffer laid out like ``values``."""
        views: dict[str, Tensor] = {}
        for name, (_, *rest) in self._shapes.items():
            start = self.offsets[name]
            views[name] = flat[:, start : start + math.prod(rest)].unflatten(1, rest)
        return views

    def initialise(self, generators: Sequence[torch.Generator], start: Mapping[str, FloatArray]) -> None:
        """Draw each seed's weights from its generator, uniform in ±1/sqrt(inputs), or take ``start``'s."""
        views = self.views(self.values)
        for seed, generator in enumerate(generators):
            for name, view in views.items():
                inputs = self._shapes[name.replace(".bias", ".weight")][1]
                draw = torch.rand(view.shape[1:], generator=generator) * 2 - 1
                view[seed] = (draw / math.sqrt(inputs)).to(view.device)
        for name, values in start.items():
            views[name].copy_(torch.from_numpy(values))

    def fill_gradient(self, loss: Tensor) -> None:
        """Put the gradient of a scalar loss into ``gradient``."""
        gradients = torch.autograd.grad(loss, list(self._leaves.values()))
        for view, gradient in zip(self._gradient_views, gradients, strict=True):
            view.copy_(gradient)

    def arrays(self, flat: Tensor) -> dict[str, FloatArray]:
        """The tensors of a buffer laid out like ``values``, as float64 arrays."""
        return {name: view.cpu().double().contiguous().numpy() for name, view in self.views(flat).items()}
