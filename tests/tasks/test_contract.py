from dataclasses import replace

import numpy as np
import pytest

from latentarm.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.tasks.reach import Reach
from latentarm.tasks.replay import Replay, routes_of
from latentarm.tasks.task import check_not_done
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
    shown = table_top.demonstrate(3, np.random.default_rng(0))
    return Replay(table_top.robot, routes_of(table_top.robot, shown))


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


def test_a_task_that_is_done_where_the_arm_starts_is_refused(task):
    way = task.waypoints(0, task.manners[0])
    check_not_done(task, task.sample_start(0, np.random.default_rng(0)), way)
    with pytest.raises(UserError, match="done before it begins"):
        check_not_done(
            task, task.goals[0].configuration, [task.robot.chain.forward(task.goals[0].configuration)]
        )


TURNTABLE = """<mujoco><compiler angle="radian"/><worldbody><body name="table">
<joint name="turn" axis="0 0 1" range="-0.1 0.1"/><geom size="0.1"/><site name="middle"/>
</body></worldbody></mujoco>"""


def test_a_tool_that_hardly_moves_has_nowhere_to_reach_to(tmp_path):
    """As a site on the first link of an arm: every goal is where it stands."""
    path = tmp_path / "turntable.xml"
    path.write_text(TURNTABLE)
    with pytest.raises(UserError, match=r"nowhere to reach to: middle of .* hardly moves with the 1 joints?"):
        Reach(load_robot(str(path)))


@pytest.mark.parametrize("seed", range(20))
def test_reaching_starts_away_from_every_goal(seed):
    task = Reach(load_robot("planar"), seed=seed)
    for goal in range(len(task.goals)):
        start = task.sample_start(goal, np.random.default_rng(seed))
        assert not task.reached(task.robot.chain.forward(start), task.goals[goal].pose)


def test_episodes_in_which_the_tool_goes_nowhere_are_not_followed(table_top):
    shown = table_top.demonstrate(2, np.random.default_rng(0))
    first = shown.episodes[0]
    # Joints twitch by more than counts as standing still; the tool stays within 3 cm.
    twitch = replace(first, state=first.state[:1] + 0.02 * np.sin(first.timestamp)[:, None])
    assert len(routes_of(table_top.robot, replace(shown, episodes=(twitch, shown.episodes[1])))) == 1
    with pytest.raises(UserError, match=r"In none of these episodes does tool of panda go anywhere"):
        routes_of(table_top.robot, replace(shown, episodes=(twitch,)))
