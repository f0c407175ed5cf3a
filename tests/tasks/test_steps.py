"""Steps of a task with things: they tick off in order, are tried again, and end with a failure."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.tasks.mishap import Mishap
from latentarm.tasks.steps import FINE_M, PATIENCE_S, RETRY_S, ROUGH_M, Progress, TaskStep, Waypoint
from scene_states import at, standing

TURN_30 = np.array(
    [[np.cos(np.pi / 6), -np.sin(np.pi / 6), 0], [np.sin(np.pi / 6), np.cos(np.pi / 6), 0], [0, 0, 1]]
)


def point(x, **changes):
    return Waypoint(lambda state: at(x=x), **changes)


def done_when_gripped(name, *waypoints):
    """A step that is done where the state's gripped things name it."""
    return TaskStep("holding", name, name, lambda state: name in state.gripped, waypoints or (point(0.0),))


def now(time_s=0.0, x=99.0, *gripped, **changes):
    return standing(time_s, at(x=x), gripped=frozenset(gripped), **changes)


def test_a_waypoint_is_reached_near_it_and_turned_nearly_alike():
    waypoint = point(0.0, within_m=0.02, within_rad=np.deg2rad(15.0))
    assert waypoint.reached(standing(tool=at(x=0.019)))
    assert not waypoint.reached(standing(tool=at(x=0.021)))
    assert not waypoint.reached(standing(tool=at(rotation=TURN_30)))
    assert waypoint.missed_by(standing(tool=at(rotation=TURN_30))) == pytest.approx(2.0)
    assert waypoint.missed_by(standing(tool=at(x=0.06, rotation=TURN_30))) == pytest.approx(3.0)


def test_a_step_counts_only_in_its_turn():
    progress = Progress([done_when_gripped("lid"), done_when_gripped("cup")])
    progress.update(now(0.0, 99.0, "cup"))
    assert (progress.done, progress.step.name) == (0, "lid")
    progress.update(now(0.1, 99.0, "lid"))
    assert (progress.done, progress.share, progress.step.name) == (1, 0.5, "cup")
    progress.update(now(0.2, 99.0, "cup"))
    assert progress.succeeded
    assert progress.step is None
    assert progress.waypoint is None
    assert progress.asks is None


def test_steps_that_are_done_at_once_tick_off_at_once():
    progress = Progress([done_when_gripped("lid"), done_when_gripped("cup"), done_when_gripped("jar")])
    progress.update(now(0.0, 99.0, "lid", "cup"))
    assert progress.done == 2


def test_waypoints_follow_each_other_and_the_person_waits_where_they_are_told_to():
    first, second = point(0.0, wait_s=0.5, gripper="close"), point(1.0)
    progress = Progress([done_when_gripped("cup", first, second)])
    progress.update(now(0.0))
    assert (progress.waypoint, progress.waits, progress.asks) == (first, False, None)
    progress.update(now(1.0, 0.0))
    assert (progress.waypoint, progress.waits, progress.asks) == (first, True, "close")
    progress.update(now(1.4, 99.0))
    assert (progress.waypoint, progress.waits) == (first, True), "a push does not end the wait"
    progress.update(now(1.5, 99.0))
    assert (progress.waypoint, progress.waits, progress.asks) == (second, False, None)


@pytest.mark.parametrize("wait_s", [0.0, 3.0])
def test_a_step_that_is_not_done_after_its_last_waypoint_is_tried_again(wait_s):
    first, last = point(0.0), point(1.0, wait_s=wait_s)
    progress = Progress([done_when_gripped("cup", first, last)])
    progress.update(now(0.0, 0.0))
    progress.update(now(1.0, 1.0))
    patience_s = max(wait_s, RETRY_S)
    progress.update(now(1.0 + 0.9 * patience_s, 1.0))
    assert (progress.waypoint, progress.tries) == (last, 0)
    progress.update(now(1.0 + patience_s, 1.0))
    assert (progress.waits, progress.tries) == (False, 1)
    assert progress.waypoint.pose is first.pose


