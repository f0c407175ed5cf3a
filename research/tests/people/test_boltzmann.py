from dataclasses import replace

import numpy as np
import pytest

from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.core.types import Context
from latentarm.robots.catalogue import load_robot
from latentarm_research.people.boltzmann import BoltzmannConfig, OneStep
from latentarm_research.people.contract import UNLIMITED, KnowsTheArm, LoopLimits, Moment
from latentarm_research.people.person import Person, SimulatedPerson

PLANAR = load_robot("planar")
BENT = PLANAR.home + np.linspace(0.2, 0.6, PLANAR.dof)
HERE = Context(BENT, np.zeros(0))


def pose_after(joint_moves):
    return PLANAR.chain.forward(BENT + np.asarray(joint_moves))


def operator(**changes):
    return SimulatedPerson(PLANAR, Person(replace(BoltzmannConfig(), **changes)), period_s=0.05)


def outlook(controller, mode=0, **changes):
    """What they could do here, and how likely each is."""
    decision = OneStep(replace(BoltzmannConfig(), decision_s=0.05, **changes), period_s=0.05)
    moment = Moment(HERE, mode, AHEAD, np.zeros(controller.input_dim))
    knows, rng = KnowsTheArm(PLANAR.chain, UNLIMITED), np.random.default_rng(0)
    return decision.outlook(moment, controller, knows, rng)


def left(controller, inputs, mode):
    """Squared distance that inputs (N, 2) leave after half a second, m²."""
    reached = PLANAR.chain.forward(BENT + 0.5 * controller.action(inputs, HERE, mode))
    cosine = (np.trace(reached.rotation @ AHEAD.rotation.T, axis1=-2, axis2=-1) - 1) / 2
    angle = np.arccos(np.clip(cosine, -1, 1))
    return ((reached.position - AHEAD.position) ** 2).sum(axis=-1) + (0.2 * angle) ** 2


def disc(points=20000):
    """Points spread evenly over the disc of inputs, like the seeds of a sunflower."""
    turn, size = np.arange(points) * np.pi * (3 - 5**0.5), np.sqrt((np.arange(points) + 0.5) / points)
    return size[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)


AHEAD = pose_after([0.4, -0.3, 0.2, 0.1, 0.0])


def test_every_input_is_within_the_reach_of_the_stick(any_axes):
    person, rng = operator(beta=100.0, decision_s=0.05), np.random.default_rng(0)
    given = np.stack([person.act(HERE, any_axes, 0, AHEAD, rng).u for _ in range(50)])
    assert given.shape == (50, any_axes.input_dim)
    assert (np.linalg.norm(given, axis=1) <= 1 + 1e-9).all()
    seen = outlook(any_axes)
    assert seen.switch == 0.0
    assert seen.push + seen.rest == pytest.approx(1.0)


@pytest.mark.parametrize("beta", [0.0, 10.0, 300.0, 2000.0])
def test_letting_go_and_switching_count_by_what_they_leave(beta):
    controller, inputs = EndEffectorController(PLANAR), disc()
    cost = [left(controller, inputs, mode) for mode in range(3)]
    still = left(controller, np.zeros((1, 2)), 0)[0]
    switched = (np.sqrt(min(one.min() for one in cost[1:])) + 0.015) ** 2
    switch = 0.04 * np.exp(-beta * switched)
    stay = 0.96 * np.exp(-beta * min(cost[0].min(), still))
    rest, push = 0.04 * np.exp(-beta * still), 0.96 * np.exp(-beta * cost[0]).mean()
    seen = outlook(controller, beta=beta)
    assert seen.switch == pytest.approx(switch / (switch + stay), rel=0.02)
    assert seen.rest == pytest.approx(stay / (switch + stay) * rest / (rest + push), rel=0.02)
    assert seen.push + seen.rest + seen.switch == pytest.approx(1.0)


def test_inputs_come_as_often_as_equation_24_says(one_mode):
    person, rng = operator(beta=300.0, decision_s=0.05), np.random.default_rng(0)
    given = np.stack([person.act(HERE, one_mode, 0, AHEAD, rng).u for _ in range(500)])
    given, inputs = given[given.any(axis=1)], disc()
    weight = np.exp(-300.0 * left(one_mode, inputs, 0))
    mean = weight @ inputs / weight.sum()
    spread = np.sqrt(weight @ (inputs - mean) ** 2 / weight.sum())
    assert (np.abs(given.mean(axis=0) - mean) < 4.5 * spread / np.sqrt(len(given))).all()
    assert given.std(axis=0) == pytest.approx(spread, rel=0.12)


def test_somebody_who_must_come_near_counts_distances_for_more(one_mode):
    config, near = BoltzmannConfig(), pose_after([0.02, -0.01, 0.0, 0.0, 0.0])
    usual = config.missed(near, pose_after(0.0), 0.02)
    careful = config.missed(near, pose_after(0.0), 0.005)
    assert careful[:3] == pytest.approx(4.0 * usual[:3])
    assert careful[3:] == pytest.approx(usual[3:])


@pytest.mark.parametrize(("within_m", "switches"), [(0.02, False), (0.008, True)])
def test_what_another_mode_gains_is_worth_a_switch_where_it_must_be_near(within_m, switches):
    """12 mm to the side of a target, and the mode moves up and down only."""
    robot = load_robot("panda")
    here = robot.chain.forward(robot.home)
    aside = replace(here, position=here.position + np.array([0.012, 0.0, 0.0]))
    decision = OneStep(BoltzmannConfig(), period_s=0.01)
    context = Context(robot.home, np.zeros(0))
    moment = Moment(context, 1, aside, np.zeros(2), within_m)
    knows = KnowsTheArm(robot.chain, UNLIMITED)
    seen = decision.outlook(moment, EndEffectorController(robot), knows, np.random.default_rng(0))
    # Ten times per second; without reason it is 0.04.
    assert seen.switch > 0.1 if switches else seen.switch < 0.04


