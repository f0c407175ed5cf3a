"""Position by the stick, orientation learned."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.core.errors import UserError
from latentarm.core.types import Context, Demonstrations, Episode
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.rotations import angle_between, rotation_vector
from latentarm_research.baselines.learned_orientation import LearnedOrientationController, OrientationMap
from latentarm_research.studies.tasks.orientation import learned

PANDA = load_robot("panda")
HERE = PANDA.chain.forward(PANDA.home)
WANTED = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]) @ np.array(
    [[np.cos(0.5), 0.0, np.sin(0.5)], [0.0, 1.0, 0.0], [-np.sin(0.5), 0.0, np.cos(0.5)]]
)
ALWAYS = OrientationMap((), False, ((np.zeros((3, 6)), WANTED[:, :2].ravel()),))
CONTROLLER = LearnedOrientationController(PANDA, ALWAYS)
push = st.tuples(st.floats(-1, 1), st.floats(-1, 1)).map(np.array)


def at(state, objects=None):
    return Context(state, np.zeros(0), objects=np.zeros((0, 9)) if objects is None else objects)


def twist(u, mode, state=PANDA.home):
    return PANDA.chain.jacobian(state) @ CONTROLLER.action(u, at(state), mode)


@given(u=push, mode=st.integers(0, 1))
def test_the_position_follows_the_stick_as_in_mode_switching_and_rest_is_rest(u, mode):
    switched = PANDA.chain.jacobian(PANDA.home) @ EndEffectorController(PANDA).action(
        u if mode == 0 else u * [1.0, 0.0], at(PANDA.home), mode
    )
    assert twist(u, mode)[:3] == pytest.approx(switched[:3], abs=1e-9)
    assert not CONTROLLER.action(0.0 * u, at(PANDA.home), mode).any()
    assert twist(0.5 * u, mode) == pytest.approx(0.5 * twist(u, mode), abs=1e-9)


def test_it_turns_to_the_learned_orientation_with_the_push_either_way_and_not_too_fast():
    turns = [twist(np.array(u), 0)[3:] for u in ([1.0, 0.0], [-1.0, 0.0], [0.0, 0.3])]
    way = rotation_vector(WANTED @ HERE.rotation.mT)
    for turn, size in zip(turns, (0.5, 0.5, 0.15), strict=True):
        assert turn == pytest.approx(size * way / np.linalg.norm(way), abs=1e-9)
    assert not twist(np.array([0.0, 1.0]), 1).round(9).any(), "the mode z has one axis"


def test_the_orientation_is_reached_while_the_person_moves_to_and_fro():
    state, before = PANDA.home, angle_between(HERE.rotation, WANTED)
    for tick in range(200):
        u = np.array([1.0 if tick % 20 < 10 else -1.0, 0.0])
        state = state + 0.02 * CONTROLLER.action(u, at(state), 0)
    after = PANDA.chain.forward(state)
    assert before > 0.4
    assert angle_between(after.rotation, WANTED) < 0.01
    assert after.position == pytest.approx(HERE.position, abs=0.04)


def test_a_batch_of_inputs_and_states_is_steered_as_each_alone():
    rng = np.random.default_rng(0)
    states, u = PANDA.home + rng.normal(size=(3, 1, 7)) * 0.1, rng.uniform(-1, 1, (3, 4, 2))
    action = CONTROLLER.action(u, at(states), 1)
    assert action.shape == (3, 4, 7)
    assert action[2, 1] == pytest.approx(CONTROLLER.action(u[2, 1], at(states[2, 0]), 1), abs=1e-12)


def shown():
    """The tool sweeps to the side, and its last joint is turned as the cup is near or far."""
    episodes = []
    for cup_m, turned in ((0.3, 0.4), (0.5, -0.4)):
        state = np.tile(PANDA.home, (60, 1))
        state[:, 0] += np.linspace(-0.4, 0.4, 60)
        state[:, 6] += turned
        pose = np.tile([cup_m, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (60, 1))
        episodes.append(Episode(state, np.arange(60) / 20, extras={ENVIRONMENT: pose}))
    return Demonstrations(tuple(episodes), 20.0, PANDA.joint_names, objects=("cup",))


def test_it_learns_what_was_shown_where_the_things_are():
    demonstrations = shown()
    how = {"hidden_layer_sizes": (32,), "max_iter": 150, "learning_rate_init": 0.01, "random_state": 0}
    found = learned(demonstrations, PANDA.chain, how, np.random.default_rng(0))
    assert (found.objects, found.sees_gripper) == (("cup",), False)
    for cup_m, episode in zip((0.3, 0.5), demonstrations.episodes, strict=True):
        pose = PANDA.chain.forward(episode.state)
        cup = np.array([[cup_m, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]])
        assert angle_between(found(pose.position, at(episode.state, cup)), pose.rotation).max() < 0.2
    with pytest.raises(UserError, match="the things cup, and others are here"):
        found(pose.position, at(episode.state))
