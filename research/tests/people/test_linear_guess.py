"""A simulated person who learns while driving what the stick does."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from latentarm.core.types import Context, Pose
from latentarm.robots.catalogue import load_robot
from latentarm_research.people.contract import Moment
from latentarm_research.people.linear_guess import LinearGuess, LinearGuessConfig, Regression
from latentarm_research.people.person import Person, SimulatedPerson

PANDA = load_robot("panda")
CHAIN = PANDA.chain
PERIOD_S = 0.05
TWIST = np.array([[0.08, 0.0, -0.05, 0.0, 0.2, 0.0], [0.0, 0.1, 0.0, 0.1, 0.0, 0.0]])
"""(2, 6), what each axis of the stick does to the tool, m/s and rad/s."""


def moved(state, u, duration_s):
    """The state after the tool's twist has lasted for a while."""
    return state + duration_s * (u @ TWIST) @ np.linalg.pinv(CHAIN.jacobian(state)).T


def taught(inputs, config=None, flips=None):
    """Someone who saw each input (2,) for a glance; from index ``flips`` on, the stick is reversed."""
    guess = LinearGuess(CHAIN, config or LinearGuessConfig(), PERIOD_S)
    state, nowhere = PANDA.home, Pose(np.zeros(3), np.eye(3))
    guess.saw(Moment(Context(state, np.zeros(0)), 0, nowhere, np.zeros(2)))
    for number, u in enumerate(np.asarray(inputs)):
        for _ in range(4):
            sign = -1.0 if flips is not None and number >= flips else 1.0
            state = moved(state, sign * u, PERIOD_S)
            guess.saw(Moment(Context(state, np.zeros(0)), 0, nowhere, u))
    return guess, state


def expected(guess, state, seed=0):
    """(2, 6), the twist that they expect of each axis, by where they expect the tool in 0.1 s."""
    foresee = guess.foresight(np.random.default_rng(seed))
    reached = foresee(np.eye(2), Context(state, np.zeros(0)), None, (0,), 0.1)
    now = CHAIN.forward(state)
    turn = Rotation.from_matrix(reached.rotation[0] @ now.rotation.T).as_rotvec()
    return np.concatenate([reached.position[0] - now.position, turn], axis=1) / 0.1


PUSHES = np.random.default_rng(1).uniform(-1, 1, (40, 2))


def test_who_saw_both_axes_expects_what_they_do():
    guess, state = taught(PUSHES, LinearGuessConfig(noise=0.02, memory_m=10.0))
    np.testing.assert_allclose(expected(guess, state), TWIST, atol=0.01)


def test_at_first_they_try_all_sorts_of_things_and_later_they_agree_with_themselves():
    novice = [expected(*taught(PUSHES[:0]), seed)[:, :3] for seed in range(20)]
    expert = [expected(*taught(PUSHES), seed)[:, :3] for seed in range(20)]
    assert np.std(novice, axis=0) == pytest.approx(0.1, rel=0.6)
    assert np.std(expert, axis=0).max() < 0.5 * np.std(novice, axis=0).min()


def test_what_the_stick_did_elsewhere_is_forgotten():
    guess, state = taught(np.concatenate([PUSHES, PUSHES]), LinearGuessConfig(noise=0.05), flips=40)
    np.testing.assert_allclose(expected(guess, state), -TWIST, atol=0.06)


def test_a_motion_without_a_push_teaches_nothing():
    guess, state = taught(np.zeros((5, 2)))
    np.testing.assert_array_equal(expected(guess, state), expected(*taught(PUSHES[:0])))


def test_regression_by_hand():
    one = Regression(np.zeros((2, 2)), np.zeros((6, 2)))
    u, y = np.array([1.0, 0.0]), np.arange(6.0)
    one.learn(u, y, noise=0.5, kept=1.0)
    one.learn(u, y, noise=0.5, kept=0.5)
    # Precision 4 * 0.5 + 4 = 6 beyond the prior's 1: the mean is 6/7 of what was seen, and its SD 1/sqrt(7).
    draws = np.stack([one.drawn(np.random.default_rng(seed)) for seed in range(4000)])
    np.testing.assert_allclose(draws.mean(axis=0)[:, 0], 6 / 7 * y, atol=0.03)
    np.testing.assert_allclose(draws.std(axis=0), np.tile([7**-0.5, 1.0], (6, 1)), rtol=0.06)


def test_they_reach_a_target_with_a_stick_that_they_did_not_know(wrist):
    class Stick(type(wrist)):
        def action(self, z, context, mode):
            return (z @ TWIST) @ np.linalg.pinv(CHAIN.jacobian(context.state)).T

    stick = Stick([np.zeros((2, 7))])
    target = CHAIN.forward(moved(moved(PANDA.home, np.array([1.0, 0.5]), 0.8), np.array([0.5, 1.0]), 0.8))
    person = SimulatedPerson(PANDA, Person(imagines=LinearGuessConfig()), PERIOD_S)
    rng, state = np.random.default_rng(0), PANDA.home
    apart = [np.linalg.norm(CHAIN.forward(state).position - target.position)]
    for _ in range(160):
        u = person.act(Context(state, np.zeros(0)), stick, 0, target, rng).u
        state = moved(state, u, PERIOD_S)
        apart.append(np.linalg.norm(CHAIN.forward(state).position - target.position))
    assert min(apart) < 0.15 * apart[0]
