"""The measures on decoders whose figures are known: formulas of the tasks, and one that never moves."""

from dataclasses import dataclass

import numpy as np
import pytest

from latentarm.core.types import FloatArray
from latentarm_research.studies.properties.measures import (
    RESOLUTION_M,
    control_figures,
    latent_figures,
    reach_figures,
    recorded_pairs,
    start_goal_pairs,
)
from latentarm_research.studies.properties.preset import Preset
from latentarm_research.tasks.planar.circle import Circle
from latentarm_research.tasks.planar.reach import ReachRegion
from latentarm_research.tasks.planar.rotate import Rotate
from latentarm_research.tasks.planar.sine import Sine

TURN_RAD_S = 0.5


class Still:
    """Moves nothing, whatever is asked."""

    latent_dim = 1

    def decode(self, z: FloatArray, context: FloatArray) -> FloatArray:
        return np.zeros((*np.broadcast_shapes(z.shape[:-1], context.shape[:-1]), context.shape[-1]))


@dataclass
class InPlane:
    """Moves one arm's tool along x and y by z, in m/s over ``speed``, the joints by the least."""

    robot: object
    directions: FloatArray
    speed: float = 0.2

    @property
    def latent_dim(self) -> int:
        return self.directions.shape[0]

    def decode(self, z: FloatArray, context: FloatArray) -> FloatArray:
        jacobian = self.robot.chain.jacobian(context)[..., :2, :]
        return np.einsum("...nk,...k->...n", np.linalg.pinv(jacobian), self.speed * z @ self.directions)


@dataclass
class TurnBox:
    """Turns the box of Rotate about its middle, both grippers with it."""

    robot: object
    latent_dim: int = 1

    def decode(self, z: FloatArray, context: FloatArray) -> FloatArray:
        chain = self.robot.chain
        jacobian = np.concatenate([chain.jacobian(context, arm)[..., (0, 1, 5), :] for arm in (0, 1)], -2)
        left, right = (chain.forward(context, arm).position[..., :2] for arm in (0, 1))
        away = (left - right) / 2
        across = np.stack([-away[..., 1], away[..., 0]], axis=-1)
        one = np.ones_like(away[..., :1])
        twist = np.concatenate([across, one, -across, one], axis=-1)
        rate = np.einsum("...nk,...k->...n", np.linalg.pinv(jacobian), twist)
        return TURN_RAD_S * z * rate


class Encoder:
    """Says what z was: half a push each time."""

    def __init__(self, decoder):
        self._decoder = decoder

    def encode(self, context, action):
        return np.full((1, len(context), self._decoder.latent_dim), 0.5)

    def decoder(self, seed=0):
        return self._decoder


def shown(motion, episodes=5, seed=0):
    return motion.demonstrate(episodes, np.random.default_rng(seed))


def rng():
    return np.random.default_rng(2)


def test_states_to_go_between_are_demonstrated_ones_and_repeatable():
    motion = Sine()
    demonstrations = shown(motion)
    states = {tuple(state) for episode in demonstrations.episodes for state in episode.state}
    goals = start_goal_pairs(motion, demonstrations, 50, rng())
    assert goals.start.shape == goals.goal.shape == (50, 5)
    assert {tuple(state) for state in np.concatenate([goals.start, goals.goal])} <= states
    np.testing.assert_array_equal(goals.start, start_goal_pairs(motion, demonstrations, 50, rng()).start)


def test_rotate_goes_between_states_with_the_same_box():
    motion = Rotate()
    goals = start_goal_pairs(motion, shown(motion), 40, rng())

    def middle(state):
        return sum(motion.robot.chain.forward(state, arm).position for arm in (0, 1)) / 2

    np.testing.assert_allclose(middle(goals.start), middle(goals.goal), atol=1e-3)


def test_turning_the_box_reaches_every_goal_and_standing_still_stays_as_far_as_it_was():
    motion = Rotate()
    goals = start_goal_pairs(motion, shown(motion), 30, rng())
    turning, still = TurnBox(motion.robot), Still()
    figures = control_figures(motion, [turning, still], still, goals)
    assert figures["controllability_m"][0] < 0.05 * figures["start_distance_m"][0]
    np.testing.assert_allclose(figures["controllability_m"][1], figures["start_distance_m"][0])
    np.testing.assert_allclose(figures["controllability_percent_of_pca"][1], 100.0)


def test_a_ratio_to_a_pca_that_reaches_everything_is_no_figure():
    motion = Circle()
    everywhere = InPlane(motion.robot, np.eye(2))
    figures = control_figures(
        motion, [everywhere], everywhere, start_goal_pairs(motion, shown(motion), 20, rng())
    )
    assert figures["controllability_m"][0] < RESOLUTION_M
    assert np.isnan(figures["controllability_percent_of_pca"]).all()


def test_rotates_r2_is_of_the_grippers_turning():
    motion, preset = Rotate(), Preset("", states=9)
    pairs = recorded_pairs(shown(motion), rng())
    decoder = TurnBox(motion.robot)
    figures = latent_figures(motion, Encoder(decoder), [decoder], pairs, preset)
    assert figures["r2"][0] == pytest.approx(1.0, abs=1e-4)
    assert figures["drift"][0] == 0.0
    assert "disentanglement_deg" not in figures


def test_axes_at_right_angles_are_told_from_skew_ones():
    motion, preset = Circle(), Preset("")
    pairs = recorded_pairs(shown(motion), rng())
    for directions, angle in ((np.eye(2), 90.0), (np.array([[1.0, 0.0], [1.0, 1.0]]), 45.0)):
        decoder = InPlane(motion.robot, directions)
        figures = latent_figures(motion, Encoder(decoder), [decoder], pairs, preset)
        assert figures["disentanglement_deg"][0] == pytest.approx(angle, abs=0.5)


def test_a_tool_that_goes_anywhere_reaches_every_goal_by_no_less_than_the_straight_way():
    motion = ReachRegion()
    figures = reach_figures(motion, [InPlane(motion.robot, np.eye(2))], 10, rng())
    assert figures["final_distance"][0] < RESOLUTION_M
    # The box of inputs is fastest along its diagonals, so the way there need not be straight.
    assert 1.0 <= figures["path_over_straight"][0] < np.sqrt(2)
    assert figures["path_length"][0] > figures["start_distance_m"][0] - RESOLUTION_M


def test_an_arm_that_does_not_move_has_no_way_and_so_no_crookedness():
    figures = reach_figures(ReachRegion(), [Still()], 10, rng())
    assert figures["path_length"][0] == 0.0
    assert np.isnan(figures["path_over_straight"][0])
    np.testing.assert_allclose(figures["final_distance"], figures["start_distance_m"])
