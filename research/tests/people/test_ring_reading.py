"""A simulated newcomer who reads the ring of the page."""

import math
from dataclasses import replace

import numpy as np
import pytest

from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.stick_ring import AHEAD_S, DIRECTIONS, full_pushes
from latentarm.core.types import Context
from latentarm.robots.catalogue import load_robot
from latentarm_research.people.boltzmann import BoltzmannConfig
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.people.contract import LoopLimits
from latentarm_research.people.motion import shifted
from latentarm_research.people.own_directions import OwnSpeed
from latentarm_research.people.person import Person, SimulatedPerson
from latentarm_research.people.ring_reading import RingReading, RingReadingConfig, nearest_drawn

PANDA = load_robot("panda")
LINES = EndEffectorController(PANDA)
PERIOD_S = 0.05
LIMITS = LoopLimits(0.02)
NO_GOALS = np.zeros(0)
READS = replace(PEOPLE["reading"], speed=OwnSpeed())  # at full speed, as every push is drawn
SEES_WELL = Person(
    decides=BoltzmannConfig(beta=np.inf, rest_share=0.0, switch_share=0.0),
    imagines=RingReadingConfig(error_rad=0.0),
)


def away(*change):
    """A target so far from the tool, m and rad."""
    return shifted(PANDA.chain.forward(PANDA.home), np.array(change))


def first_push(person, target, controller=LINES, robot=PANDA, seed=0):
    operator = SimulatedPerson(robot, person, PERIOD_S, LIMITS)
    return operator.act(Context(robot.home, NO_GOALS), controller, 0, target, np.random.default_rng(seed))


def driven(person, robot, controller, target, calls, seed=0):
    """Inputs, modes and where the arm is at last, which moves as the controller wants."""
    operator, rng = SimulatedPerson(robot, person, PERIOD_S, LIMITS), np.random.default_rng(seed)
    state, mode, given, modes = robot.home.copy(), 0, [], []
    for _ in range(calls):
        context = Context(state, NO_GOALS)
        one = operator.act(context, controller, mode, target, rng)
        mode = (mode + one.switch_mode) % len(controller.modes)
        given.append(one.u)
        modes.append(mode)
        if LIMITS.is_push(one.u):
            state = state + PERIOD_S * controller.action(one.u, context, mode)
    return np.array(given), modes, robot.chain.forward(state)


def test_every_push_is_along_a_drawn_direction_and_3_percent_or_more():
    given, _, _ = driven(READS, PANDA, LINES, away(0.1, 0.05, -0.1, 0.0, 0.3, 0.0), 200)
    pushes = given[given.any(axis=1)]
    assert len(pushes) > 40
    size = np.linalg.norm(pushes, axis=1)
    np.testing.assert_allclose(pushes / size[:, None], full_pushes(2)[nearest_drawn(pushes)], atol=1e-9)
    assert size.min() >= 0.03 - 1e-9
    assert size.max() <= 1.0 + 1e-9
    assert len(set(nearest_drawn(pushes))) > 4


@pytest.mark.parametrize("wanted", range(0, DIRECTIONS, 5))
def test_who_reads_without_error_pushes_to_the_point_of_the_ring_that_is_nearest(wanted):
    cos, sin = full_pushes(2)[wanted]
    u = first_push(SEES_WELL, away(0.3 * cos, 0.3 * sin, 0.0, 0.0, 0.0, 0.0)).u
    assert nearest_drawn(u) == wanted
    assert np.linalg.norm(u) > 0.9


def test_a_near_target_takes_a_small_push():
    # What half a second of a full push of 0.15 m/s leads four times as far as.
    assert np.linalg.norm(first_push(SEES_WELL, away(0.019, 0.0, 0.0, 0.0, 0.0, 0.0)).u) == pytest.approx(
        0.25, abs=0.05
    )


