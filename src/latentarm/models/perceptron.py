"""Many small perceptrons with their gradient written out, for training."""

from typing import Any, final

import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

_aten = torch.ops.aten


@final
class Perceptrons(torch.autograd.Function):
    """S perceptrons with SiLU hidden units and a linear output, see `latentarm.models.networks.mlp`.

    Between the layers the B pairs come last, so that narrow layers fill the processor's vectors too, and each
    hidden layer has a further unit that is always one: a bias is then a row of the weights, and its gradient
    comes out of the same product as theirs.
    """

    @staticmethod
    def forward(ctx: Any, count: int, *tensors: Tensor) -> Tensor:
        """Outputs (S, B, out) for ``count`` inputs (S, B, k), followed by each layer's weight and bias."""
        inputs, parameters = tensors[:count], tensors[count:]
        weights = [_joined(one, bias) for one, bias in zip(parameters[::2], parameters[1::2], strict=True)]
        seeds, pairs = inputs[0].shape[:2]
        values = inputs[0].new_empty(seeds, weights[0].shape[1], pairs)
        *places, one = values.split([*(part.shape[-1] for part in inputs), 1], dim=1)
        for place, part in zip(places, inputs, strict=True):
            place.copy_(part.mT)
        one.fill_(1.0)
        befores: list[Tensor] = []
        every = [values]
        for weight in weights[:-1]:
            before = torch.bmm(weight.mT, values)
            values = before.new_empty(seeds, weight.shape[2] + 1, pairs)
            _aten.silu.out(before, out=values[:, :-1])
            values[:, -1:].fill_(1.0)
            befores.append(before)
            every.append(values)
        ctx.save_for_backward(*every, *befores, *weights)
        ctx.widths = [part.shape[-1] for part in inputs]
        return torch.bmm(values.mT, weights[-1])

    @staticmethod
    @once_differentiable
    def backward(  # pyright: ignore[reportIncompatibleMethodOverride]
        ctx: Any, *gradients: Tensor
    ) -> tuple[Tensor | None, ...]:
        """Gradients of the inputs that need one, and of the parameters."""
        depth = (len(ctx.saved_tensors) + 1) // 3
        values = ctx.saved_tensors[:depth]
        befores, weights = ctx.saved_tensors[depth : 2 * depth - 1], ctx.saved_tensors[2 * depth - 1 :]
        of_parameters: list[Tensor] = []
        after = gradients[0].mT
        for layer in reversed(range(depth)):
            of_weight = torch.bmm(values[layer], after.mT)
            of_parameters[:0] = of_weight[:, :-1], of_weight[:, -1:]
            if layer:
                after = torch.bmm(weights[layer][:, :-1], after)
                _aten.silu_backward.grad_input(after, befores[layer - 1], grad_input=after)
        rows = weights[0][:, :-1].split(ctx.widths, dim=1)
        needed = ctx.needs_input_grad[1 : 1 + len(rows)]
        of_inputs = [torch.bmm(row, after).mT if on else None for row, on in zip(rows, needed, strict=True)]
        return None, *of_inputs, *of_parameters


def _joined(weight: Tensor, bias: Tensor) -> Tensor:
    """Weight and bias as one matrix (S, in + 1, out): a view where the bias follows the weight in memory."""
    seeds, inputs, outputs = weight.shape
    end = weight.data_ptr() + weight.itemsize * inputs * outputs
    if end == bias.data_ptr() and weight.stride() == (bias.stride(0), outputs, 1):
        return weight.as_strided((seeds, inputs + 1, outputs), weight.stride())
    return torch.cat([weight, bias], dim=1)
