"""Goals at the steps of a task: they go down with a person who stabs, and on with one who has."""

import numpy as np
import pytest

from latentarm.robots.robot import Robot
from latentarm.tasks.eating.dessert import MARSHMALLOW, Dessert
from latentarm.tasks.scene_task import Beginning
from latentarm.tasks.step_goals import MOVED_M, StepGoals
from scene_states import at, standing

FAR = at(x=3.0)  # out of the arm's reach


@pytest.fixture(scope="module")
def begun() -> Beginning:
    return Dessert().begin(0, np.random.default_rng(0))


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Dessert().robot


@pytest.fixture
def goals(begun, robot):
    return StepGoals(robot, begun.goals, begun.steps, begun.scene.names)


def scene(begun, **moved):
    return standing(poses={thing.name: thing.pose for thing in begun.scene.things} | moved)


def settled(goals, done, step, waypoint, state, q):
    """The last of all moves: at most one goal moves at a time."""
    moves = []
    while (move := goals.look(done, step, waypoint, state, q)) is not None:
        moves.append(move)
        assert len(moves) <= 5
    return moves


def height_of(robot, move, index):
    return robot.chain.forward(move.goals[index]).position[2]


def test_a_goal_goes_where_the_step_leads(begun, robot, goals):
    state, stab = scene(begun), begun.steps[1]
    over = begun.goals[0].pose.position[2]
    heights = []
    for waypoint in stab.waypoints:
        move = settled(goals, 1, stab, waypoint, state, begun.state)[-1]
        tool = robot.chain.forward(move.goals[0])
        assert tool.position == pytest.approx(waypoint.pose(state).position, abs=1e-3)
        heights.append(height_of(robot, move, 0))
    assert heights[1] < heights[0] < over
    assert heights[2] == pytest.approx(over, abs=0.03)


def test_things_of_later_steps_are_where_their_next_step_ends(begun, robot, goals):
    state, stab = scene(begun), begun.steps[1]
    move = settled(goals, 1, stab, stab.waypoints[0], state, begun.state)[-1]
    for index, goal in enumerate(begun.goals[1:], start=1):
        following = next(step for step in begun.steps[1:] if step.thing == goal.name)
        wanted = following.waypoints[-1].pose(state).position
        assert robot.chain.forward(move.goals[index]).position == pytest.approx(wanted, abs=2e-3)


def test_old_inputs_count_for_nothing_once_another_thing_s_turn_comes(begun, goals):
    state = scene(begun)
    for done, anew in ((0, False), (1, False), (2, True), (3, False), (4, True)):
        step = begun.steps[done]
        moves = settled(goals, done, step, step.waypoints[0], state, begun.state)
        assert any(move.anew for move in moves) == anew
        assert not any(move.anew for move in moves[1:])


def test_a_thing_that_moves_takes_its_goal_along(begun, robot, goals):
    step = begun.steps[0]
    (waypoint,) = step.waypoints
    settled(goals, 0, step, waypoint, scene(begun), begun.state)
    food = begun.scene.thing(MARSHMALLOW).pose
    hardly = at(*(food.position + np.array([0.5 * MOVED_M, 0.0, 0.0])), rotation=food.rotation)
    assert goals.look(0, step, waypoint, scene(begun, **{MARSHMALLOW: hardly}), begun.state) is None
    aside = at(*(food.position + np.array([0.0, 0.05, 0.0])), rotation=food.rotation)
    move = goals.look(0, step, waypoint, scene(begun, **{MARSHMALLOW: aside}), begun.state)
    moved = robot.chain.forward(move.goals[0]).position - begun.goals[0].pose.position
    assert moved == pytest.approx([0.0, 0.05, 0.0], abs=5e-3)


def test_a_goal_out_of_reach_stays(begun, goals):
    step = begun.steps[0]
    settled(goals, 0, step, step.waypoints[0], scene(begun), begun.state)
    away = scene(begun, **{MARSHMALLOW: FAR})
    assert goals.look(0, step, step.waypoints[0], away, begun.state) is None


def test_goals_that_are_no_things_and_tasks_without_goals_stay(begun, robot):
    step = begun.steps[0]
    asked = (0, step, step.waypoints[0], scene(begun), begun.state)
    assert StepGoals(robot, begun.goals, begun.steps, ()).look(*asked) is None
    assert StepGoals(robot, (), begun.steps, begun.scene.names).look(*asked) is None
