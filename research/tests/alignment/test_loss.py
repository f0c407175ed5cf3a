"""The loss of equation 23 as training sees it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import torch

from latentarm.alignment.runtime import layer_shapes
from latentarm.core.errors import UserError
from latentarm.models.estimators import MODELS
from latentarm.models.networks import group_layers
from latentarm_research.alignment.loss import ANSWERS_AT_ONCE, AlignmentLoss, Draw
from latentarm_research.alignment.priors import NO_PRIORS, Priors

RUNS = 2


def weights(decoder, hidden=(6, 5), scale=0.5, seed=0):
    """Weights of f for two runs in double precision, by name."""
    rng = torch.Generator().manual_seed(seed)
    shapes = layer_shapes(decoder.latent_dim, decoder.context_dim, hidden)
    return {
        name: scale * torch.randn(RUNS, *shape, generator=rng, dtype=torch.float64)
        for name, shape in shapes.items()
    }


@pytest.fixture(scope="module")
def fitted(swings, arm):
    """A model of a kind and a context, hardly trained; each is fitted once."""

    @cache
    def fit(kind, context):
        return MODELS[kind](epochs=1, hidden=(6,), window=2, context=context).fit(swings, chain=arm.chain)

    return fit


def one_step(loss, batch_size=4):
    return Draw(*(part[0] for part in loss.draws([5, 6], 1, batch_size)))


@pytest.mark.parametrize(
    "priors",
    [NO_PRIORS, Priors(1, 0, 0), Priors(0, 1, 0), Priors(0, 0, 1), Priors()],
    ids=["none", "proportional", "reversible", "consistent", "all"],
)
@pytest.mark.parametrize("kind", ["cae", "scl", "isometric", "pca"])
@pytest.mark.parametrize("context", ["state", "state_belief"])
def test_the_gradient_is_the_slope(fitted, kind, context, priors, arm, answered):
    decoder = fitted(kind, context).torch_decoder(0, torch.float64)
    answers = [answered(4, goals=decoder.context_dim - 4, seed=seed) for seed in range(RUNS)]
    unlabelled = answered(4, count=9, goals=decoder.context_dim - 4, seed=7).motions.context
    loss = AlignmentLoss(decoder, arm.chain, answers, unlabelled, priors)
    draw, values = one_step(loss), weights(decoder)
    leaves = {name: value.clone().requires_grad_() for name, value in values.items()}
    gradients = torch.autograd.grad(loss(group_layers(leaves), draw).sum(), list(leaves.values()))
    rng = torch.Generator().manual_seed(1)
    # With these weights of f the homogeneous model swings the arm round and round: finer steps.
    step = 1e-8 if kind == "homogeneous" else 1e-6
    for name, gradient in zip(values, gradients, strict=True):
        direction = torch.randn(values[name].shape, generator=rng, dtype=torch.float64)
        there, back = (
            loss(group_layers({**values, name: values[name] + way * step * direction}), draw).sum()
            for way in (1, -1)
        )
        slope = float((there - back) / (2 * step))
        assert slope == pytest.approx(float((gradient * direction).sum()), rel=2e-5, abs=1e-7)


def test_an_arm_that_does_not_move_has_the_loss_one(linear_model, slides, answered):
    decoder = linear_model.torch_decoder(0, torch.float64)
    answers = [answered(3, seed=seed) for seed in range(RUNS)]
    loss = AlignmentLoss(decoder, slides.chain, answers, answers[0].motions.context, Priors())
    still = group_layers(weights(decoder, scale=0.0))
    np.testing.assert_allclose(loss(still, one_step(loss)).numpy(), 1.0, rtol=0, atol=1e-12)


def test_the_unit_of_length_does_not_matter(curved_model, arm, answered):
    """The same answers about motions half as long, which take half as long: only the curvature of the arm
    is left to tell them apart."""
    decoder = curved_model.torch_decoder(0, torch.float64)
    answers = answered(4)
    motions = answers.motions
    nearer = [
        replace(
            answers,
            motions=replace(
                motions,
                end=motions.start + share * (motions.end - motions.start),
                duration_s=share * motions.duration_s,
            ),
        )
        for share in (1e-3, 1e-4)
    ]
    networks = group_layers(weights(decoder, scale=0.1))
    values = []
    for one in nearer:
        loss = AlignmentLoss(decoder, arm.chain, [one] * RUNS, motions.context, Priors())
        values.append(loss(networks, one_step(loss)).numpy())
    np.testing.assert_allclose(values[0], values[1], rtol=1e-2)


def test_a_runs_draws_are_its_own(linear_model, slides, answered):
    many = [answered(3, count=ANSWERS_AT_ONCE + 50)] * 3
    loss = AlignmentLoss(linear_model.torch_decoder(), slides.chain, many, many[0].motions.context, Priors())
    together = loss.draws([4, 5, 6], 7, 3)
    alone = loss.draws([5], 7, 3)
    assert together.answers.shape == (7, 3, ANSWERS_AT_ONCE)
    for part, own in zip(together, alone, strict=True):
        assert torch.equal(part[:, 1], own[:, 0])
        assert not torch.equal(part[:, 0], own[:, 0])


def test_motions_that_move_no_tool_are_refused(linear_model, slides, answered):
    answers = answered(3)
    still = replace(answers, motions=replace(answers.motions, end=answers.motions.start))
    with pytest.raises(UserError, match="None of the motions"):
        AlignmentLoss(linear_model.torch_decoder(), slides.chain, [still], answers.motions.context, Priors())
