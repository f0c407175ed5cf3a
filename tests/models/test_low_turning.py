"""What the low-turning model's prices are, and what they do."""

import numpy as np
import pytest
import torch

from latentarm.evaluation.turning import turning as measured_turning
from latentarm.models.batches import Batch
from latentarm.models.low_turning.training import Around, LowTurning, narrowness, turning
from latentarm.models.networks import group_layers
from latentarm.robots.planar import planar

SMALL = {"seeds": 2, "epochs": 2, "hidden": (16,), "window": 2}


def half_circle(curve, velocity):
    """One context's motions (m,) and tool velocities (3,), given as functions of the stick's angle."""
    angle = np.arange(19) * np.pi / 18
    joints = np.stack([curve(one) for one in angle], axis=-1)
    tools = np.stack([np.concatenate([velocity(one), np.zeros(3)]) for one in angle], axis=-1)
    return Around(*(torch.from_numpy(values)[None, :, None, :, None] for values in (joints, tools)))


def test_a_plane_turns_as_fast_as_the_stick_and_a_third_harmonic_faster():
    """Any ellipse is once around; of a curve that leaves its plane the length is summed finely here."""

    def bent(size):
        return lambda t: np.array([np.cos(t), np.sin(t), size * np.cos(3 * t)])

    flat = half_circle(lambda t: np.array([2 * np.cos(t), 0.5 * np.sin(t)]), lambda t: np.zeros(3))
    assert turning(flat).item() == pytest.approx(1.0, rel=0.01)
    fine = np.array([bent(0.4)(t) for t in np.linspace(0, np.pi, 20001)])
    fine /= np.linalg.norm(fine, axis=1, keepdims=True)
    length = np.linalg.norm(np.diff(fine, axis=0), axis=1).sum() / np.pi
    assert turning(half_circle(bent(0.4), lambda t: np.zeros(3))).item() == pytest.approx(length, rel=0.02)


def test_the_price_of_narrowness_is_that_of_the_velocities_gram_matrix():
    """The mean of v v^T over (cos t, sin t, 0) is diag(1/2, 1/2, 0)."""
    plane = half_circle(lambda t: np.ones(2), lambda t: np.array([np.cos(t), np.sin(t), 0.0]))
    assert narrowness(plane).item() == pytest.approx(-np.log(0.501 * 0.501 * 0.001), rel=1e-6)
    space = half_circle(
        lambda t: np.ones(2), lambda t: np.array([np.cos(t), np.sin(t), np.cos(3 * t)]) / np.sqrt(2)
    )
    assert narrowness(space).item() == pytest.approx(-3 * np.log(0.251), rel=1e-6)


@pytest.fixture(scope="module")
def priced(demonstrations):
    """By the price of turning."""
    return {
        weight: LowTurning(**SMALL, turning_weight=weight, spread_weight=0.0).fit(demonstrations)
        for weight in (0.0, 0.5)
    }


def test_the_loss_charges_for_turning_as_it_is_measured(priced, demonstrations):
    """Without noise, and in the contexts that are priced: every eighth."""
    trained = priced[0.5].trained_
    context = demonstrations.episodes[0].state[:24]
    action = np.random.default_rng(0).normal(0.0, 0.3, context.shape)

    def seen(values):
        return torch.from_numpy(values).expand(2, -1, -1)

    networks = group_layers({name: torch.from_numpy(value) for name, value in trained.tensors.items()})
    observed = seen(trained.contexts.apply(context))
    nothing = torch.zeros(2, 0, 4)
    batch = Batch(observed, seen(trained.actions.apply(action)), torch.zeros(2, 24, 4), nothing, observed)
    with torch.no_grad():
        charged = priced[0.5]._loss(networks, batch) - priced[0.0]._loss(networks, batch)
    around = measured_turning([priced[0.5].decoder(0), priced[0.5].decoder(1)], context[::8], planar(4).chain)
    np.testing.assert_allclose(charged.numpy(), 0.5 * around.joints.mean(axis=(1, 2)), rtol=0.05)


def test_a_price_on_turning_makes_the_motion_turn_less(priced, demonstrations):
    context = demonstrations.episodes[0].state[::4]
    free, charged = (
        measured_turning([model.decoder(0), model.decoder(1)], context, planar(4).chain).joints.mean()
        for model in priced.values()
    )
    assert charged < free
