"""Which motions are asked about, and when enough is known."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.alignment.affine import AffineAlignment
from latentarm.alignment.answers import Motions
from latentarm.alignment.contract import identity
from latentarm.alignment.demonstrated import demonstrated_motions, noticeable
from latentarm.alignment.error import lengths
from latentarm.alignment.queries import (
    StoppingRule,
    bootstrap,
    disagreement,
    disagreement_share,
    next_motion,
    novelty,
)
from latentarm.errors import UserError
from latentarm.types import Demonstrations, Episode

MIRROR = AffineAlignment(np.diag([1.0, -1.0]), np.zeros(2))


@pytest.fixture
def axes(slides, columns):
    """Motions that the two axes of the linear decoder make."""
    start = np.zeros((2, 3))
    return Motions(start, start + 0.5 * columns, 0.5)


def test_those_who_are_alike_agree(linear_model, slides, axes):
    apart = disagreement([identity, identity, identity], linear_model.decoder(), slides.chain, axes)
    np.testing.assert_array_equal(apart, 0)


def test_they_disagree_about_the_motion_that_they_read_differently(linear_model, slides, axes, columns):
    apart = disagreement([identity, MIRROR], linear_model.decoder(), slides.chain, axes)
    assert apart[0] == pytest.approx(0, abs=1e-9)
    # Each would go the opposite way at the other's answer: twice the motion, in half of all pairs.
    assert apart[1] == pytest.approx(2 * 0.5 * np.linalg.norm(columns[1]) / np.sqrt(2))
    assert next_motion(apart, asked=[]) == 1
    share = disagreement_share(apart, slides.chain, axes)
    assert share == pytest.approx(np.linalg.norm(apart) / np.linalg.norm(lengths(slides.chain, axes)))


def test_inputs_that_do_the_same_are_no_disagreement(linear_model, slides, axes, columns):
    """Where the second axis moves nothing, what is thought of it does not matter."""
    model = replace(linear_model)
    tensors = dict(linear_model.trained_.tensors)
    tensors["decoder.0.weight"] = tensors["decoder.0.weight"] * np.array([[1.0], [0.0]])
    model.trained_ = replace(linear_model.trained_, tensors=tensors)
    apart = disagreement([identity, MIRROR], model.decoder(), slides.chain, axes)
    np.testing.assert_allclose(apart, 0, atol=1e-9)


def test_nothing_is_asked_twice():
    apart = np.array([0.1, 0.4, 0.3])
    asked: list[int] = []
    for expected in (1, 2, 0):
        asked.append(next_motion(apart, asked))
        assert asked[-1] == expected
    with pytest.raises(UserError, match="All 3 motions"):
        next_motion(apart, asked)


def test_what_is_alike_or_opposite_is_not_new(slides):
    """Slides: poses are states, and the length of a motion is that of its way."""
    start = np.zeros((5, 3))
    start[4] = [0.4, 0.0, 0.0]
    way = np.array([[0.1, 0, 0], [0.1, 0, 0], [-0.1, 0, 0], [0, 0.3, 0], [0.1, 0, 0]])
    motions = Motions(start, start + way, 0.5)
    longest = novelty(slides.chain, motions, [])
    assert next_motion(longest, []) == 3
    np.testing.assert_allclose(longest / longest[0], [1, 1, 1, 3, 1])
    beside = novelty(slides.chain, motions, [0])
    np.testing.assert_allclose(beside[:3], 0, atol=1e-12)
    assert beside[3] > 0
    assert beside[4] > 0
    # The nearest of all that were asked about counts.
    np.testing.assert_allclose(novelty(slides.chain, motions, [0, 3, 4]), 0, atol=1e-12)


def test_motions_from_one_place_are_told_apart_by_their_way(slides):
    start = np.zeros((2, 3))
    motions = Motions(start, np.array([[0.1, 0, 0], [0, 0.1, 0]]), 0.5)
    assert novelty(slides.chain, motions, [0])[1] == pytest.approx(np.sqrt(2))


def test_a_bootstrap_repeats_what_was_answered(answered):
    answers = answered(4, count=6)
    drawn = bootstrap(answers, 20, np.random.default_rng(0))
    pairs = {(tuple(start), tuple(u)) for start, u in zip(answers.motions.start, answers.u, strict=True)}
    for one in drawn:
        assert len(one) == 6
        own = {(tuple(start), tuple(u)) for start, u in zip(one.motions.start, one.u, strict=True)}
        assert own <= pairs
    assert len({one.u.tobytes() for one in drawn}) > 10


@pytest.mark.parametrize(
    ("history", "enough"),
    [
        ([], False),
        ([0.05], True),
        ([0.5, 0.05], True),
        ([0.5, 0.5, 0.5], False),
        ([0.5, 0.5, 0.5, 0.5], True),
        ([0.5, 0.5, 0.5, 0.4], False),
        ([0.5, 0.6, 0.7, 0.8], True),
        ([0.9, 0.8, 0.6, 0.5, 0.4, 0.3], False),
    ],
)
def test_enough_is_known_when_they_agree_or_learn_no_more(history, enough):
    assert StoppingRule(share=0.1, fall=0.05, patience=3).enough(history) == enough


@pytest.mark.parametrize("wrong", [{"share": -0.1}, {"fall": 1.5}, {"patience": 0}, {"share": float("nan")}])
def test_a_rule_that_makes_no_sense_is_refused(wrong):
    with pytest.raises(UserError, match="stopping rule"):
        StoppingRule(**wrong)


def uneven(rng, samples=80):
    """An arm that waits, moves at a constant speed, and waits again, at uneven times."""
    time = np.cumsum(rng.uniform(0.02, 0.08, samples))
    time -= time[0]
    moved = np.clip(time - 0.5, 0, 2.0)
    return Episode(
        moved[:, None] * np.array([0.2, -0.1]), time, extras={"belief": np.stack([time, 1 - time], 1)}
    )


@pytest.fixture
def shown():
    rng = np.random.default_rng(0)
    return Demonstrations(tuple(uneven(rng) for _ in range(3)), 20.0, ("a", "b"))


def test_motions_take_the_time_that_they_say(shown):
    motions = demonstrated_motions(shown, 1000, np.random.default_rng(0), duration_s=0.3)
    assert 20 < len(motions) < 240
    inside = (motions.start[:, 0] > 0) & (motions.end[:, 0] < 0.38)
    assert inside.sum() > 20
    np.testing.assert_allclose(
        (motions.end - motions.start)[inside], np.tile([0.06, -0.03], (inside.sum(), 1)), rtol=0, atol=1e-12
    )
    assert motions.context.shape == (len(motions), 2)


def test_motions_are_drawn_at_random_without_repeats(shown):
    draw = [demonstrated_motions(shown, 20, np.random.default_rng(seed)) for seed in (0, 0, 1)]
    assert len(draw[0]) == 20
    assert len(np.unique(draw[0].start, axis=0)) >= 19
    np.testing.assert_array_equal(draw[0].start, draw[1].start)
    assert not np.array_equal(draw[0].start, draw[2].start)


def test_the_belief_comes_along(shown):
    motions = demonstrated_motions(shown, 20, np.random.default_rng(0), context="state_belief")
    assert motions.context.shape == (20, 4)
    # The belief of these says what time it was.
    np.testing.assert_allclose(
        np.clip(motions.belief[:, 0] - 0.5, 0, 2), motions.start[:, 0] / 0.2, atol=1e-9
    )
    without = replace(shown, episodes=tuple(replace(one, extras={}) for one in shown.episodes))
    with pytest.raises(UserError, match="belief"):
        demonstrated_motions(without, 20, np.random.default_rng(0), context="state_belief")


def test_demonstrations_that_are_too_short_or_still_are_refused(shown):
    with pytest.raises(UserError, match="10 s"):
        demonstrated_motions(shown, 20, np.random.default_rng(0), duration_s=10.0)
    still = replace(shown, episodes=tuple(replace(one, state=0 * one.state) for one in shown.episodes))
    with pytest.raises(UserError, match="no motion"):
        demonstrated_motions(still, 20, np.random.default_rng(0))


def test_small_motions_are_not_noticeable(slides):
    start = np.zeros((5, 3))
    motions = Motions(start, np.array([0.001, 0.049, 0.1, 0.1, 0.2])[:, None] * np.eye(3)[:1], 0.5)
    np.testing.assert_array_equal(noticeable(motions, slides.chain), [False, False, True, True, True])
