"""One decoder, one cell with its curves: what they hold, and that they are the same again."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from latentarm.alignment.answers import Answers
from latentarm.alignment.contract import identity
from latentarm.alignment.queries import order_of_questions
from latentarm_research.studies.alignment.cell import PRIORS_AT_RANDOM, measure_cell
from latentarm_research.studies.alignment.preset import (
    ALL_PRIORS,
    CHOSEN,
    CONDITIONS,
    FEW_ANSWERS,
    IDEAL,
    LEARNED,
    NO_ALIGN,
    SINGLE_PRIORS,
    Curves,
    Preset,
    Stream,
)
from latentarm_research.studies.alignment.scene import AlignmentCell, DecoderCell, learn_decoder, scene_of

TINY = Preset(
    "tiny",
    episodes=3,
    test_episodes=2,
    epochs=1,
    hidden=(8,),
    noises=(0.0, 0.5),
    answers=4,
    ideal_answers=30,
    unlabelled=40,
    test_motions=30,
    runs=2,
    steps=4,
    ideal_steps=6,
    ideal_runs=1,
    surroundings=40,
    curves=Curves(answers=(1, 4), candidates=12),
)


@cache
def learned_at(task):
    """Several tests look at the same decoder."""
    decoder = DecoderCell(task, TINY, 0)
    return AlignmentCell(decoder, learn_decoder(decoder), 0.5)


@cache
def measured_at(task):
    return measure_cell(learned_at(task))


@pytest.fixture(scope="module", params=["plane", "reach_and_pour"])
def learned(request):
    return learned_at(request.param)


@pytest.fixture(scope="module")
def scene(learned):
    return scene_of(learned)


def test_every_condition_has_an_error_for_each_run(learned):
    result = measured_at(learned.task)
    assert list(result.errors) == list(CONDITIONS)
    for name, errors in result.errors.items():
        assert errors.shape == ((1,) if name in (NO_ALIGN, IDEAL) else (TINY.runs,))
        assert np.isfinite(errors).all()
        assert (errors > 0).all()
    assert result.encoded > 0


def test_a_cell_is_the_same_from_the_same_seed():
    learned, result = learned_at("reach_and_pour"), measured_at("reach_and_pour")
    again = measure_cell(learned)
    for name, errors in result.errors.items():
        np.testing.assert_array_equal(errors, again.errors[name])
    for choice, errors in result.curves.items():
        for count, values in errors.items():
            np.testing.assert_array_equal(values, again.curves[choice][count])
    assert again.encoded == result.encoded
    anew = learn_decoder(learned.decoder)
    for name, tensor in learned.model.trained_.tensors.items():
        np.testing.assert_array_equal(tensor, anew.trained_.tensors[name])


def test_another_seed_gives_another_decoder(learned):
    other = learn_decoder(replace(learned.decoder, seed=1))
    assert any(
        not np.array_equal(tensor, other.trained_.tensors[name])
        for name, tensor in learned.model.trained_.tensors.items()
    )


def test_noise_changes_the_answers_and_not_the_questions(learned, scene):
    exact, noisy = (scene.ask(8, noise, Stream.QUESTIONS, Stream.ANSWERS, 0) for noise in (0.0, 0.5))
    np.testing.assert_array_equal(exact.motions.start, noisy.motions.start)
    assert not np.array_equal(exact.u, noisy.u)
    other = scene.ask(8, 0.0, Stream.QUESTIONS, Stream.ANSWERS, 1)
    assert not np.array_equal(exact.motions.start, other.motions.start)
    # Fewer questions are the first of more.
    np.testing.assert_array_equal(
        scene.ask(3, 0.5, Stream.QUESTIONS, Stream.ANSWERS, 0).u, noisy[np.arange(3)].u
    )


def test_alignments_are_judged_on_motions_that_trained_nothing(scene):
    assert len(scene.test) == TINY.test_motions
    shown = {tuple(state) for state in scene.shown.start}
    assert not shown & {tuple(state) for state in scene.test.motions.start}
    np.testing.assert_array_equal(scene.test.u, scene.preference.inputs(scene.test.motions))


def test_z_u_of_a_person_who_means_what_the_decoder_does_is_perfect(scene):
    """The error is that of the paper: 0 where u does just what was meant."""
    motions = scene.test.motions
    u = np.full((len(motions), 2), 0.3)
    end = motions.start + motions.duration_s * scene.decoder.decode(u, motions.context)
    met = replace(scene, test=Answers(replace(motions, end=end), u))
    assert met.errors([identity])[0] == pytest.approx(0, abs=1e-20)


def test_single_priors_weigh_what_they_weigh_among_all():
    assert set(SINGLE_PRIORS) < set(FEW_ANSWERS)
    for weight in ("proportional", "reversible", "consistent"):
        alone = [getattr(priors, weight) for priors in SINGLE_PRIORS.values()]
        assert sum(alone) == getattr(LEARNED[ALL_PRIORS], weight)
        assert sorted(alone)[:2] == [0, 0]


def test_a_curve_has_a_point_for_every_number_and_choice():
    curves = measured_at("reach_and_pour").curves
    assert {choice: list(errors) for choice, errors in curves.items()} == {
        PRIORS_AT_RANDOM: [TINY.answers],
        CHOSEN: [1, 4],
    }
    assert all(values.shape == (TINY.runs,) for errors in curves.values() for values in errors.values())


def test_four_chosen_questions_hold_both_parts_of_reach_and_pour():
    """Where two things are meant in two places, each is asked about more than once."""
    scene = scene_of(learned_at("reach_and_pour"))
    asked = order_of_questions(scene.chain, scene.shown, 4)
    there = scene.preference.is_there(scene.chain.forward(scene.shown.start[asked]).position)
    assert there.sum() == 2