@pytest.mark.parametrize(("wait_s", "nearest_m"), [(0.0, ROUGH_M), (0.5, FINE_M)])
def test_people_come_closer_with_each_try_of_a_step(wait_s, nearest_m):
    there = point(0.0, wait_s=wait_s)
    progress = Progress([done_when_gripped("cup", there), done_when_gripped("lid", there)])
    progress.update(now(0.0, 0.015))  # near enough at first, and the step is not done from there
    progress.update(now(RETRY_S, 0.015))
    assert (progress.tries, progress.waypoint.within_m) == (1, 0.01)
    progress.update(now(2.0, 0.015))
    assert not progress.waits, "no longer near enough"
    for start_s in (3.0, 5.0, 7.0, 9.0):
        progress.update(now(start_s, 0.0))
        progress.update(now(start_s + RETRY_S, 0.0))
    assert (progress.tries, progress.waypoint.within_m) == (5, nearest_m)
    progress.update(now(20.0, 0.009, "cup"))
    assert progress.waypoint is there
    assert progress.tries == 0


def looking(x, **changes):
    """A waypoint where people look for something on the tines."""
    return point(x, until=lambda state: "food" in state.stabbed, **changes)


def test_people_press_on_until_they_see_what_they_look_for():
    into, lifted = looking(0.0), point(1.0)
    progress = Progress([done_when_gripped("cup", into, lifted)])
    progress.update(now(0.0, 0.0))
    progress.update(now(0.9 * PATIENCE_S, 0.0))
    assert (progress.waypoint, progress.asks) == (into, None)
    progress.update(now(0.9 * PATIENCE_S, 0.0, stabbed=frozenset({"food"})))
    assert progress.waypoint is lifted


def test_people_go_on_from_afar_where_they_see_what_they_look_for():
    lifted = point(1.0)
    progress = Progress([done_when_gripped("cup", looking(0.0), lifted)])
    progress.update(now(0.0, 5.0, stabbed=frozenset({"food"})))
    assert progress.waypoint is lifted


def test_people_begin_again_with_more_care_when_they_do_not_see_it():
    first, into = point(2.0), looking(0.0, within_m=0.008)
    progress = Progress([done_when_gripped("cup", first, into, point(1.0))])
    progress.update(now(0.0, 2.0))
    progress.update(now(1.0, 0.0))
    progress.update(now(1.0 + PATIENCE_S, 0.0))
    assert progress.waypoint.pose is first.pose
    progress.update(now(5.0, 2.0))
    assert progress.waypoint.within_m == 0.004


def test_people_begin_again_when_told_so():
    first, second = point(0.0), point(1.0)
    progress = Progress([done_when_gripped("cup", first, second)])
    progress.update(now(0.0, 0.0))
    assert progress.waypoint is second
    progress.again()
    assert (progress.waypoint.pose is first.pose, progress.tries) == (True, 1)


def test_the_gripper_is_asked_where_nothing_is_waited_for():
    """Fingers that closed beside a spoon are opened before the next try."""
    before, about = point(0.0, gripper="open"), point(1.0, gripper="close", wait_s=1.0)
    progress = Progress([done_when_gripped("cup", before, about)])
    progress.update(now(0.0, 0.0))
    assert progress.asks == "open"
    progress.update(now(0.1, 0.0))
    assert (progress.waypoint, progress.asks) == (about, None)


def test_a_wait_is_over_when_the_step_is_done():
    progress = Progress(
        [done_when_gripped("lid", point(0.0, wait_s=9.0)), done_when_gripped("cup", point(1.0))]
    )
    progress.update(now(0.0, 0.0))
    assert progress.waits
    progress.update(now(0.1, 0.0, "lid"))
    assert (progress.step.name, progress.waits) == ("cup", False)


def test_what_goes_wrong_is_said_and_stays():
    def fallen(state):
        return Mishap("knocked_over", "cup") if state.tool.position[0] > 5.0 else None

    progress = Progress([done_when_gripped("cup")], [lambda state: None, fallen])
    progress.update(now(0.0, 0.0))
    assert progress.failure is None
    progress.update(now(0.1, 9.0))
    progress.update(now(0.2, 0.0, "cup"))
    assert progress.failure == Mishap("knocked_over", "cup")
    assert (progress.done, progress.succeeded) == (1, False)


@given(st.lists(st.tuples(st.sets(st.sampled_from("abc")), st.sampled_from([0.0, 1.0, 99.0])), max_size=30))
def test_steps_are_never_undone_and_success_is_all_of_them_in_order(course):
    names = "abc"
    progress = Progress([done_when_gripped(name, point(0.0), point(1.0)) for name in names])
    expected = 0
    for tick, (gripped, x) in enumerate(course):
        before = progress.done
        progress.update(now(0.5 * tick, x, *gripped))
        while expected < len(names) and names[expected] in gripped:
            expected += 1
        assert before <= progress.done == expected
        assert progress.succeeded == (expected == len(names))
        assert (progress.waypoint is None) == progress.succeeded
