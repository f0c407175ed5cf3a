"""Which motions are asked about, and when enough is known."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.alignment.answers import Motions
from latentarm.alignment.demonstrated import demonstrated_motions, noticeable
from latentarm.alignment.queries import QuestionDesign, StoppingRule, next_motion
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode


def test_what_was_asked_or_its_opposite_teaches_little_and_another_direction_much(slides):
    """Slides: poses are states."""
    way = np.array([[0.1, 0, 0], [0.1, 0, 0], [-0.1, 0, 0], [0, 0.09, 0]])
    design = QuestionDesign(slides.chain, Motions(np.zeros((4, 3)), way, 0.5))
    first = design.worth([])
    np.testing.assert_allclose(first[:3], first[0])
    assert next_motion(first, []) == 0  # it tells of three motions
    after = design.worth([0])
    assert after[:3].max() < 0.05 * after[3]
    assert next_motion(after, [0]) == 3
    assert design.worth([0, 3]).max() < 0.05 * first[0]


def test_the_same_direction_in_another_place_teaches_more_than_in_the_same(slides):
    start = np.array([[0.0, 0, 0], [0.01, 0, 0], [0.8, 0, 0]])
    worth = QuestionDesign(slides.chain, Motions(start, start + np.array([0, 0.1, 0]), 0.5)).worth([0])
    assert worth[2] > 1.5 * worth[1]


def test_nothing_is_asked_twice():
    apart = np.array([0.1, 0.4, 0.3])
    asked: list[int] = []
    for expected in (1, 2, 0):
        asked.append(next_motion(apart, asked))
        assert asked[-1] == expected
    with pytest.raises(UserError, match="All 3 motions"):
        next_motion(apart, asked)


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
    np.testing.assert_allclose(np.clip(motions.rest[:, 0] - 0.5, 0, 2), motions.start[:, 0] / 0.2, atol=1e-9)
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
