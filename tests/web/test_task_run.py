"""Runs of tasks as pages follow them: what counts as done, when a run begins, and what begins another one."""

import json
from typing import get_args

import numpy as np
import pytest

from latentarm.arms.contract import Arm, SceneArm
from latentarm.arms.kinematic import KinematicArm
from latentarm.core.errors import UserError
from latentarm.core.types import Goal, Pose
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.catalogue import SCENE_TASKS, TASKS, make_scene_task
from latentarm.tasks.mishap import Mishap, MishapKind
from latentarm.tasks.step_goals import StepGoals
from latentarm.tasks.steps import StepKind, TaskStep, Waypoint
from latentarm.tasks.table_top import ITEM_HEIGHT, ITEMS, TableTop
from latentarm.tasks.task import REACHED_DISTANCE
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.arm_process.task_run import TaskRun, Todo, goal_to_reach
from latentarm.web.protocol.orders import BeginTask, Enable
from latentarm.web.protocol.page_messages import parse_message
from latentarm.web.server.loaded_run import LoadedRun
from latentarm.web.words.catalogue import DEFAULT, languages

ENGLISH = languages()[DEFAULT].texts
HERE = Pose(np.zeros(3), np.eye(3))


class Table(KinematicArm, SceneArm):
    """An arm that knows where a cup is."""

    def __init__(self, height_m: float = 0.1) -> None:
        robot = TableTop().robot
        super().__init__(robot, robot.home, lambda: 0.0)
        self.height_m = height_m

    def scene_state(self) -> SceneState:
        cup = Pose(np.array([0.0, 0.0, self.height_m]), np.eye(3))
        none = frozenset()
        return SceneState(0.0, HERE, {"cup": cup}, {}, none, none, none, {}, {})


def lifted(height_m: float) -> TaskStep:
    waypoint = Waypoint(lambda state: HERE)
    return TaskStep(
        "holding", "cup", "lifted", lambda state: state.poses["cup"].position[2] > height_m, (waypoint,)
    )


def fallen(state: SceneState) -> Mishap | None:
    return Mishap("dropped", "cup") if state.poses["cup"].position[2] < 0.0 else None


def run_of(arm: Arm) -> TaskRun:
    return TaskRun(
        Todo("lift", ("cup",), 0, (lifted(0.2), lifted(0.4)), (fallen,)), arm, TableTop().robot.chain
    )


def seen(
    run: TaskRun, time_s: float, *, enabled: bool = True, steered: bool = True
) -> tuple[int, str | None, float]:
    run.see(time_s, np.zeros(7), enabled=enabled, steered=steered)
    return run.state.done, run.state.outcome, run.state.time_s


def test_a_run_begins_with_the_first_enable_and_its_time_ends_with_its_outcome():
    arm = Table(0.3)
    run = run_of(arm)
    assert seen(run, 10.0, enabled=False) == (0, None, 0.0)
    assert seen(run, 11.0) == (1, None, 0.0)
    assert seen(run, 13.0, enabled=False) == (1, None, 2.0)
    arm.height_m = 0.5
    assert seen(run, 14.5, enabled=False) == (2, "success", 3.5)
    arm.height_m = -1.0
    assert seen(run, 20.0) == (2, "success", 3.5)


def test_help_leads_to_the_waypoint_of_the_step_until_the_run_is_over():
    robot = TableTop().robot
    ahead = robot.chain.forward(robot.home + 0.1)
    step = TaskStep("holding", "cup", "lifted", lifted(0.2).done, (Waypoint(lambda state: ahead),))
    arm, goal = Table(), Goal("cup", robot.home, robot.chain.forward(robot.home))
    run = TaskRun(Todo("lift", ("cup",), 0, (step,)), arm, robot.chain)
    goals = StepGoals(robot, (goal,), (step,), ("cup",))
    assert run.move_goals(goals, robot.home, {}) is None  # nothing has been seen yet
    seen(run, 1.0)
    move = run.move_goals(goals, robot.home, {})
    assert move is not None
    assert robot.chain.forward(move.goals[0]).position == pytest.approx(ahead.position, abs=1e-3)
    assert run.move_goals(goals, robot.home, {}) is None  # it stays there
    arm.height_m = 0.3
    seen(run, 2.0)
    assert run.state.outcome == "success"
    assert run.move_goals(goals, robot.home, {}) is None


def test_progress_with_things_counts_on_the_way_back_too():
    run = run_of(Table(0.3))
    assert seen(run, 10.0, steered=False) == (1, None, 0.0)


def test_what_goes_wrong_is_told_as_a_code_and_a_thing_and_stays():
    arm = Table(-0.1)
    run = run_of(arm)
    assert seen(run, 1.0) == (0, "failure", 0.0)
    assert (run.state.why.code, run.state.why.thing) == ("dropped", "cup")
    arm.height_m = 0.5
    assert seen(run, 2.0) == (0, "failure", 0.0)


def test_without_steps_nothing_counts_as_done():
    run = TaskRun(Todo("look", (), 0, ()), Table(), TableTop().robot.chain)
    assert seen(run, 1.0) == (0, None, 0.0)


