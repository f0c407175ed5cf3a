"""The one contract, over every task that an arm can be driven at."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.runs.tasks import make_task
from latentarm.tasks.catalogue import TASKS
from latentarm.tasks.reach import Reach
from latentarm.tasks.replay import Replay, routes_of
from latentarm.testing.tasks import TaskContract


class TestEveryTask(TaskContract):
    @pytest.fixture(params=[*TASKS, "held_out"])
    def task(self, request, table_top):
        if request.param == "table_top":
            return table_top
        if request.param == "held_out":
            shown = table_top.demonstrate(3, np.random.default_rng(0))
            return Replay(table_top.robot, routes_of(table_top.robot, shown))
        task = TASKS[request.param]
        return task(load_robot("planar")) if task.any_robot else task()


@pytest.mark.parametrize("name", TASKS)
def test_a_task_is_named_as_in_the_catalogue(name):
    assert make_task(name).name == name


def test_a_task_with_a_robot_of_its_own_takes_no_other():
    with pytest.raises(UserError, match="table_top is for the robot panda, not for planar: use --task reach"):
        make_task("table_top", robot="planar")
    with pytest.raises(UserError, match="has a panda of its own: for another tool"):
        make_task("table_top", end_effector="hand")
    assert make_task("reach", robot="planar").robot.name == "planar"


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
    task = Reach(load_robot("planar"))
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


def test_a_short_way_there_and_back_has_a_waypoint_away_from_its_start(table_top):
    shown = table_top.demonstrate(1, np.random.default_rng(0))
    one = shown.episodes[0]
    turned = 0.1 * np.sin(np.linspace(0.0, np.pi, len(one.timestamp)))
    state = np.repeat(one.state[:1], len(turned), axis=0)
    state[:, 1] += turned
    (route,) = routes_of(table_top.robot, replace(shown, episodes=(replace(one, state=state),)))
    assert len(route) == 3
    task = Replay(table_top.robot, (route,))
    start = table_top.robot.chain.forward(task.sample_start(0, np.random.default_rng(0)))
    there, back = task.waypoints(0, "follow")
    assert not task.reached(start, there)
    assert task.reached(start, back)
