import math

import numpy as np
import pytest

from latentarm.alignment.answers import Motions
from latentarm.core.errors import UserError
from latentarm.core.types import Context, Pose
from latentarm.robots.catalogue import load_robot
from latentarm.tasks.inverse_kinematics import solve
from latentarm_research.people.boltzmann import BoltzmannConfig
from latentarm_research.people.expectation import Expectation, main_directions
from latentarm_research.people.person import Person, SimulatedPerson

PANDA = load_robot("panda")
CHAIN = PANDA.chain
HERE = CHAIN.forward(PANDA.home)
SIDEWAYS = np.array([0.0, 1.0, 0.0])
DOWN = np.array([0.0, 0.0, -1.0])
AS_ONE_WOULD = Expectation(CHAIN, np.stack([SIDEWAYS, DOWN]), speed_m_s=0.1)


def motion(*moves):
    """Half a second each, from the ready pose, without a turn of the tool."""
    ends = [solve(PANDA, Pose(HERE.position + np.asarray(move), HERE.rotation), PANDA.home) for move in moves]
    return Motions(np.tile(PANDA.home, (len(moves), 1)), np.stack(ends), 0.5)


def test_each_axis_asks_for_its_direction_in_proportion_and_never_beyond_a_full_push():
    asked = AS_ONE_WOULD.inputs(motion(0.02 * SIDEWAYS, -0.05 * DOWN, 0.2 * DOWN, [0.05, 0.0, 0.0]))
    np.testing.assert_allclose(asked, [[0.4, 0.0], [0.0, -1.0], [0.0, 1.0], [0.0, 0.0]], atol=2e-3)


@pytest.mark.parametrize(
    ("angle_deg", "sideways", "down"),
    [
        (0, [0.4, 0.0], [0.0, -0.4]),  # mirrored alone: down is the other way on the second axis
        (90, [0.0, 0.4], [0.4, 0.0]),  # the axes have changed places, and one of them is mirrored
        (60, [0.2, 0.2 * math.sqrt(3)], [0.2 * math.sqrt(3), -0.2]),
    ],
)
def test_a_turned_and_mirrored_stick_by_hand(angle_deg, sideways, down):
    person = AS_ONE_WOULD.turned_and_mirrored(math.radians(angle_deg))
    asked = person.inputs(motion(0.02 * SIDEWAYS, 0.02 * DOWN))
    np.testing.assert_allclose(asked, [sideways, down], atol=2e-3)


def test_turned_and_mirrored_twice_is_as_before():
    person = AS_ONE_WOULD.turned_and_mirrored(1.0).turned_and_mirrored(1.0)
    np.testing.assert_allclose(person.directions, AS_ONE_WOULD.directions, atol=1e-12)


def test_they_expect_a_motion_where_they_ask_for_it(wrist):
    person = AS_ONE_WOULD.turned_and_mirrored(math.radians(60))
    wanted = 0.03 * SIDEWAYS + 0.02 * DOWN
    u = person.inputs(motion(wanted))
    context = Context(PANDA.home, np.zeros(0))
    expected = person(u, context, wrist, (0,), 0.5)
    np.testing.assert_allclose(expected.position[0, 0], HERE.position + wanted, atol=1e-4)
    np.testing.assert_array_equal(expected.rotation[0, 0], HERE.rotation)


def test_they_push_by_their_expectation_whatever_the_arm_would_do(wrist):
    person = AS_ONE_WOULD.turned_and_mirrored(math.radians(90))
    operator = SimulatedPerson(PANDA, Person(BoltzmannConfig(beta=math.inf), imagines=person), period_s=0.1)
    target = Pose(HERE.position + 0.5 * SIDEWAYS, HERE.rotation)
    rng = np.random.default_rng(0)
    given = operator.act(Context(PANDA.home, np.zeros(0)), wrist, 0, target, rng)
    np.testing.assert_allclose(given.u, [0.0, 1.0], atol=0.02)


def test_the_main_directions_are_those_of_most_motion_even_where_all_goes_one_way():
    shown = motion(*(0.05 * DOWN + 0.01 * side * SIDEWAYS for side in (-1, 0, 1)), 0.04 * DOWN)
    directions = main_directions(shown, CHAIN, 2)
    np.testing.assert_allclose(directions, [-DOWN, SIDEWAYS], atol=0.02)


@pytest.mark.parametrize(
    "directions", [[[1.0, 0.0], [0.0, 1.0]], [[2.0, 0.0, 0.0]], [[1.0, 0.0, 0.0], [0.8, 0.6, 0.0]]]
)
def test_directions_that_are_none(directions):
    with pytest.raises(UserError, match="unit vectors in space at right angles"):
        Expectation(CHAIN, np.array(directions), 0.1)


def test_a_stick_of_one_axis_cannot_be_turned():
    with pytest.raises(UserError, match="two axes"):
        Expectation(CHAIN, SIDEWAYS[None], 0.1).turned_and_mirrored(1.0)