@pytest.mark.parametrize("angle_deg", [5.0, 15.0])
def test_a_direction_is_misread_by_so_much(planar, one_mode, angle_deg):
    rng, context = np.random.default_rng(0), Context(planar.home, NO_GOALS)
    tool = planar.chain.forward(planar.home).position

    def directions(reading):
        """(K, 3), unit vectors to each point of the ring in one reading."""
        reached = reading.foresight(rng)(full_pushes(2), context, one_mode, (0,), AHEAD_S)
        return (reached.position[0] - tool) / np.linalg.norm(
            reached.position[0] - tool, axis=1, keepdims=True
        )

    true = directions(RingReading(planar.chain, RingReadingConfig(error_rad=0.0), LIMITS))
    reading = RingReading(planar.chain, RingReadingConfig(error_rad=math.radians(angle_deg)), LIMITS)
    angles = []
    for _ in range(300):
        read = directions(reading)
        # One shape: neighbours stay neighbours, however wrong the whole is.
        np.testing.assert_allclose(read @ read.T, true @ true.T, atol=1e-9)
        angles.append(np.arccos(np.clip(np.vecdot(read, true), -1.0, 1.0)))
    assert np.degrees(np.sqrt(np.mean(np.square(angles)))) == pytest.approx(angle_deg, rel=0.1)


def test_what_they_expect_is_what_the_ring_shows_and_less_of_less():
    foresight = RingReading(PANDA.chain, RingReadingConfig(error_rad=0.0), LIMITS).foresight(
        np.random.default_rng(0)
    )
    context, tool = Context(PANDA.home, NO_GOALS), PANDA.chain.forward(PANDA.home)
    # A push between two drawn directions is read at the nearer one.
    inputs = np.array([[1.0, 0.0], [0.5, 0.0], [0.99 * math.cos(0.05), 0.99 * math.sin(0.05)], [0.0, 0.0]])
    reached = foresight(inputs, context, LINES, (0, 2), AHEAD_S)
    gone = reached.position[0] - tool.position
    assert gone[0, 0] == pytest.approx(0.15, abs=0.01)
    np.testing.assert_allclose(gone[1:], np.array([[0.5], [0.99], [0.0]]) * gone[0], atol=1e-9)
    # The third mode turns the tool, which the pins show, and moves it next to nothing.
    turned = np.arccos((np.trace(reached.rotation[1] @ tool.rotation.T, axis1=1, axis2=2) - 1.0) / 2.0)
    np.testing.assert_allclose(turned, [0.5, 0.25, 0.495, 0.0], atol=0.02)


def test_they_find_the_mode_that_leads_there_by_its_name():
    _, modes, end = driven(READS, PANDA, LINES, away(0.0, 0.0, -0.12, 0.0, 0.0, 0.0), 240)
    assert 1 in modes
    assert np.linalg.norm(end.position - away(0.0, 0.0, -0.12, 0.0, 0.0, 0.0).position) < 0.03


def test_one_axis_has_two_directions_and_a_stick_with_a_lever_those_of_both():
    assert full_pushes(1).tolist() == [[1.0], [-1.0]]
    np.testing.assert_array_equal(full_pushes(3)[:DIRECTIONS, :2], full_pushes(2))
    assert full_pushes(3)[DIRECTIONS:].tolist() == [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]


def test_any_number_of_axes_leads_nearer(planar, any_axes):
    target = planar.chain.forward(planar.home + 0.4)
    _, _, end = driven(READS, planar, any_axes, target, 200)
    before = np.linalg.norm(planar.chain.forward(planar.home).position - target.position)
    assert np.linalg.norm(end.position - target.position) < before


def test_the_stick_stays_where_it_is_while_they_read():
    given, _, _ = driven(READS, PANDA, LINES, away(0.3, 0.2, 0.0, 0.0, 0.0, 0.0), 60)
    changes = np.flatnonzero((np.diff(given, axis=0) != 0).any(axis=1)) + 1
    assert set(changes % 6) == {0}


def test_the_same_seed_reads_the_same():
    target = away(0.1, 0.05, -0.1, 0.0, 0.0, 0.0)
    one, other, third = (driven(READS, PANDA, LINES, target, 60, seed)[0] for seed in (4, 4, 5))
    np.testing.assert_array_equal(one, other)
    assert (one != third).any()