def test_a_perfectly_rational_one_always_takes_the_best(one_mode):
    target = pose_after(0.5 * 0.5 * np.array([0.0, 1.0, 0.0, 0.0, 0.0]))
    person = operator(beta=np.inf)
    for seed in range(20):
        person.reset()
        given = person.act(HERE, one_mode, 0, target, np.random.default_rng(seed))
        assert given.u == pytest.approx([0.0, 1.0], abs=0.02)


def test_at_the_target_a_rational_one_lets_go_even_if_the_decoder_drifts(planar, one_mode):
    class Drifts(type(one_mode)):
        def action(self, z, context, mode):
            return super().action(z, context, mode) + 0.3

    drifting = Drifts([0.5 * np.eye(planar.dof)[:2]])
    given = operator(beta=np.inf).act(HERE, drifting, 0, pose_after(0.0), np.random.default_rng(0))
    assert not given.u.any()


def test_who_knows_the_arm_knows_how_fast_it_may_go(planar, one_mode):
    fast = type(one_mode)([2.0 * np.eye(planar.dof)[:2]])
    rates = 2.0 * disc()
    slowed = rates * (0.5 / np.maximum(np.abs(rates).max(axis=1, keepdims=True), 0.5))
    reached = planar.chain.forward(BENT + 0.5 * slowed @ np.eye(planar.dof)[:2]).position
    for away_rad in (0.1, 1.0):
        target = pose_after([away_rad, 0.0, 0.0, 0.0, 0.0])
        knows, moment = KnowsTheArm(planar.chain, LoopLimits(speed=0.5)), Moment(HERE, 0, target, np.zeros(2))
        decision = OneStep(BoltzmannConfig(rotation_weight=0.0), period_s=0.05)
        seen = decision.outlook(moment, fast, knows, np.random.default_rng(0))
        nearest = np.linalg.norm(reached - target.position, axis=1).min()
        assert seen.left_m == pytest.approx(nearest, abs=0.05 * seen.rest_m)


@pytest.mark.parametrize("dead_zone", [0.02, 0.3])
def test_nobody_means_a_push_that_the_loop_takes_for_rest(planar, one_mode, dead_zone):
    person = SimulatedPerson(planar, Person(), 0.1, LoopLimits(dead_zone))
    target, rng = pose_after([0.02, -0.02, 0.0, 0.0, 0.0]), np.random.default_rng(0)
    given = np.stack([person.act(HERE, one_mode, 0, target, rng).u for _ in range(200)])
    length = np.linalg.norm(given, axis=1)
    assert ((length == 0.0) | (length > dead_zone)).all()
    assert (length == 0.0).any()
    assert (length > dead_zone).any()


def test_an_input_is_held_until_the_next_decision(one_mode):
    person = operator(beta=0.0, decision_s=0.2)
    rng = np.random.default_rng(0)
    given = np.array([person.act(HERE, one_mode, 0, AHEAD, rng).u for _ in range(400)])
    for first in range(0, 400, 4):
        assert (given[first : first + 4] == given[first]).all()
    assert len(np.unique(given[::4], axis=0)) > 10


def test_a_mode_is_switched_for_a_gain_above_its_cost_and_not_below(two_modes):
    # Only the second mode's joints are off, so the first mode has nothing to offer.
    target = pose_after([0.0, 0.0, 0.25, 0.0, 0.0])
    gain = np.linalg.norm(PLANAR.chain.forward(BENT).position - target.position)
    switches = {
        cost: operator(beta=np.inf, rotation_weight=0.0, switch_cost=cost)
        .act(HERE, two_modes, 0, target, np.random.default_rng(0))
        .switch_mode
        for cost in (0.1 * gain, 10 * gain)
    }
    assert list(switches.values()) == [True, False]


def test_during_a_switch_there_is_no_input_and_one_request(two_modes):
    person = operator(beta=np.inf, switch_s=0.5)
    target = pose_after([0.0, 0.0, 0.25, 0.0, 0.0])
    rng = np.random.default_rng(0)
    given = [person.act(HERE, two_modes, 0, target, rng)]
    given += [person.act(HERE, two_modes, 1, target, rng) for _ in range(11)]
    assert [one.switch_mode for one in given] == [True] + 11 * [False]
    assert not np.array([one.u for one in given[:10]]).any()
    assert given[10].u.any()


def test_a_new_drive_begins_afresh(two_modes):
    person = operator(beta=np.inf, switch_s=5.0)
    rng = np.random.default_rng(0)
    assert person.act(HERE, two_modes, 0, pose_after([0, 0, 0.25, 0, 0]), rng).switch_mode
    person.reset()
    assert person.act(HERE, two_modes, 0, pose_after([0.25, 0, 0, 0, 0]), rng).u.any()


def test_the_same_seed_gives_the_same_person(two_modes):
    def inputs():
        person, rng = operator(beta=100.0), np.random.default_rng(7)
        return [person.act(HERE, two_modes, 0, AHEAD, rng).u for _ in range(50)]

    assert np.array_equal(inputs(), inputs())


def test_a_decoder_that_gives_no_numbers_makes_them_let_go(planar, one_mode):
    class Broken(type(one_mode)):
        def action(self, z, context, mode):
            return np.full((*z.shape[:-1], planar.dof), np.nan)

    given = operator().act(HERE, Broken([np.eye(planar.dof)[:2]]), 0, AHEAD, np.random.default_rng(0))
    assert not given.u.any()
    assert not given.switch_mode
