"""What a person means, learned in the space of the tools, and the decoder inverted for it."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.demonstrated_directions import DemonstratedDirections
from latentarm.alignment.error import relative_alignment_error
from latentarm.alignment.meaning import Meaning, rotations
from latentarm.alignment.posterior import fit_meaning
from latentarm.alignment.tool_space import ToolSpace
from latentarm.core.errors import UserError

FAST = 0.3
"""What a full push moves the slides by, m/s."""


@pytest.fixture(scope="module")
def motions(circles):
    """Half a second along the circles: all in one plane."""
    start = np.concatenate([one.state[:-10:3] for one in circles.episodes])
    end = np.concatenate([one.state[10::3] for one in circles.episodes])
    return Motions(start, end, 0.5)


@pytest.fixture(scope="module")
def plane(columns):
    """The two directions (2, 3) of the circles' plane."""
    return np.linalg.qr(columns.T)[0].T


@pytest.fixture(scope="module")
def surroundings(motions, slides):
    return DemonstratedDirections.of_motions(motions, slides.chain, 2)


def said(motions, plane, turn, noise=0.0, seed=0):
    """Answers of a person whose stick is turned by an angle (N,) at each motion."""
    velocity = (motions.end - motions.start) / motions.duration_s
    u = (rotations(np.broadcast_to(turn, len(motions))) @ (velocity @ plane.T / FAST)[..., None])[..., 0]
    factor = 1 + noise * np.random.default_rng(seed).normal(size=u.shape)
    return Answers(motions, np.clip(u * factor, -1, 1))


def learned(answers, slides, surroundings, motions, decoder):
    posterior = fit_meaning(answers, slides.chain, surroundings, motions)
    return posterior, ToolSpace(posterior.meaning, surroundings, 0.5).with_arm(decoder, slides.chain)


def test_two_answers_are_enough_for_axes_that_are_turned(linear_model, slides, motions, plane, surroundings):
    answers = said(motions, plane, 2.0)
    two = answers[np.array([0, 5])]
    posterior, alignment = learned(two, slides, surroundings, motions, linear_model.decoder())
    assert relative_alignment_error(alignment, linear_model.decoder(), slides.chain, answers) < 2e-3
    assert posterior.setting.turn_rad == 0
    one, _ = learned(answers[np.array([0])], slides, surroundings, motions, linear_model.decoder())
    assert posterior.share < 0.4 * one.share


def test_ten_answers_are_enough_for_axes_that_turn_with_the_place(
    linear_model, slides, motions, plane, surroundings
):
    answers = said(motions, plane, 4.0 * motions.start @ plane[0])
    some = answers[np.random.default_rng(0).permutation(len(motions))[:10]]
    posterior, alignment = learned(some, slides, surroundings, motions, linear_model.decoder())
    assert posterior.setting.turn_rad > 0
    assert relative_alignment_error(alignment, linear_model.decoder(), slides.chain, answers) < 0.03


def test_the_noise_of_the_answers_is_found_and_averaged(linear_model, slides, motions, plane, surroundings):
    answers = said(motions, plane, 2.0)
    errors, found = [], []
    for seed in range(4):
        rows = np.random.default_rng(seed).permutation(len(motions))[:10]
        noisy = said(motions, plane, 2.0, noise=0.5, seed=seed)[rows]
        posterior, alignment = learned(noisy, slides, surroundings, motions, linear_model.decoder())
        errors.append(relative_alignment_error(alignment, linear_model.decoder(), slides.chain, answers))
        found.append(posterior.setting.variation)
    assert np.mean(errors) < 0.06
    assert min(found) >= 0.3


def test_a_person_whose_axes_are_uneven_is_understood(linear_model, slides, motions, plane, surroundings):
    """One axis twice as fast as the other, at an angle of 60 degrees: exact answers outweigh the prior."""
    skewed = np.array([[1.0, 0.0], [0.25, 0.43]]) @ plane
    answers = said(motions, skewed, 0.0)
    rows = np.random.default_rng(0).permutation(len(motions))[:10]
    _, alignment = learned(answers[rows], slides, surroundings, motions, linear_model.decoder())
    assert relative_alignment_error(alignment, linear_model.decoder(), slides.chain, answers) < 0.02


@pytest.fixture(scope="module")
def known(surroundings, plane):
    matrix = np.concatenate([plane / FAST, np.zeros((2, 3))], axis=1)
    return ToolSpace(Meaning(matrix, np.zeros((1, 12)), np.zeros(1), 1.0), surroundings, 0.5)


