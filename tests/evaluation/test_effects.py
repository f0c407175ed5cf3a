import numpy as np
import pytest

from latentarm.evaluation.consistency import consistency
from latentarm.evaluation.effects import axis_grid, axis_turns
from latentarm.robots.planar import planar

GRID = axis_grid(5)


@pytest.fixture(scope="module")
def two_arms():
    return planar(2, arms=2).chain


def test_a_planar_gripper_turns_by_the_sum_of_its_joints(linear_decoder, two_arms):
    matrix = np.array([[0.1], [0.2], [-0.3], [0.1]])
    context = np.random.default_rng(0).normal(size=(3, 4))
    turns = axis_turns([linear_decoder(matrix)], context, GRID, two_arms, 0.5, tools=(0, 1))
    assert turns.shape == (1, 1, 6, 5, 3)
    np.testing.assert_allclose(turns[0, 0, :3, :, 2], np.tile(0.5 * 0.3 * GRID, (3, 1)), atol=1e-12)
    np.testing.assert_allclose(turns[0, 0, 3:, :, 2], np.tile(0.5 * -0.2 * GRID, (3, 1)), atol=1e-12)
    np.testing.assert_allclose(turns[..., :2], 0.0, atol=1e-12)


def test_grippers_that_turn_together_are_consistent_and_against_each_other_are_not(linear_decoder, two_arms):
    context = np.random.default_rng(0).normal(size=(4, 4))
    decoders = [
        linear_decoder(np.array([[0.1], [0.1], [0.1], [0.1]])),
        linear_decoder(np.array([[0.1], [0.1], [-0.1], [-0.1]])),
    ]
    turns = axis_turns(decoders, context, GRID, two_arms, 0.1, tools=(0, 1))
    np.testing.assert_allclose(consistency(turns, GRID)[:, 0], [1.0, 0.0], atol=1e-9)
