"""A replayed computation gives what the computation gives."""

from itertools import pairwise

import numpy as np
import pytest
import torch

from latentarm.models.batches import TrainingData
from latentarm.models.networks import mlp
from latentarm.models.replay import RecordedStep, UnreplayableError
from latentarm.models.training import TrainingConfig, train

CPU = torch.device("cpu")


def replayed(compute, inputs, result):
    """The result of a replay after the inputs have changed, and what it should be."""
    replay = RecordedStep(compute, inputs, CPU)
    for tensor in inputs:
        tensor.data.uniform_(-1, 1, generator=torch.Generator().manual_seed(1))
    result.zero_()
    replay()
    first = result.clone()
    replay()
    assert torch.equal(first, result), "a replay must not depend on the one before"
    compute()
    return first, result


def test_gradients_constants_views_and_writes_in_place_are_replayed():
    x, result = torch.rand(4, 3), torch.zeros(4, 3)
    weight = torch.rand(3, 3)

    def compute():
        leaf = x.detach().requires_grad_()
        table = torch.arange(9.0).view(3, 3).sin()
        hidden = (leaf @ weight).tanh() + leaf[:, :1]
        padded = torch.zeros(4, 6)
        padded[:, 2:5] = hidden
        padded.mul_(2.0)
        chosen = table[hidden.argmax(1)]
        best = (padded[:, 2:5] * chosen).max(1).values
        result.copy_(torch.autograd.grad(best.exp().sum(), leaf)[0])

    assert torch.equal(*replayed(compute, [x], result))


def test_a_tensor_whose_shape_is_changed_in_place_is_replayed():
    x, result = torch.rand(4, 3), torch.zeros(4)

    def compute():
        largest = x.amax(1, keepdim=True)
        spread = (x - largest).exp().sum(1)
        largest.squeeze_(1)  # as in torch's own logsumexp
        result.copy_(largest + spread.log())

    assert torch.equal(*replayed(compute, [x], result))


def test_memory_is_used_again_only_where_nothing_reads_it_any_more():
    x, result = torch.rand(50), torch.zeros(50)

    def compute():
        kept = [x * number for number in range(2, 6)]
        total = x
        for number in range(20):
            total = (total + number).sin() + kept[number % 4].cos()
        result.copy_(total + sum(kept))

    assert torch.equal(*replayed(compute, [x], result))


@pytest.mark.parametrize(
    "depends",
    [lambda x: x * x.sum().item(), lambda x: x[x > 0], lambda x: x.nonzero()],
    ids=["a number", "a mask", "indices"],
)
def test_what_depends_on_values_is_refused(depends):
    x = torch.rand(4)
    with pytest.raises(UnreplayableError, match="depends on values"):
        RecordedStep(lambda: depends(x), [x], CPU)


def test_an_objective_that_depends_on_more_than_its_arguments_is_not_replayed():
    """Its steps are those of a loop that calls it every time."""
    rng = np.random.default_rng(0)
    context, action = rng.normal(size=(64, 2)), rng.normal(size=(64, 1))
    nothing = np.empty((64, 0))
    data = TrainingData(context, action, context, action, nothing[:0], nothing, nothing)
    config = TrainingConfig(0.01, epochs=40, batch_size=4, patience=40, checkpoint_interval_s=1.0)
    shapes = {"decoder.0.weight": (2, 2, 1), "decoder.0.bias": (2, 1, 1)}
    calls = []

    def objective(networks, batch):
        calls.append(len(calls))
        error = (mlp(networks["decoder"], batch.context) - batch.action).square().mean((1, 2))
        return error * (1 + len(calls) % 3)

    train(objective, shapes, 0, data, [0, 1], config, device=CPU)
    assert len(calls) >= 40 * 16


@pytest.mark.parametrize("widths", [(3, 2), (3, 5, 2), (3, 5, 4, 2)])
@pytest.mark.parametrize("adjacent", [True, False])
def test_the_gradient_that_is_written_out_is_autograds(widths, adjacent):
    generator = torch.Generator().manual_seed(0)
    layers = []
    for before, after in pairwise(widths):
        flat = torch.randn(2, (before + 1) * after, generator=generator, dtype=torch.float64)
        weight, bias = flat.split([before * after, after], dim=1)
        weight, bias = weight.unflatten(1, (before, after)), bias.unflatten(1, (1, after))
        layers.append((weight, bias) if adjacent else (weight.clone(), bias.clone()))
    first, second = (torch.randn(2, 6, width, generator=generator, dtype=torch.float64) for width in (2, 1))
    parameters = [parameter.detach().requires_grad_() for layer in layers for parameter in layer]
    leaves = [*parameters, first.requires_grad_(), second.requires_grad_()]
    trained = list(zip(parameters[::2], parameters[1::2], strict=True))

    values = torch.cat([first, second], dim=-1)
    for weight, bias in trained[:-1]:
        values = torch.nn.functional.silu(values @ weight + bias)
    expected = values @ trained[-1][0] + trained[-1][1]
    output = mlp(trained, first, second)
    assert torch.allclose(output, expected, rtol=1e-7, atol=1e-7)
    for ours, autograds in zip(
        torch.autograd.grad(output.sin().sum(), leaves),
        torch.autograd.grad(expected.sin().sum(), leaves),
        strict=True,
    ):
        assert torch.allclose(ours, autograds, rtol=1e-7, atol=1e-7)
    with torch.no_grad():
        assert torch.allclose(mlp(trained, first, second), expected, rtol=1e-7, atol=1e-7)
