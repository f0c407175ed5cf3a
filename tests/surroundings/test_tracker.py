"""What is believed of where things are, whatever sources say."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from latentarm.core.types import Pose
from latentarm.surroundings.contract import Sighting
from latentarm.surroundings.tracker import JUMP_M, Tracker

HOLD_S = 2.0
EVERY_S = 0.25
SD_M = 0.005
HERE, THERE = np.array([0.5, 0.1, 0.3]), np.array([0.6, -0.1, 0.3])
STILL = Pose(np.array([0.4, 0.0, 0.5]), np.eye(3))

directions = st.builds(
    lambda x, y: np.array([np.cos(x) * np.cos(y), np.sin(x) * np.cos(y), np.sin(y)]),
    st.floats(-3.1, 3.1),
    st.floats(-1.5, 1.5),
)


def seen(name, place, time_s, sd_m=SD_M):
    return Sighting(name, Pose(np.asarray(place), np.eye(3)), time_s, sd_m, 0.1)


def watch(tracker, places, begin_s, end_s):
    """Show things at these places (by name, None for unseen), four times a second; yield every moment."""
    for moment in np.arange(begin_s, end_s, EVERY_S):
        now_s = float(moment)
        for name, place in places.items():
            if place is not None:
                tracker.saw(seen(name, place, now_s), "camera", HOLD_S, now_s)
        tracker.update(STILL, now_s)
        yield now_s


def found(*names, **places):
    tracker = Tracker(names or places)
    for _ in watch(tracker, places, 0.0, 1.0):
        pass
    return tracker


@given(st.lists(st.tuples(*[st.floats(-1.5, 1.5)] * 3), min_size=5, max_size=20))
def test_noise_of_a_source_neither_moves_a_thing_far_nor_makes_it_jump(noise):
    tracker = Tracker(["cup"])
    for index, off in enumerate(noise):
        now_s = index * EVERY_S
        tracker.saw(seen("cup", HERE + SD_M * np.array(off), now_s), "camera", HOLD_S, now_s)
        tracker.update(STILL, now_s)
        assert not tracker.jumped
    here = tracker.look("cup", now_s)
    assert here.known
    assert np.linalg.norm(here.pose.position - HERE) < 3.0 * SD_M


@given(directions, st.floats(0.1, 0.5), st.floats(0.1, 1.2))
def test_a_jump_that_ends_soon_is_not_believed(direction, far_m, lasts_s):
    tracker = found(cup=HERE)
    for begin_s, end_s, place in (
        (1.0, 1.0 + lasts_s, HERE + far_m * direction),
        (1.0 + lasts_s, 4.0, HERE),
    ):
        for now_s in watch(tracker, {"cup": place}, begin_s, end_s):
            here = tracker.look("cup", now_s)
            assert here.known
            assert np.linalg.norm(here.pose.position - HERE) < 0.01
    assert here.seen == "seen"


@given(directions, st.floats(0.1, 0.5))
def test_a_thing_that_was_moved_is_followed_once_confirmed_and_said_to_jump(direction, far_m):
    tracker, place = found(cup=HERE), HERE + far_m * direction
    jumps = [now_s for now_s in watch(tracker, {"cup": place}, 1.0, 4.0) if tracker.jumped]
    assert len(jumps) == 1
    assert 2.5 <= jumps[0] <= 3.0
    assert np.linalg.norm(tracker.look("cup", 4.0).pose.position - place) < 0.01


def test_of_sources_that_contradict_each_other_the_first_stays():
    tracker = found(cup=HERE)
    for moment in np.arange(1.0, 11.0, EVERY_S).tolist():
        tracker.saw(seen("cup", HERE, moment), "camera", HOLD_S, moment)
        tracker.saw(seen("cup", THERE, moment), "detector", HOLD_S, moment)
        here = tracker.look("cup", moment)
        assert np.linalg.norm(here.pose.position - HERE) < 0.02
    assert here.seen == "doubted"


@given(st.floats(0.002, 0.02), st.floats(0.002, 0.02))
def test_of_sources_that_agree_the_surer_counts_more(camera_sd_m, detector_sd_m):
    tracker, off = Tracker(["cup"]), np.array([0.004, 0.0, 0.0])
    for moment in np.arange(0.0, 1.5, EVERY_S).tolist():
        tracker.saw(seen("cup", HERE, moment, camera_sd_m), "camera", HOLD_S, moment)
        tracker.saw(seen("cup", HERE + off, moment, detector_sd_m), "detector", HOLD_S, moment)
    share = (tracker.look("cup", 1.5).pose.position - HERE)[0] / off[0]
    # The later of two sightings of one moment is no better: the shares are those of their variances.
    assert (share > 0.5) == (detector_sd_m < camera_sd_m) or abs(camera_sd_m - detector_sd_m) < 0.002


@given(st.floats(0.03, 0.4), st.floats(0.1, 4.0))
def test_two_things_that_seem_to_change_places_are_not_followed_while_they_count(apart_m, lasts_s):
    left, right = HERE, HERE + np.array([0.0, apart_m, 0.0])
    tracker = found(cup=left, bowl=right)
    for now_s in watch(tracker, {"cup": right, "bowl": left}, 1.0, 1.0 + lasts_s):
        for name, own, other in (("cup", left, right), ("bowl", right, left)):
            here = tracker.look(name, now_s)
            nearer = np.linalg.norm(here.pose.position - own) < np.linalg.norm(here.pose.position - other)
            # Followed only after it was lost, which ends learned motions.
            assert nearer or now_s > 0.75 + HOLD_S


def test_things_that_did_change_places_are_found_once_they_were_lost():
    tracker = found(cup=HERE, bowl=THERE)
    states = [tracker.look("cup", now).seen for now in watch(tracker, {"cup": THERE, "bowl": HERE}, 1.0, 6.0)]
    assert "lost" in states
    assert states[-1] == "seen"
    assert np.linalg.norm(tracker.look("cup", 6.0).pose.position - THERE) < 0.01
    assert np.linalg.norm(tracker.look("bowl", 6.0).pose.position - HERE) < 0.01


@given(st.lists(st.tuples(st.floats(0.01, 3.0), st.sampled_from(["cup", "bowl"])), max_size=30))
def test_nothing_older_than_it_holds_reaches_a_model(sightings):
    tracker, newest_s, now_s = found(cup=HERE, bowl=THERE), {"cup": 0.75, "bowl": 0.75}, 1.0
    for later_s, name in sightings:
        now_s += later_s
        fresh = all(now_s - one <= HOLD_S for one in newest_s.values())
        rows = tracker.rows(["cup", "bowl"], now_s)
        assert not len(rows) or fresh
        was_known = tracker.look(name, now_s).known
        tracker.saw(seen(name, HERE if name == "cup" else THERE, now_s), "camera", HOLD_S, now_s)
        if was_known:
            newest_s[name] = now_s


@given(
    st.lists(
        st.tuples(st.sampled_from(["cup", "bowl"]), st.floats(-0.4, 0.4), st.floats(-0.4, 0.4)),
        min_size=10,
        max_size=40,
    )
)
def test_a_pose_that_changes_much_at_once_is_said_to_jump(sightings):
    tracker, before = Tracker(["cup", "bowl"]), {}
    for index, (name, x, y) in enumerate(sightings):
        now_s = index * EVERY_S
        # Half of the sightings are of one place, so that things are found and lost again.
        place = HERE if index % 2 else HERE + np.array([x, y, 0.0])
        tracker.saw(seen(name, place, now_s), "camera", HOLD_S, now_s)
        tracker.update(STILL, now_s)
        for one in tracker.names:
            here = tracker.look(one, now_s)
            if here.known and one in before and one not in tracker.jumped:
                assert np.linalg.norm(here.pose.position - before[one]) <= JUMP_M
            if here.known:
                before[one] = here.pose.position


@given(
    st.lists(st.tuples(*[st.floats(-0.3, 0.3)] * 3, *[st.floats(-2.0, 2.0)] * 3), min_size=1, max_size=20),
    st.booleans(),
)
def test_a_thing_in_the_gripper_moves_with_the_tool_whatever_is_seen(motions, elsewhere):
    tracker = found(cup=HERE)
    tracker.carry("cup", sensed=True)
    at = np.linalg.norm(HERE - STILL.position)
    for index, (x, y, z, a, b, c) in enumerate(motions):
        now_s = 1.0 + index * EVERY_S
        tool = Pose(STILL.position + np.array([x, y, z]), Rotation.from_rotvec([a, b, c]).as_matrix())
        place = THERE if elsewhere else HERE
        tracker.saw(seen("cup", place, now_s), "camera", HOLD_S, now_s)
        tracker.update(tool, now_s)
        here = tracker.look("cup", now_s)
        assert here.seen == "carried"
        inside = (here.pose.position - tool.position) @ tool.rotation
        np.testing.assert_allclose(inside, HERE - STILL.position, atol=1e-3)
        assert np.linalg.norm(here.pose.position - tool.position) == pytest.approx(at, abs=1e-3)
    tracker.let_go("cup", now_s)
    let_go = tracker.look("cup", now_s)
    assert let_go.seen == "seen"
    np.testing.assert_allclose(let_go.pose.position, here.pose.position, atol=1e-9)


def test_food_on_a_fork_is_let_go_of_once_it_is_seen_to_stay_behind():
    tracker = found(food=HERE)
    tracker.carry("food", sensed=False)
    tool = Pose(STILL.position + np.array([0.0, 0.0, 0.2]), np.eye(3))
    for index in range(30):
        now_s = 1.0 + index * EVERY_S
        tracker.update(tool, now_s)
        tracker.saw(seen("food", HERE, now_s), "camera", HOLD_S, now_s)
    here = tracker.look("food", now_s)
    assert here.seen == "seen"
    assert np.linalg.norm(here.pose.position - HERE) < 0.01


def test_a_person_is_believed_at_once_and_may_take_it_back():
    tracker = found(cup=HERE)
    tracker.place(seen("cup", THERE, 1.0), "touch", 600.0)
    tracker.update(STILL, 1.0)
    assert tracker.jumped == {"cup"}
    np.testing.assert_allclose(tracker.look("cup", 500.0).pose.position, THERE)
    assert tracker.take_back("cup")
    np.testing.assert_allclose(tracker.look("cup", 1.0).pose.position, HERE, atol=1e-6)
    assert not tracker.take_back("cup")


@pytest.mark.parametrize("time_s", [-3.0, 9.0])
def test_a_sighting_from_long_ago_or_from_the_future_says_nothing(time_s):
    tracker = Tracker(["cup"])
    for index in range(10):
        tracker.saw(seen("cup", HERE, time_s + 0.2 * index), "camera", HOLD_S, 2.0)
    assert tracker.look("cup", 2.0).seen == "unseen"
