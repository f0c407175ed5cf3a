"""Planning on a two-link arm, whose tool says where both joints are."""

from dataclasses import dataclass

import numpy as np
import pytest
import torch

from latentarm.evaluation.approach import SolverConfig
from latentarm.evaluation.controllability import reach_goals
from latentarm.evaluation.samples import StartGoalPairs
from latentarm.robots.planar import planar
from latentarm_research.metrics.shooting import CLOSE_M, ShootingConfig, planned_reach

CHAIN = planar(2).chain
STEP_S = 0.1
BENT = np.array([0.0, 1.0])


@dataclass(frozen=True)
class Driven:
    """a = speed (z1, z2), or where parked speed (z1, s1² z2), in NumPy and in torch."""

    speed: float
    parked: bool
    latent_dim: int = 2

    def decode(self, z, context):
        second = z[..., 1] * (context[..., 0] ** 2 if self.parked else 1.0)
        stack = torch.stack if isinstance(z, torch.Tensor) else np.stack
        return self.speed * stack([z[..., 0] + 0 * context[..., 0], second], -1)

    def observe(self, context):
        return context


def reached(decoder, goal, **changes):
    pairs = StartGoalPairs(start=BENT[None], goal=np.asarray(goal)[None])
    planned = planned_reach([decoder], [decoder], pairs, CHAIN, STEP_S, ShootingConfig(**changes))
    greedy = reach_goals([decoder], pairs, CHAIN, STEP_S, SolverConfig())
    return planned[0, 0], greedy.tool_error_m[0, 0]


def test_what_a_greedy_operator_reaches_is_reached():
    planned, greedy = reached(Driven(0.3, parked=False), BENT + np.array([0.4, -0.5]))
    assert greedy < CLOSE_M
    assert planned <= greedy


def test_a_plan_leads_out_of_a_dead_end():
    """The second joint moves only while the first is turned aside, and the goal has the first where it is."""
    planned, greedy = reached(Driven(0.5, parked=True), BENT + np.array([0.0, 0.4]))
    assert greedy > 0.02
    assert planned < 0.01 * greedy


@pytest.mark.parametrize("iterations", [0, 2])
def test_no_plan_is_worse_than_greedy(iterations):
    rng = np.random.default_rng(0)
    decoders = [Driven(0.3, parked=True), Driven(0.1, parked=False)]
    start = BENT + rng.uniform(-0.5, 0.5, (5, 2))
    pairs = StartGoalPairs(start=start, goal=start + rng.uniform(-0.5, 0.5, (5, 2)))
    planned = planned_reach(decoders, decoders, pairs, CHAIN, STEP_S, ShootingConfig(iterations=iterations))
    greedy = reach_goals(decoders, pairs, CHAIN, STEP_S, SolverConfig())
    assert planned.shape == (2, 5)
    assert (planned <= greedy.tool_error_m).all()


def test_inputs_stay_within_their_range():
    """At full input for 6 s each joint turns by 0.3 rad at most."""
    goal = BENT + np.array([1.0, 0.0])
    planned, _ = reached(Driven(0.05, parked=False), goal)
    within = np.stack(np.meshgrid(*2 * [np.linspace(-0.3, 0.3, 301)]), axis=-1)
    away = CHAIN.forward(BENT + within).position - CHAIN.forward(goal).position
    assert planned == pytest.approx(np.linalg.norm(away, axis=-1).min(), rel=1e-4)


def test_a_decoder_that_overflows_counts_as_not_there():
    class Exploding(Driven):
        def decode(self, z, context):
            return super().decode(z, context) * 1e30

    pairs = StartGoalPairs(start=BENT[None], goal=BENT[None] + 0.3)
    calm, wild = Driven(0.3, parked=False), Exploding(0.3, parked=False)
    with np.errstate(all="ignore"):
        planned = planned_reach([calm], [wild], pairs, CHAIN, STEP_S, ShootingConfig(iterations=2))
    assert np.isfinite(planned).all()
