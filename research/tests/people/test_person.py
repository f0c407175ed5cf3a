"""A simulated person put together: without the new traits as before, and with them what they mean."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.core.types import Context
from latentarm_research.people.boltzmann import BoltzmannConfig, OneStep
from latentarm_research.people.contract import KnowsTheArm, LoopLimits, Moment
from latentarm_research.people.motor_noise import UNSTEADY, Hand, HandConfig
from latentarm_research.people.page_rates import PAGE
from latentarm_research.people.person import Person, SimulatedPerson

PERIOD_S = 0.01
LIMITS = LoopLimits(0.05)


def driven(person, robot, controller, calls, turn=0.4, seed=0):
    """Inputs, switches and how far the tool is from where some turn of the joints would bring it."""
    operator = SimulatedPerson(robot, person, PERIOD_S, LIMITS)
    rng, state, mode = np.random.default_rng(seed), robot.home.copy(), 0
    target = robot.chain.forward(robot.home + turn)
    given, left = [], []
    for _ in range(calls):
        context = Context(state, np.zeros(0))
        one = operator.act(context, controller, mode, target, rng)
        given.append((*one.u, one.switch_mode))
        mode = (mode + one.switch_mode) % len(controller.modes)
        if LIMITS.is_push(one.u):
            state = state + PERIOD_S * controller.action(one.u, context, mode)
        left.append(np.linalg.norm(robot.chain.forward(state).position - target.position))
    return np.array(given), np.array(left)


def test_a_person_without_the_new_traits_is_the_old_one_to_the_bit(planar, two_modes):
    decision = OneStep(BoltzmannConfig(), PERIOD_S, LIMITS.dead_zone)
    imagination, hand = KnowsTheArm(planar.chain, LIMITS), Hand(UNSTEADY, PERIOD_S)
    rng, state, mode, u = np.random.default_rng(0), planar.home.copy(), 0, np.zeros(2)
    target = planar.chain.forward(planar.home + 0.4)
    expected = []
    for _ in range(60):
        context = Context(state, np.zeros(0))
        seen = hand.sees(Moment(context, mode, target, u))
        one = hand.gives(decision.decide(seen, two_modes, imagination, rng), rng)
        u = one.u
        expected.append((*u, one.switch_mode))
        mode = (mode + one.switch_mode) % 2
        if LIMITS.is_push(u):
            state = state + PERIOD_S * two_modes.action(u, context, mode)
    given, _ = driven(Person(hand=UNSTEADY), planar, two_modes, 60)
    np.testing.assert_array_equal(given, expected)


def test_a_person_pushes_gently_where_that_is_fit(planar, one_mode):
    def pushed(speed):
        operator = SimulatedPerson(planar, Person(), PERIOD_S, LIMITS)
        context, target = Context(planar.home, np.zeros(0)), planar.chain.forward(planar.home + 0.4)
        rng = np.random.default_rng(0)
        return float(np.linalg.norm(operator.act(context, one_mode, 0, target, rng, speed=speed).u))

    beyond = LIMITS.dead_zone
    assert pushed(0.3) - beyond == pytest.approx(0.3 * (pushed(1.0) - beyond))


def test_one_who_anticipates_overshoots_less(planar, one_mode):
    late = Person(BoltzmannConfig(beta=1e6, horizon_s=0.2), hand=HandConfig(reaction_s=0.4))
    turn = np.concatenate([[0.3, -0.3], np.zeros(planar.dof - 2)])
    _, left = driven(late, planar, one_mode, 240, turn)
    _, anticipated = driven(replace(late, anticipates=True), planar, one_mode, 240, turn)
    assert anticipated[140:].mean() < 0.5 * left[140:].mean()


def test_the_page_delays_what_a_person_does_and_no_more(planar, two_modes):
    given, _ = driven(Person(page=PAGE), planar, two_modes, 200)
    straight, _ = driven(Person(), planar, two_modes, 200)
    assert np.flatnonzero(straight.any(axis=1))[0] < np.flatnonzero(given.any(axis=1))[0] <= 5
    assert given[:, 2].sum() > 0
