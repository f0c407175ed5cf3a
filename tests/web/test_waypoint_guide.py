"""What is left of the way, as a person is told it: it leads through a step at their own pace."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import Pose
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.steps import TaskStep, Waypoint
from latentarm.web.arm_process.waypoint_guide import WaypointGuide

NONE = frozenset()
THERE = np.array([0.3, 0.1, 0.2])


def state_at(place, rotation=None, time_s=0.0, gripped=NONE) -> SceneState:
    tool = Pose(np.array(place), np.eye(3) if rotation is None else rotation)
    return SceneState(time_s, tool, {}, {}, NONE, gripped, NONE, {}, {})


def step_of(*waypoints: Waypoint) -> TaskStep:
    return TaskStep("holding", "cup", "the cup", lambda state: False, waypoints)


def test_what_is_left_would_bring_the_tool_there():
    rng = np.random.default_rng(3)
    aim = Pose(THERE, Rotation.random(random_state=1).as_matrix())
    tool = Pose(rng.uniform(-0.5, 0.5, 3), Rotation.random(random_state=2).as_matrix())
    left = WaypointGuide().look(step_of(Waypoint(lambda state: aim)), state_at(tool.position, tool.rotation))
    assert np.allclose(tool.position + left.shift_m, aim.position, atol=1e-4)
    # Turns are about the tool's own axes, as straight lines have them.
    turned = tool.rotation @ Rotation.from_rotvec(left.turn_rad).as_matrix()
    assert np.allclose(turned, aim.rotation, atol=2e-3)


def test_the_gripper_is_asked_for_until_it_has_closed_however_long_that_takes():
    about = Waypoint(lambda state: Pose(THERE, np.eye(3)), gripper="close", wait_s=1.0)
    up = Waypoint(lambda state: Pose(THERE + np.array([0.0, 0.0, 0.1]), np.eye(3)))
    guide, step = WaypointGuide(), step_of(about, up)
    assert guide.look(step, state_at([0.0, 0.0, 0.0])).gripper is None
    for time_s in (1.0, 5.0, 60.0):
        assert guide.look(step, state_at(THERE, time_s=time_s)).gripper == "close"
    held = state_at(THERE, time_s=61.0, gripped=frozenset({"cup"}))
    left = guide.look(step, held)
    assert (left.gripper, left.shift_m) == (None, (0.0, 0.0, 0.1))


def test_a_gripper_that_has_missed_is_asked_to_open_before_the_step_begins_again():
    away = Waypoint(lambda state: Pose(THERE + np.array([0.0, 0.0, 0.1]), np.eye(3)), gripper="open")
    about = Waypoint(lambda state: Pose(THERE, np.eye(3)), gripper="close", wait_s=1.0)
    guide, step = WaypointGuide(), step_of(away, about)
    guide.look(step, state_at(THERE + np.array([0.0, 0.0, 0.1])))
    asked = [
        guide.look(step, state_at(THERE, time_s=time_s), 0.03 if time_s > 2.0 else None)
        for time_s in (1.0, 2.0, 2.1, 4.0, 5.2)
    ]
    # While it closes it is asked to; later it has closed on nothing.
    assert [left.gripper for left in asked] == ["close"] * 4 + ["open"]
    assert asked[-1].shift_m == (0.0, 0.0, 0.1)
    again = guide.look(step, state_at(THERE, time_s=6.0))
    assert (again.gripper, again.shift_m) == (None, (0.0, 0.0, 0.1))


def test_a_gripper_that_is_shut_on_the_way_to_a_thing_is_asked_to_open():
    about = Waypoint(lambda state: Pose(THERE, np.eye(3)), gripper="close")
    guide, step = WaypointGuide(), step_of(about)
    on_the_way = [guide.look(step, state_at([0.0, 0.0, 0.0], time_s=t), 0.03) for t in (0.0, 2.0, 3.5)]
    assert [left.gripper for left in on_the_way] == [None, None, "open"]
    held = state_at([0.0, 0.0, 0.0], time_s=4.0, gripped=frozenset({"spoon"}))
    assert guide.look(step, held, 0.03).gripper is None


def test_a_gripper_that_has_closed_on_nothing_is_asked_to_open_at_once():
    about = Waypoint(lambda state: Pose(THERE, np.eye(3)), gripper="close")
    guide, step = WaypointGuide(), step_of(about)
    looks = [(0.0, None), (0.1, 0.08), (1.7, 0.004), (1.8, 0.0)]
    asked = [guide.look(step, state_at(THERE, time_s=t), closing_m).gripper for t, closing_m in looks]
    assert asked == ["close", "close", "close", "open"]


def test_a_tool_that_has_drawn_back_is_led_to_the_thing_before_the_gripper_is_asked_to_close():
    about = Waypoint(lambda state: Pose(THERE, np.eye(3)), within_m=0.007, gripper="close")
    guide, step = WaypointGuide(), step_of(about)
    for above_m, asked in ((0.0, "close"), (0.01, "close"), (0.03, None), (0.0, "close")):
        left = guide.look(step, state_at(THERE + np.array([0.0, 0.0, above_m])))
        assert (left.gripper, left.shift_m[2]) == (asked, -above_m)


def test_a_waypoint_at_which_nothing_comes_true_and_nothing_is_left_to_drive_begins_the_step_again():
    above = Waypoint(lambda state: Pose(THERE + np.array([0.0, 0.0, 0.1]), np.eye(3)))
    cut = Waypoint(lambda state: Pose(THERE, np.eye(3)), within_m=0.01, until=lambda state: False)
    guide, step = WaypointGuide(), step_of(above, cut)
    guide.look(step, state_at(THERE + np.array([0.0, 0.0, 0.1])))
    # Near it, a person may take their time to press on.
    near = [guide.look(step, state_at(THERE + np.array([0.0, 0.0, 0.005]), time_s=t)) for t in (1.0, 60.0)]
    assert [left.shift_m[2] for left in near] == [-0.005, -0.005]
    there = [guide.look(step, state_at(THERE, time_s=t)).shift_m[2] for t in (61.0, 63.0, 64.5)]
    assert there == [0.0, 0.0, 0.1]


def test_a_step_that_is_not_done_after_its_last_waypoint_begins_again():
    low, high = (Waypoint(lambda state, z=z: Pose(np.array([0.0, 0.0, z]), np.eye(3))) for z in (0.0, 0.1))
    guide, step = WaypointGuide(), step_of(low, high)
    guide.look(step, state_at([0.0, 0.0, 0.0]))
    at_last = state_at([0.0, 0.0, 0.1], time_s=1.0)
    assert guide.look(step, at_last).shift_m == (0.0, 0.0, 0.0)
    assert guide.look(step, replace(at_last, time_s=2.5)).shift_m == (0.0, 0.0, -0.1)
    assert guide.look(None, at_last) is None


def test_a_tilted_vessel_is_turned_upright_before_it_is_carried():
    tilted = Rotation.from_euler("x", 1.3).as_matrix()
    carried = Waypoint(lambda state: Pose(THERE, np.eye(3)))
    step = replace(step_of(carried), holds="cup")
    tipped, level = state_at([0.0, 0.0, 0.0], tilted), state_at([0.0, 0.0, 0.0])
    tipped = replace(tipped, poses={"cup": tipped.tool})
    level = replace(level, poses={"cup": level.tool})
    guide = WaypointGuide(frozenset({"cup"}))
    left = guide.look(step, tipped)
    assert left.shift_m == (0.0, 0.0, 0.0)
    assert np.allclose(left.turn_rad, [-1.3, 0.0, 0.0])
    assert guide.look(step, level).shift_m == tuple(THERE)
    # To pour, it is brought there first, and what spills nothing is carried as it is.
    pour = replace(step_of(Waypoint(lambda state: Pose(THERE, tilted))), holds="cup")
    assert guide.look(pour, level).shift_m == tuple(THERE)
    assert WaypointGuide().look(step, tipped).shift_m == tuple(THERE)
