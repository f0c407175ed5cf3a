"""The search encoder against closed forms, dense grids and every model's own encoder."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from latentarm.evaluation.search import nearest_latents

JOINTS = 5


def square_error(decoder, z, context, action):
    return np.square(decoder.decode(z, context) - action).sum(axis=-1)


@given(seed=st.integers(0, 2**32 - 1), dim=st.integers(1, 4), offset=st.booleans())
def test_an_affine_decoder_gets_the_exact_solution_within_the_range(seed, dim, offset, linear_decoder):
    rng = np.random.default_rng(seed)
    matrix, rest = rng.normal(size=(JOINTS, dim)), rng.normal(size=JOINTS) * offset
    action = rng.normal(size=(6, JOINTS)) * 10.0 ** rng.uniform(-2, 1, (6, 1))
    found = nearest_latents([linear_decoder(matrix, rest)], np.zeros((6, JOINTS)), action)[0]
    for z, wanted in zip(found, action, strict=True):
        exact = lsq_linear(matrix, wanted - rest, (-1.0, 1.0), method="bvls", tol=1e-14)
        # Axes may be nearly parallel: then many inputs are as good, and the error is what is unique.
        least = np.square(matrix @ exact.x + rest - wanted).sum()
        assert np.square(matrix @ z + rest - wanted).sum() <= least * (1 + 1e-8) + 1e-14
        assert np.abs(z).max() <= 1.0


def test_a_linear_decoder_that_changes_with_the_state_gets_it_too(turning_decoder):
    context = np.linspace(-3.0, 3.0, 40)[:, None] * np.ones(2)
    action = np.random.default_rng(0).normal(size=(40, 2))
    decoder = turning_decoder(2.0)
    found = nearest_latents([decoder], context, action)[0]
    inside = (np.abs(found) < 1.0).all(axis=-1)
    assert inside.any()
    np.testing.assert_allclose(decoder.decode(found, context)[inside], action[inside], atol=1e-8)


def curled(sharpness):
    """A decoder with many valleys: its plane is rolled up as often as ``sharpness`` says."""

    def formula(z, context):
        turn = sharpness * z[..., 0] + context[..., 0]
        plane = np.broadcast_to(0.3 * z, (*turn.shape, 2))
        return np.stack([np.cos(turn) - 1.0, np.sin(turn), plane[..., 0], plane[..., 1]], axis=-1)

    return formula


def spiral(z, context):
    """A homogeneous decoder whose direction turns seven times as fast as the stick."""
    radius = np.linalg.norm(z, axis=-1, keepdims=True)
    angle = np.arctan2(z[..., 1:], z[..., :1]) + 0.1 * context[..., :1]
    waves = [np.cos(angle), np.sin(angle), 0.7 * np.cos(7 * angle), 0.7 * np.sin(7 * angle)]
    return radius * np.concatenate(waves, axis=-1)


@pytest.mark.parametrize("formula", [curled(3.0), curled(9.0), spiral], ids=["curled", "rolled up", "spiral"])
def test_no_point_of_a_dense_grid_is_nearer(formula, formula_decoder):
    rng = np.random.default_rng(1)
    context, decoder = rng.uniform(-3, 3, (60, 2)), formula_decoder(2, formula)
    values = np.linspace(-1.0, 1.0, 161)
    grid = np.stack(np.meshgrid(values, values), axis=-1).reshape(-1, 2)
    # Slow actions too: the inputs that they need lie near rest.
    action = rng.normal(size=(60, 4)) * 10.0 ** rng.uniform(-2.0, 0.3, (60, 1))
    found = nearest_latents([decoder], context, action)[0]
    assert np.abs(found).max() <= 1.0
    least = square_error(decoder, grid, context[:, None], action[:, None]).min(axis=1)
    error = square_error(decoder, found, context, action)
    assert error.sum() <= 1.001 * least.sum()
    assert np.mean(error > 1.01 * least + 1e-9) <= 0.02


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
def test_what_was_decoded_is_found_again(dim, formula_decoder):
    rng = np.random.default_rng(dim)
    first, second = rng.normal(size=(dim, 12)), rng.normal(size=(12, 6))
    decoder = formula_decoder(dim, lambda z, context: np.tanh(z @ first + context[..., :1]) @ second)
    z, context = rng.uniform(-1, 1, (50, dim)), rng.normal(size=(50, 3))
    action = decoder.decode(z, context)
    found = nearest_latents([decoder], context, action)[0]
    assert square_error(decoder, found, context, action).max() < 1e-6 * np.square(action).sum(axis=-1).mean()


def test_it_is_never_worse_than_codes_brought_into_the_range(formula_decoder):
    rng = np.random.default_rng(2)
    needle = formula_decoder(2, lambda z, context: np.exp(-1e4 * np.square(z - context[..., :2])))
    context = rng.uniform(-0.9, 0.9, (30, 2))  # each has a peak too narrow for any grid
    codes = np.where(rng.random((30, 1)) < 0.5, context, 5.0)
    action = np.ones((30, 2))
    found = nearest_latents([needle, needle], context, action, np.stack([codes, 0.0 * codes]))
    given_error = square_error(needle, np.clip(codes, -1, 1), context, action)
    assert (square_error(needle, found[0], context, action) <= given_error).all()
    assert (given_error < 1e-12).sum() > 5
    assert found.shape == (2, 30, 2)


def test_a_decoder_that_overflows_or_does_nothing_has_inputs_within_the_range(
    formula_decoder, linear_decoder
):
    action = np.random.default_rng(3).normal(size=(4, 2))
    explodes = formula_decoder(2, lambda z, context: np.exp(1e3 * z) - 1.0)
    dead = linear_decoder(np.zeros((2, 2)))
    one_axis = linear_decoder(np.array([[1.0, 0.0], [1.0, 0.0]]))
    found = nearest_latents([explodes, dead, one_axis], np.zeros((4, 2)), action)
    assert np.isfinite(found).all()
    assert np.abs(found).max() <= 1.0
    np.testing.assert_allclose(found[2, :, 0], np.clip(action.mean(axis=1), -1, 1), atol=1e-8)


def test_a_row_has_the_same_input_alone_and_among_others(formula_decoder):
    rng = np.random.default_rng(4)
    context, action = rng.uniform(-3, 3, (70, 2)), rng.normal(size=(70, 4))
    decoder = formula_decoder(2, curled(5.0))
    together = nearest_latents([decoder], context, action)[0]
    alone = nearest_latents([decoder], context[33:34], action[33:34])[0]
    np.testing.assert_allclose(alone, together[33:34], atol=1e-9)
