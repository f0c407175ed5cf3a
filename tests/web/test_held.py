"""What slips or is let go too early is told, is to be taken again, and the steps go on where they were."""

import numpy as np
import pytest

from latentarm.arms.contract import SceneArm
from latentarm.arms.kinematic import KinematicArm
from latentarm.arms.mujoco import MujocoArm
from latentarm.core.types import Pose
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.catalogue import SCENE_TASKS, make_scene_task
from latentarm.tasks.mishap import Mishap
from latentarm.tasks.steps import LOST_M, LOST_S, Progress, TaskStep, Waypoint
from latentarm.tasks.table_top import TableTop
from latentarm.web.arm_process.fill_level import FillLevels, vessels
from latentarm.web.arm_process.task_run import TaskRun, Todo
from latentarm_research.drives.demonstrate import demonstrate_once

NONE = frozenset()


class Counter(KinematicArm, SceneArm):
    """An arm that knows what it holds, how high a spoon is, and how far it has been stirred."""

    def __init__(self) -> None:
        robot = TableTop().robot
        super().__init__(robot, robot.home, lambda: 0.0)
        self.held = True
        self.height_m = 0.2
        self.stirred = False
        self.broken = False

    def scene_state(self) -> SceneState:
        tool = Pose(np.zeros(3), np.eye(3))
        spoon = Pose(np.array([0.0, 0.0, self.height_m]), np.eye(3))
        gripped = frozenset({"spoon"}) if self.held else NONE
        return SceneState(0.0, tool, {"spoon": spoon}, {}, NONE, gripped, NONE, {}, {})


@pytest.fixture
def arm():
    return Counter()


@pytest.fixture
def run(arm):
    at = Waypoint(lambda state: Pose(np.array([0.1, 0.0, 0.0]), np.eye(3)))
    over = Waypoint(lambda state: Pose(np.array([0.0, 0.3, 0.0]), np.eye(3)))
    taken = TaskStep("holding", "spoon", "", lambda state: state.poses["spoon"].position[2] > 0.1, (at,))
    above = TaskStep("above", "bowl", "", lambda state: True, (over,), "spoon")
    stirred = TaskStep("stirred", "bowl", "", lambda state: arm.stirred, (over,), "spoon")
    fails = (lambda state: Mishap("dropped", "spoon") if arm.broken else None,)
    return TaskRun(Todo("stir", ("spoon",), 0, (taken, above, stirred), fails), arm, TableTop().robot.chain)


def seen(run, *times_s):
    for time_s in times_s:
        run.see(time_s, np.zeros(7), enabled=True, steered=True)
    return run.state


def test_what_slips_is_taken_again_and_nothing_else_is_done_twice(run, arm):
    assert (seen(run, 0.0).done, run.state.lost) == (2, None)
    assert run.state.to_go.shift_m == (0.0, 0.3, 0.0)
    arm.held, arm.height_m = False, 0.02
    assert seen(run, 1.0, 1.0 + 0.9 * LOST_S).lost is None
    state = seen(run, 1.0 + LOST_S)
    assert (state.done, state.outcome, state.lost.thing, state.lost.step) == (2, None, "spoon", 0)
    # Guided to where it is taken.
    assert seen(run, 3.0).to_go.shift_m == (0.1, 0.0, 0.0)
    arm.held = True
    assert seen(run, 4.0).lost is not None
    arm.height_m = 0.2
    assert (seen(run, 5.0).done, run.state.lost) == (2, None)
    assert seen(run, 5.1).to_go.shift_m == (0.0, 0.3, 0.0)
    arm.stirred = True
    assert seen(run, 6.0).outcome == "success"


def test_what_stays_in_the_hand_is_held_whatever_the_fingers_touch(run, arm):
    seen(run, 0.0)
    arm.held = False
    arm.height_m += 0.9 * LOST_M
    assert seen(run, 1.0, 10.0).lost is None
    arm.height_m += 0.2 * LOST_M
    assert seen(run, 10.5, 10.9).lost is None
    arm.held = True
    assert seen(run, 11.0).lost is None
    arm.held, arm.height_m = False, 0.02
    assert seen(run, 20.0, 21.0).lost is not None


def test_what_has_failed_for_good_is_not_to_be_taken_again(run, arm):
    seen(run, 0.0)
    arm.held, arm.height_m = False, 0.02
    assert seen(run, 1.0, 1.0 + LOST_S).lost is not None
    arm.broken = True
    state = seen(run, 4.0)
    assert (state.outcome, state.why.code, state.lost) == ("failure", "dropped", None)


@pytest.mark.parametrize("name", SCENE_TASKS)
def test_what_a_step_needs_to_be_held_was_taken_in_an_earlier_one(name):
    task = make_scene_task(name)
    for choice in range(len(task.choices)):
        taken = set()
        for step in task.begin(choice, np.random.default_rng(0)).steps:
            assert step.holds is None or step.holds in taken
            # Pouring, and all that is done with what was taken, needs it.
            assert step.holds is not None or not taken or step.kind in ("reached", "above", "holding")
            if step.kind in ("holding", "stabbed"):
                taken.add(step.thing)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["dessert", "apple_pie"])
def test_nothing_is_called_lost_or_short_in_a_run_that_succeeds(name, monkeypatch):
    task, scene_state = make_scene_task(name), MujocoArm.scene_state
    for choice in range(len(task.choices)):
        # Steps measure what happens in them, so they must see it as often as the person who drives.
        states = []

        def recorded_state(arm, states=states):
            states.append(scene_state(arm))
            return states[-1]

        monkeypatch.setattr(MujocoArm, "scene_state", recorded_state)
        shown = demonstrate_once(task, choice, np.random.default_rng(0))
        begun = task.begin(choice, np.random.default_rng(0))
        progress, fills = Progress(begun.steps, begun.failures), FillLevels(vessels(begun))
        for state in states:
            progress.update(state)
            assert progress.lost is None
            fills.see(state, state.time_s)
            assert not fills.short
        assert shown.progress.succeeded
        assert progress.done == len(begun.steps)
