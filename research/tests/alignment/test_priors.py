"""Each prior is zero for a map that has its property and positive for one that lacks it."""

import numpy as np
import pytest
import torch

from latentarm_research.alignment.priors import (
    NO_PRIORS,
    consistent,
    proportional,
    reversible,
    supervised,
)
from latentarm_research.alignment.transition import Place, Push

RUNS, MANY = 2, 200


def linear(u, state):
    return u @ torch.tensor([[0.3, 0.1], [-0.2, 0.4]])


def with_offset(u, state):
    return linear(u, state) + 0.1


def curved(u, state):
    return linear(u * u.abs(), state)


def turning(u, state):
    """The same speed everywhere, in a direction that turns with the state."""
    cos, sin = torch.cos(5 * state[..., :1]), torch.sin(5 * state[..., :1])
    return torch.cat([cos * u[..., :1] - sin * u[..., 1:], sin * u[..., :1] + cos * u[..., 1:]], dim=-1)


def push(step, state, u):
    """A push of a point in the plane, whose pose is its state."""
    after = state + step(u, state)
    return Push(Place(state, state, state), after, after)


@pytest.fixture
def draws():
    rng = torch.Generator().manual_seed(0)
    state, other, u = (torch.rand(RUNS, MANY, 2, generator=rng) * 2 - 1 for _ in range(3))
    return state, other, u, torch.rand(RUNS, MANY, 1, generator=rng) * 2 - 1


def losses(step, draws, gamma=1.0):
    state, other, u, alpha = draws
    first = push(step, state, u)
    return {
        "proportional": proportional(first, push(step, state, alpha * u), alpha),
        "reversible": reversible(first, push(step, first.context, -u)),
        "consistent": consistent(first, push(step, other, u), gamma, 2),
    }


@pytest.mark.parametrize(
    ("prior", "has", "lacks"),
    [
        ("proportional", [linear, turning], [curved, with_offset]),
        ("reversible", [linear, curved], [turning, with_offset]),
        ("consistent", [linear, curved, with_offset], [turning]),
    ],
)
def test_a_prior_tells_maps_that_have_the_property_from_those_that_lack_it(prior, has, lacks, draws):
    for step in has:
        assert losses(step, draws)[prior].numpy() == pytest.approx(0, abs=1e-12)
    for step in lacks:
        loss = losses(step, draws)[prior]
        assert loss.shape == (RUNS,)
        assert (loss > 1e-3).all()


def test_what_was_asked_is_met_or_missed(draws):
    state, other, u, _ = draws
    reached = push(linear, state, u)
    assert (supervised(reached, reached.pose) == 0).all()
    expected = (reached.pose - other).square().sum(-1).mean(-1)
    np.testing.assert_allclose(supervised(reached, other), expected, rtol=1e-7, atol=1e-7)


def test_consistency_counts_less_the_farther_apart_two_states_are(draws):
    state, _, u, _ = draws
    first = push(turning, state, u)
    near, far = (push(turning, state + shift, u) for shift in (0.1, 0.1 + 2 * np.pi / 5))
    # The motions differ alike in both; only the distance does.
    assert (consistent(first, near, 1.0, 2) > 1.5 * consistent(first, far, 1.0, 2)).all()
    np.testing.assert_allclose(
        consistent(first, near, 0.0, 2), consistent(first, far, 0.0, 2), rtol=1e-3, atol=0
    )


def test_a_belief_is_no_distance(draws):
    state, _, u, _ = draws
    first, other = push(turning, state, u), push(turning, state + 0.1, u)

    def believing(push, belief):
        context = torch.cat([push.before.context, torch.full((RUNS, MANY, 3), belief)], dim=-1)
        return push._replace(before=push.before._replace(context=context))

    np.testing.assert_allclose(
        consistent(believing(first, 0.1), believing(other, 0.9), 1.0, 2),
        consistent(first, other, 1.0, 2),
        rtol=1e-7,
        atol=1e-7,
    )


def test_no_priors_are_none():
    assert (NO_PRIORS.proportional, NO_PRIORS.reversible, NO_PRIORS.consistent) == (0, 0, 0)
