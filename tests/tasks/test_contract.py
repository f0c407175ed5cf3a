import numpy as np
import pytest

from latentarm.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.tasks.reach import Reach
from latentarm.tasks.replay import Replay
from latentarm.tasks.two_cups import PandaTwoCups, PlanarTwoCups


@pytest.fixture(params=["table_top", "reach", "replay", "planar_two_cups", "panda_two_cups"])
def task(request):
    if request.param == "reach":
        return Reach(load_robot("planar"))
    if request.param == "planar_two_cups":
        return PlanarTwoCups()
    if request.param == "panda_two_cups":
        return PandaTwoCups()
    table_top = request.getfixturevalue("table_top")
    if request.param == "table_top":
        return table_top
    return Replay(table_top.robot, table_top.demonstrate(3, np.random.default_rng(0)))


def test_starts_and_goals_are_within_the_limits(task):
    limits = task.robot.limits
    for index, goal in enumerate(task.goals):
        start = task.sample_start(index, np.random.default_rng(index))
        for state in (start, goal.configuration):
            assert state.shape == (task.robot.dof,)
            assert not limits.violation(state).any()


def test_a_start_is_not_yet_the_goal(task):
    for index in range(len(task.goals)):
        start = task.robot.chain.forward(task.sample_start(index, np.random.default_rng(0)))
        for manner in task.manners:
            assert not task.reached(start, task.waypoints(index, manner)[-1])


def test_a_waypoint_is_reached_by_being_there(task):
    for manner in task.manners:
        for waypoint in task.waypoints(0, manner):
            assert task.reached(waypoint, waypoint)


def test_demonstrations_are_of_the_tasks_robot_and_end_at_a_last_waypoint(task):
    shown = task.demonstrate(3, np.random.default_rng(0))
    assert len(shown.episodes) == 3
    assert shown.joint_names == task.robot.joint_names
    assert shown.robot == task.robot.name
    ways = [task.waypoints(goal, manner)[-1] for goal in range(len(task.goals)) for manner in task.manners]
    for episode in shown.episodes:
        end = task.robot.chain.forward(episode.state[-1])
        assert any(task.reached(end, waypoint) for waypoint in ways)
        assert (np.diff(episode.timestamp) > 0).all()


def test_unknown_goals_manners_and_no_demonstrations_are_refused(task):
    for call in (
        lambda: task.waypoints(99, task.manners[0]),
        lambda: task.waypoints(0, "juggle"),
        lambda: task.demonstrate(0, np.random.default_rng(0)),
    ):
        with pytest.raises(UserError):
            call()