@pytest.mark.parametrize("goal", range(len(ITEMS)))
def test_at_the_table_a_goal_is_reached_where_simulated_drives_say_so(goal):
    task = TableTop()
    robot = task.robot
    run = TaskRun(goal_to_reach(task, goal), None, robot.chain)
    name = task.goals[goal].name
    assert [(step.kind, step.thing) for step in goal_to_reach(task, goal).steps] == [
        ("approached", name),
        ("reached", name),
    ]
    run.see(0.0, robot.home, enabled=True, steered=True)
    assert run.state.done == 0
    near = task.goals[goal].configuration
    run.see(0.5, near, enabled=True, steered=False)
    assert run.state.done == 0, "a goal on the way to a saved pose is not reached"
    run.see(1.0, near, enabled=True, steered=True)
    assert run.state.done == 1
    end = task._manipulation(goal, "stab")[-1]
    tool = robot.chain.forward(end).position
    food = np.array([*ITEMS[name], ITEM_HEIGHT])
    assert np.linalg.norm(tool - food) < REACHED_DISTANCE
    run.see(2.0, end, enabled=True, steered=True)
    assert (run.state.done, run.state.outcome, run.state.time_s) == (2, "success", 2.0)


def test_food_is_drawn_where_the_tool_stabs_it():
    setup = load_setup(Spec())
    loaded = LoadedRun(setup, None)
    things = {thing["name"]: thing["pose"][:3] for thing in loaded.scene.description["things"]}
    told = {thing.name: thing.position for thing in loaded.welcome("me", "server").things}
    for name, place in ITEMS.items():
        assert things[name] == pytest.approx([*place, ITEM_HEIGHT])
        assert told[name] == pytest.approx(things[name])


@pytest.mark.parametrize("name", [*SCENE_TASKS, *TASKS])
def test_every_step_of_every_task_and_all_that_goes_wrong_has_words(name):
    setup = load_setup(Spec(task=name))
    things = {step.thing for step in setup.todo.steps} | set(setup.todo.choices)
    things |= {goal.name for goal in setup.task.goals}
    if name in SCENE_TASKS:
        failures = make_scene_task(name).begin(0, np.random.default_rng(0)).failures
        things |= {getattr(fails, "thing", None) or fails.grains for fails in failures}
    for thing in things:
        key = f"thing.{thing.replace(' ', '_')}"
        assert {key, f"{key}.the"} <= set(ENGLISH), thing
    assert f"task.name.{name}" in ENGLISH
    for step in setup.todo.steps:
        if step.kind == "placed":
            assert f"thing.{step.thing.replace(' ', '_')}.into" in ENGLISH


def test_every_kind_of_step_and_mishap_has_words():
    assert {key for key in ENGLISH if key.startswith("task.step.")} == {
        f"task.step.{kind}" for kind in get_args(StepKind)
    }
    assert {key for key in ENGLISH if key.startswith("task.failed.")} == {
        f"task.failed.{kind}" for kind in get_args(MishapKind)
    }


def test_the_same_seed_places_things_alike_whatever_is_chosen_and_another_one_otherwise():
    first, other, anew = (
        load_setup(Spec(task="marshmallows", seed=seed, choice=choice))
        for seed, choice in [(4, 0), (4, 2), (5, 0)]
    )
    places = [[thing.pose.position for thing in setup.scene.things] for setup in (first, other, anew)]
    assert np.array_equal(places[0], places[1])
    assert not np.array_equal(places[0], places[2])
    assert [step.thing for step in other.todo.steps] == 2 * ["right marshmallow"]


def test_there_is_no_choice_beyond_the_last():
    with pytest.raises(UserError, match="no choice 3"):
        load_setup(Spec(task="marshmallows", choice=3))


def test_a_page_may_ask_for_another_run():
    asked = parse_message(json.dumps({"type": "begin_run", "choice": 1, "anew": True}))
    assert asked == BeginTask(choice=1, anew=True)
    for wrong in ({"choice": -1, "anew": True}, {"choice": 0.5, "anew": True}, {"choice": 0}):
        with pytest.raises(ValueError, match="begin_run"):
            parse_message(json.dumps({"type": "begin_run", **wrong}))


def test_another_run_begins_only_with_the_arm_disengaged(desk):
    order = BeginTask(choice=1, anew=True)

    def tick(now_s):
        desk.give(0.0, 0.0)
        if abs(now_s - 0.1) < 0.005:
            desk.order(Enable(driver=1, stops=desk.channel.stop.version))
        if abs(now_s - 0.6) < 0.005:
            desk.order(order)

    desk.each_tick = tick
    desk.run(1.0)
    assert desk.drive.change is None
    assert desk.reports[-1].note.code == "stop_first"
    assert desk.reports[-1].task.time_s > 0.5


@pytest.mark.parametrize(("choice", "begins"), [(1, True), (None, True), (3, False)])
def test_a_disengaged_arm_begins_what_there_is_to_choose(desk, choice, begins):
    order = BeginTask(choice=choice, anew=False)
    desk.each_tick = lambda now_s: desk.order(order) if abs(now_s - 0.1) < 0.005 else None
    desk.run(0.5)
    assert desk.drive.change == (order if begins else None)
    report = desk.reports[-1]
    assert (report.seed, report.task.choice, report.task.done, report.task.outcome) == (0, 0, 0, None)


def test_a_page_is_told_of_what_there_is_to_do(desk):
    todo = LoadedRun(desk.setup, "run").welcome("me", "server").task
    assert (todo.name, todo.choices, todo.choice) == ("table_top", tuple(ITEMS), 0)
    assert [step.kind for step in todo.steps] == ["approached", "reached"]
