import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.evaluation.approach import SolverConfig, candidates
from latentarm.evaluation.controllability import reach_goals
from latentarm.evaluation.samples import StartGoalPairs

CONFIG = SolverConfig(time_s=6.0)


def some_pairs(count, dof, reach=0.5, seed=0):
    rng = np.random.default_rng(seed)
    start = rng.normal(size=(count, dof))
    return StartGoalPairs(start=start, goal=start + rng.uniform(-reach, reach, size=(count, dof)))


def test_a_full_rank_decoder_reaches_every_goal(linear_decoder, gantry):
    decoder = linear_decoder(np.array([[0.2, 0.1], [-0.1, 0.3]]))
    reach = reach_goals([decoder], some_pairs(50, 2), gantry, 0.1, CONFIG)
    assert reach.tool_error_m.shape == (1, 50)
    np.testing.assert_allclose(reach.tool_error_m, 0.0, atol=1e-6)
    np.testing.assert_allclose(reach.state_error_rad, 0.0, atol=1e-6)


def test_what_lies_across_the_decoders_plane_stays(linear_decoder, gantry):
    pairs = some_pairs(50, 3)
    reach = reach_goals([linear_decoder(np.eye(3)[:, :2])], pairs, gantry, 0.1, CONFIG)
    np.testing.assert_allclose(reach.tool_error_m[0], np.abs((pairs.goal - pairs.start)[:, 2]), atol=1e-6)


def test_a_decoder_that_never_moves_stays_at_the_start(linear_decoder, gantry):
    pairs = some_pairs(20, 2)
    reach = reach_goals([linear_decoder(np.zeros((2, 2)))], pairs, gantry, 0.1, CONFIG)
    np.testing.assert_allclose(reach.tool_error_m[0], reach.start_distance_m)
    np.testing.assert_allclose(reach.start_distance_m, np.linalg.norm(pairs.goal - pairs.start, axis=-1))


def test_input_stays_within_its_range(linear_decoder, gantry):
    pairs = StartGoalPairs(start=np.zeros((1, 1)), goal=np.full((1, 1), 5.0))
    reach = reach_goals([linear_decoder(np.array([[0.5]]))], pairs, gantry, 0.1, SolverConfig(time_s=4.0))
    assert reach.tool_error_m[0, 0] == pytest.approx(5.0 - 0.5 * 4.0)


def test_seeds_and_pairs_do_not_mix(linear_decoder, gantry):
    decoders = [linear_decoder(np.array([[0.2], [0.1]])), linear_decoder(np.array([[0.0], [0.3]]))]
    pairs = some_pairs(12, 2)
    together = reach_goals(decoders, pairs, gantry, 0.1, CONFIG).tool_error_m
    for seed, decoder in enumerate(decoders):
        for pair in range(0, 12, 5):
            one = StartGoalPairs(start=pairs.start[pair : pair + 1], goal=pairs.goal[pair : pair + 1])
            alone = reach_goals([decoder], one, gantry, 0.1, CONFIG).tool_error_m
            assert alone[0, 0] == pytest.approx(together[seed, pair], abs=1e-9)


def test_a_bent_decoder_is_solved_nearly_as_well_as_a_fine_grid_solves_it(formula_decoder, gantry):
    def bent(z, context):
        first, second = z[..., 0], z[..., 1]
        return 0.3 * np.stack([np.sin(2.0 * first) + second**2, second - 0.5 * first**2], axis=-1)

    pairs = some_pairs(100, 2, reach=0.06)
    reach = reach_goals([formula_decoder(2, bent)], pairs, gantry, 0.1, SolverConfig(time_s=0.1))
    axis = np.linspace(-1.0, 1.0, 201)
    z = np.stack(np.meshgrid(axis, axis), -1).reshape(1, -1, 2)
    after = pairs.start[:, None] + 0.1 * bent(z, None)
    exhaustive = np.linalg.norm(after - pairs.goal[:, None], axis=-1).min(axis=1)
    excess = reach.tool_error_m[0] - np.minimum(exhaustive, reach.start_distance_m)
    assert excess.mean() < 0.025 * reach.start_distance_m.mean()


@settings(max_examples=25)
@given(seed=st.integers(0, 10_000), dim=st.integers(1, 4))
def test_the_arm_never_ends_farther_than_it_began(seed, dim, linear_decoder, gantry):
    matrix = np.random.default_rng(seed).normal(size=(4, dim))
    reach = reach_goals(
        [linear_decoder(matrix)], some_pairs(5, 4, seed=seed), gantry, 0.1, SolverConfig(time_s=1.0)
    )
    assert np.all(reach.tool_error_m <= reach.start_distance_m)


@settings(max_examples=25)
@given(seed=st.integers(0, 10_000), dim=st.integers(1, 2))
def test_flipped_axes_change_nothing(seed, dim, linear_decoder, gantry):
    """Of up to two axes; with more, the few choices that the solver starts from may lead elsewhere."""
    matrix = np.random.default_rng(seed).normal(size=(4, dim))
    pairs, config = some_pairs(5, 4, seed=seed), SolverConfig(time_s=1.0)
    plain = reach_goals([linear_decoder(matrix)], pairs, gantry, 0.1, config)
    flipped = reach_goals([linear_decoder(-matrix)], pairs, gantry, 0.1, config)
    np.testing.assert_allclose(plain.tool_error_m, flipped.tool_error_m, atol=1e-4)


def test_many_axes_do_not_explode_the_candidates():
    assert len(candidates(2, 5)) == 25
    assert len(candidates(7, 5)) == 15
