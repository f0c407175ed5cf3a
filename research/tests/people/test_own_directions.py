"""Own directions turn the stick as a person would push it before anything is aligned to them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.alignment.answers import Motions
from latentarm.alignment.preference import ToolAxes
from latentarm.core.errors import UserError
from latentarm.core.types import Context
from latentarm.robots.catalogue import load_robot
from latentarm_research.people.contract import LoopLimits, Moment
from latentarm_research.people.linear_guess import LinearGuess, LinearGuessConfig
from latentarm_research.people.own_directions import InOwnDirections, OwnDirections, OwnSpeed
from latentarm_research.people.population import draw_people

PANDA = load_robot("panda")
USUAL = np.zeros((6, 2))
USUAL[0, 0] = USUAL[2, 1] = 0.1
DIRECTIONS = st.builds(OwnDirections, st.floats(-math.pi, math.pi), st.booleans())
UNITS = st.floats(-1.0, 1.0)


@settings(max_examples=30)
@given(DIRECTIONS, UNITS, UNITS)
def test_a_push_in_own_directions_is_expected_to_do_what_the_usual_push_does(directions, x, y):
    u = np.array([x, y])
    own = directions.matrix @ u
    np.testing.assert_allclose(directions.expected(USUAL) @ own, USUAL @ u, atol=1e-12)
    assert np.linalg.norm(own) == pytest.approx(np.linalg.norm(u))


def test_a_quarter_turn_pushes_up_where_others_push_right():
    np.testing.assert_allclose(OwnDirections(math.pi / 2).matrix @ [1.0, 0.0], [0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(OwnDirections(mirrored=True).matrix @ [0.3, 0.5], [0.3, -0.5])


@settings(max_examples=10)
@given(st.floats(-0.7, 0.7), st.booleans())
def test_answers_are_turned_like_pushes(turn_rad, mirrored):
    rng = np.random.default_rng(0)
    start = PANDA.home + rng.normal(size=(5, PANDA.dof)) * 0.1
    motions = Motions(start, start + 0.02 * rng.normal(size=start.shape), 1.0)
    usual = ToolAxes(PANDA.chain, 2, 0.5)
    directions = OwnDirections(turn_rad, mirrored)
    answered = InOwnDirections(usual, directions).inputs(motions)
    np.testing.assert_allclose(answered, usual.inputs(motions) @ directions.matrix.T)


def test_a_newcomer_first_expects_their_own_directions_and_then_what_they_see():
    traits = draw_people(1, 2)[0]
    config = traits.newcomer(USUAL, 0).imagines
    sure = LinearGuessConfig(speed_m_s=1e-6, turn_rad_s=1e-6, expected=config.expected)
    guess = LinearGuess(PANDA.chain, sure, 0.1)
    context = Context(PANDA.home, np.zeros(0))
    pushes = np.array([[1.0, 0.0], [0.0, 1.0]])
    reached = guess.foresight(np.random.default_rng(0))(pushes, context, None, [0], 0.5)
    moved = reached.position[0] - PANDA.chain.forward(PANDA.home).position
    np.testing.assert_allclose(moved, 0.5 * (pushes @ traits.directions.expected(USUAL).T)[:, :3], atol=1e-4)


def test_without_expectation_a_guess_is_as_it_was():
    context = Context(PANDA.home, np.zeros(0))
    guesses = []
    for expected in (None, ((0.0,) * 6,) * 2):
        guess = LinearGuess(PANDA.chain, LinearGuessConfig(expected=expected), 0.1)
        rng = np.random.default_rng(1)
        for u in (np.array([1.0, 0.0]), np.array([0.2, 0.5])) * 3:
            guess.saw(Moment(context, 0, PANDA.chain.forward(PANDA.home), u))
        guesses.append(guess.foresight(rng)(np.eye(2), context, None, [0], 0.5).position)
    np.testing.assert_array_equal(*guesses)


@settings(max_examples=30)
@given(st.floats(0.05, 1.0), st.floats(0.0, 0.5), UNITS, UNITS)
def test_own_speed_shortens_a_push_and_leaves_it_a_push(share, dead_zone, x, y):
    limits = LoopLimits(dead_zone)
    u = np.array([x, y]) / math.sqrt(2.0)
    pushed = OwnSpeed(share).pushed(u, limits)
    assert np.linalg.norm(pushed) <= np.linalg.norm(u) + 1e-12
    np.testing.assert_allclose(pushed[0] * u[1], pushed[1] * u[0], atol=1e-12)
    if np.linalg.norm(u) > dead_zone + 1e-9:
        assert limits.is_push(pushed)


def test_a_stick_of_three_axes_has_no_own_directions():
    with pytest.raises(UserError, match="two axes"):
        OwnDirections().expected(np.zeros((6, 3)))
