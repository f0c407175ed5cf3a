"""Where the demonstrated tools go. A step ``s + a dt`` leaves a path by at most its own second order."""

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm_research.tasks.planar.circle import RADII_M, Circle
from latentarm_research.tasks.planar.paths import STEP_S
from latentarm_research.tasks.planar.reach import ReachRegion
from latentarm_research.tasks.planar.resolved_rate import plane_point
from latentarm_research.tasks.planar.rotate import BOX_WIDTH_M, Rotate
from latentarm_research.tasks.planar.sine import Sine


def states_and_next(motion, episodes=8):
    """Demonstrated states, the states one step on, and how far these may be off, m or rad."""
    for episode in motion.demonstrate(episodes, np.random.default_rng(3)).episodes:
        step = episode.action * STEP_S
        # |d2x/ds2 (step, step)| <= (sum |step|)^2 for an arm of 1 m, halved by Taylor; twice for two steps.
        slack = np.square(np.abs(step).sum(axis=-1)).max() + 1e-9
        yield episode.state, episode.state + step, slack


def test_sine_stays_on_the_wave_and_goes_both_ways_along_it():
    motion = Sine()
    middle = motion.curve(np.zeros(1))[0]
    for state, following, slack in states_and_next(motion):
        for place in (plane_point(motion.robot, state), plane_point(motion.robot, following)):
            np.testing.assert_allclose(
                place[:, 1], motion.curve(place[:, 0] - middle[0])[:, 1], atol=2 * slack
            )
        along = np.sign((plane_point(motion.robot, following) - plane_point(motion.robot, state))[:, 0])
        assert (along > 0).any()
        assert (along < 0).any()


def test_circle_stays_between_the_smallest_and_the_largest():
    motion = Circle()
    radii = []
    for state, following, slack in states_and_next(motion):
        for reached in (state, following):
            radius = np.linalg.norm(plane_point(motion.robot, reached) - motion.centre, axis=-1)
            assert radius.min() > RADII_M[0] - slack
            assert radius.max() < RADII_M[1] + slack
            radii.append(radius)
    assert np.ptp(np.concatenate(radii)) > 0.5 * np.ptp(RADII_M)


def test_circle_moves_along_circles_or_between_them_never_both():
    motion = Circle()
    for state, following, slack in states_and_next(motion):
        place = plane_point(motion.robot, state) - motion.centre
        outward = place / np.linalg.norm(place, axis=-1, keepdims=True)
        move = plane_point(motion.robot, following) - plane_point(motion.robot, state)
        between = np.abs(np.sum(move * outward, axis=-1))
        along = np.abs(move[:, 0] * outward[:, 1] - move[:, 1] * outward[:, 0])
        assert np.minimum(between, along).max() < 3 * slack


def grip(robot, state, tool):
    return robot.chain.forward(state, tool).position[..., :2]


def test_rotate_keeps_both_grippers_on_a_box_whose_middle_rests():
    motion = Rotate()
    for state, following, slack in states_and_next(motion):
        for reached in (state, following):
            left, right = (grip(motion.robot, reached, tool) for tool in (0, 1))
            np.testing.assert_allclose(np.linalg.norm(left - right, axis=-1), BOX_WIDTH_M, atol=2 * slack)
            assert np.ptp((left + right) / 2, axis=0).max() < 4 * slack
            headings = motion.constraint.coordinates(reached)[:, [2, 5]]
            np.testing.assert_allclose(headings[:, 0], headings[:, 1], atol=1e-6)
            # The grippers' heading is the box's.
            side = left - right
            turn = np.arctan2(-side[:, 0], side[:, 1])
            np.testing.assert_allclose(headings[:, 0], turn, atol=4 * slack / BOX_WIDTH_M)


def test_rotate_puts_the_box_elsewhere_every_time():
    motion = Rotate()
    middles = [
        np.mean([grip(motion.robot, state[0], tool) for tool in (0, 1)], axis=0)
        for state, *_ in states_and_next(motion)
    ]
    assert np.ptp(middles, axis=0).min() > 0.01


def test_reach_goes_straight_from_the_start_side_into_the_region():
    motion = ReachRegion()
    outline = motion.region
    low, high = outline.min(axis=0), outline.max(axis=0)
    for state, following, slack in states_and_next(motion):
        place = plane_point(motion.robot, state)
        way = place[-1] - place[0]
        off = (place - place[0]) @ np.array([-way[1], way[0]]) / np.linalg.norm(way)
        assert np.abs(off).max() < 2 * slack
        speed = np.linalg.norm(plane_point(motion.robot, following) - place, axis=-1) / STEP_S
        assert np.ptp(speed) < 2 * slack / STEP_S
        # The last sample is taken a hundredth of the way before the end.
        end = place[0] + way * len(place) / (len(place) - 1)
        assert (end > low - 2 * slack).all()
        assert (end < high + 2 * slack).all()


def test_reach_samples_goals_in_its_region_and_starts_apart_from_it():
    motion, rng = ReachRegion(), np.random.default_rng(0)
    outline = motion.region
    goals, starts = motion.sample_goals(200, rng), motion.sample_starts(200, rng)
    assert goals.shape == starts.shape == (200, 2)
    assert (goals >= outline.min(axis=0)).all()
    assert (goals <= outline.max(axis=0)).all()
    assert starts[:, 0].max() < outline.min(axis=0)[0]
    assert np.ptp(goals, axis=0) == pytest.approx(np.ptp(outline, axis=0), rel=0.1)


def test_reach_goes_about_as_fast_every_time():
    motion = ReachRegion()
    first = motion.demonstrate(30, np.random.default_rng(0)).episodes
    speeds = [
        np.linalg.norm(np.diff(plane_point(motion.robot, episode.state), axis=0), axis=-1).mean()
        for episode in first
    ]
    assert np.std(speeds) < 0.2 * np.mean(speeds)


@pytest.mark.parametrize("motion", [Sine(), Rotate()])
def test_joint_speed_tells_neither_place_nor_posture(motion):
    """A normal speed for each stroke: as fast at every place, forth as often as back."""
    episodes = motion.demonstrate(60, np.random.default_rng(4)).episodes
    speed = np.concatenate([np.linalg.norm(episode.action, axis=-1) for episode in episodes])
    place = np.concatenate([episode.state for episode in episodes])
    assert np.abs(np.corrcoef(speed, place.T)[0, 1:]).max() < 0.2
    # |v| of a normal v: its mean over its root mean square is sqrt(2 / pi).
    assert speed.mean() / np.sqrt(np.mean(speed**2)) == pytest.approx(np.sqrt(2 / np.pi), rel=0.08)


def test_a_design_that_no_posture_passes_is_refused(monkeypatch):
    monkeypatch.setattr(Circle, "least_conditioning", 10.0)
    with pytest.raises(UserError, match="Too few postures of circle"):
        Circle().demonstrate(1, np.random.default_rng(0))