def test_what_is_meant_is_proportional_reversible_and_still_at_rest(
    linear_model, slides, motions, known, plane
):
    """By construction, where the decoder can do it; only the weight of z, the ridge, is in the way."""
    decoder = linear_model.decoder()
    alignment = known.with_arm(decoder, slides.chain)
    u = np.random.default_rng(0).uniform(-1, 1, (len(motions), 2))

    def moves(u):
        return decoder.decode(alignment(u, motions.context), motions.context) @ plane.T / FAST

    np.testing.assert_allclose(moves(u), u, atol=0.03)
    np.testing.assert_allclose(moves(0.5 * u), 0.5 * moves(u), atol=0.01)
    np.testing.assert_allclose(moves(-u), -moves(u), atol=0.01)
    np.testing.assert_allclose(moves(0 * u), 0, atol=0.01)


def test_one_input_is_what_it_is_among_many_and_axes_broadcast(linear_model, slides, motions, known):
    alignment = known.with_arm(linear_model.decoder(), slides.chain)
    u = np.random.default_rng(0).uniform(-1, 1, (3, 5, 2))
    context = motions.context[:5]
    z = alignment(u, context)
    assert z.shape == (3, 5, 2)
    np.testing.assert_allclose(alignment(u[1, 2], context[2]), z[1, 2], rtol=0, atol=1e-9)
    np.testing.assert_allclose(alignment(u[:, 2], context[2]), z[:, 2], rtol=0, atol=1e-9)


def test_z_is_bounded_however_much_is_meant(linear_model, slides, motions, known):
    """A profile is not trusted: a meaning out of all proportion asks for no more than so much."""
    for factor in (1e-9, 1e6):
        meaning = replace(known.meaning, matrix=factor * known.meaning.matrix)
        alignment = replace(known, meaning=meaning).with_arm(linear_model.decoder(), slides.chain)
        assert np.abs(alignment(np.ones(2), motions.context[0])).max() < 4


def test_a_small_change_of_place_or_input_changes_z_a_little(curved_model, arm, answered):
    many = answered(4, count=60, seed=1).motions
    surroundings = DemonstratedDirections.of_motions(many, arm.chain, 2)
    matrix = np.random.default_rng(0).normal(size=(2, 6))
    known = ToolSpace(Meaning(matrix, np.zeros((1, 12)), np.zeros(1), 1.0), surroundings, 0.5)
    alignment = known.with_arm(curved_model.decoder(), arm.chain)
    share = np.linspace(0, 1, 2001)[:, None]
    context = (1 - share) * many.start[0] + share * many.start[1]
    u = (1 - share) * np.array([1.0, -0.5]) + share * np.array([-0.3, 1.0])
    z = alignment(u, context)
    assert np.abs(np.diff(z, axis=0)).max() < 0.05


class Folded:
    """A decoder that near rest goes the other way than farther out, along both directions of a plane."""

    latent_dim, action_dim = 2, 3

    def __init__(self, plane):
        self._plane = plane

    def decode(self, z, context):
        return FAST * (z - 3.0 * z * np.exp(-((z / 0.2) ** 2))) @ self._plane


def test_a_decoder_that_is_folded_near_rest_still_does_what_is_meant(slides, motions, known, plane):
    decoder = Folded(plane)
    alignment = known.with_arm(decoder, slides.chain)
    u = np.random.default_rng(0).uniform(0.4, 0.9, (60, 2)) * np.random.default_rng(1).choice(
        [-1, 1], (60, 2)
    )
    moved = decoder.decode(alignment(u, motions.context[:60]), motions.context[:60]) @ plane.T / FAST
    assert np.square(moved - u).sum(axis=1).max() < 0.15


def test_another_number_of_inputs_is_refused(linear_model, slides, known):
    meaning = replace(known.meaning, matrix=known.meaning.matrix[:1])
    with pytest.raises(UserError, match="align the person again"):
        replace(known, meaning=meaning).with_arm(linear_model.decoder(), slides.chain)


def test_what_was_not_demonstrated_is_outside(surroundings, plane):
    """The circles' plane is inside everywhere; across it, and turning, are not."""
    outside = surroundings(surroundings.place)
    across = np.linalg.svd(plane)[2][2]
    np.testing.assert_allclose(
        outside @ np.pad(across, (0, 3)), np.tile(np.pad(across, (0, 3)), (len(outside), 1)), atol=1e-9
    )
    inside = np.linalg.norm(outside @ np.pad(plane, ((0, 0), (0, 3))).T, axis=1)
    assert inside.max() < 1e-6
