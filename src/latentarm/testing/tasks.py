"""Contract tests of tasks."""

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.tasks.task import Task, check_not_done


class TaskContract:
    """Tests of a task.

    Override the fixture ``task``::

        class TestTheirTask(TaskContract):
            @pytest.fixture
            def task(self):
                return TheirTask()
    """

    @pytest.fixture
    def task(self) -> Task:
        """The task."""
        raise NotImplementedError("override the fixture `task`")

    def test_starts_and_goals_are_within_the_limits(self, task: Task) -> None:
        limits = task.robot.limits
        for index, goal in enumerate(task.goals):
            start = task.sample_start(index, np.random.default_rng(index))
            for state in (start, goal.configuration):
                assert state.shape == (task.robot.dof,)
                assert not limits.violation(state).any()

    def test_a_seed_gives_the_same_start(self, task: Task) -> None:
        first, second = (task.sample_start(0, np.random.default_rng(7)) for _ in range(2))
        np.testing.assert_array_equal(first, second)

    def test_a_start_is_not_yet_the_goal(self, task: Task) -> None:
        for index in range(len(task.goals)):
            start = task.robot.chain.forward(task.sample_start(index, np.random.default_rng(0)))
            for manner in task.manners:
                assert not task.reached(start, task.waypoints(index, manner)[-1])

    def test_a_waypoint_is_reached_by_being_there(self, task: Task) -> None:
        for manner in task.manners:
            for waypoint in task.waypoints(0, manner):
                assert task.reached(waypoint, waypoint)

    def test_demonstrations_are_of_the_tasks_robot_and_lead_to_a_last_waypoint(self, task: Task) -> None:
        shown = task.demonstrate(3, np.random.default_rng(0))
        assert len(shown.episodes) == 3
        assert shown.joint_names == task.robot.joint_names
        assert shown.robot == task.robot.name
        goals = range(len(task.goals))
        ways = [task.waypoints(goal, manner)[-1] for goal in goals for manner in task.manners]
        for episode in shown.episodes:
            # Most end there; some also show the way back.
            poses = (task.robot.chain.forward(state) for state in reversed(episode.state))
            assert any(task.reached(pose, waypoint) for pose in poses for waypoint in ways)
            assert (np.diff(episode.timestamp) > 0).all()

    def test_unknown_goals_manners_and_no_demonstrations_are_refused(self, task: Task) -> None:
        for call in (
            lambda: task.waypoints(99, task.manners[0]),
            lambda: task.waypoints(0, "juggle"),
            lambda: task.demonstrate(0, np.random.default_rng(0)),
        ):
            with pytest.raises(UserError):
                call()

    def test_a_task_that_is_done_where_the_arm_starts_is_refused(self, task: Task) -> None:
        way = task.waypoints(0, task.manners[0])
        check_not_done(task, task.sample_start(0, np.random.default_rng(0)), way)
        there = task.goals[0].configuration
        with pytest.raises(UserError, match="done before it begins"):
            check_not_done(task, there, [task.robot.chain.forward(there)])
