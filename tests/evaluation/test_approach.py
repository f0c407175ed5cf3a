import numpy as np
import pytest

from latentarm.evaluation.approach import SolverConfig, Target, approach, tool_places
from latentarm.robots.planar import planar


def places(*points):
    """Targets of one tool, one per drive."""
    return Target(np.array(points, dtype=float)[:, None])


def test_a_straight_drive_is_as_long_as_it_is_straight_and_ends_when_nearest(linear_decoder, gantry):
    start = np.zeros((2, 2))
    target = places([0.3, 0.1, 0.0], [0.0, 0.2, 0.0])
    came = approach([linear_decoder(np.array([[0.1], [0.0]]))], start, target, gantry, 0.1, SolverConfig())
    np.testing.assert_allclose(came.distance_m, [[0.1, 0.2]])
    np.testing.assert_allclose(came.path_m, [[0.3, 0.0]], atol=1e-9)
    np.testing.assert_allclose(came.straight_m, came.path_m)
    np.testing.assert_allclose(came.context, [[[0.3, 0.0], [0.0, 0.0]]], atol=1e-9)


def test_a_bent_drive_is_longer_than_straight(formula_decoder, gantry):
    def around(z, context):
        """Along circles about the origin, one radian a second."""
        return z[..., :1] * np.stack([-context[..., 1], context[..., 0]], axis=-1)

    came = approach(
        [formula_decoder(1, around)],
        np.array([[1.0, 0.0]]),
        places([0.0, 1.0, 0.0]),
        gantry,
        1e-3,
        SolverConfig(time_s=2.0, hold=10),
    )
    assert came.path_m[0, 0] == pytest.approx(np.pi / 2, rel=1e-2)
    assert came.straight_m[0, 0] == pytest.approx(np.sqrt(2), rel=1e-2)


def test_the_distance_of_several_tools_is_their_mean(linear_decoder):
    chain = planar(2, arms=2).chain
    start = np.array([[0.3, 0.4, -0.2, 0.5]])
    goal = start + np.array([[0.1, 0.0, 0.0, 0.0]])
    target = Target(tool_places(chain, goal, (0, 1)), goal)
    only_right = linear_decoder(np.array([[0.0], [0.0], [0.1], [0.1]]))
    came = approach([only_right], start, target, chain, 0.1, SolverConfig(), tools=(0, 1))
    left_alone = np.linalg.norm(target.places[0, 0] - chain.forward(start[0]).position)
    assert came.distance_m[0, 0] == pytest.approx(left_alone / 2)


def test_a_choice_that_is_held_moves_the_arm_in_the_same_small_steps(formula_decoder, gantry):
    def wavering(z, context):
        return z[..., :1] * np.cos(5.0 * context)

    decoder, start, target = formula_decoder(1, wavering), np.zeros((1, 1)), places([0.2, 0.0, 0.0])
    often = approach([decoder], start, target, gantry, 0.01, SolverConfig(hold=1))
    seldom = approach([decoder], start, target, gantry, 0.01, SolverConfig(hold=5))
    for came in (often, seldom):
        np.testing.assert_allclose(came.distance_m, 0.0, atol=1e-6)


def test_drives_that_stall_end_without_a_change_to_what_they_reached(linear_decoder, gantry):
    rng = np.random.default_rng(0)
    start, target = rng.normal(size=(30, 3)), Target(rng.normal(size=(30, 1, 3)))
    counted = []

    def drive(stall_s):
        decoder = linear_decoder(np.eye(3)[:, :2])
        asked = []

        class Counting:
            latent_dim = 2

            def decode(self, z, context):
                asked.append(z.size)
                return decoder.decode(z, context)

        came = approach([Counting()], start, target, gantry, 0.1, SolverConfig(time_s=20.0, stall_s=stall_s))
        counted.append(sum(asked))
        return came

    patient, hasty = drive(np.inf), drive(0.5)
    np.testing.assert_allclose(hasty.distance_m, patient.distance_m, atol=1e-6)
    assert counted[1] < counted[0] / 3
