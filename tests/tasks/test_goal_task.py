"""A task at goals, driven as one with things."""

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.robots.planar import planar
from latentarm.tasks.goal_task import GoalTask, without_things
from latentarm.tasks.reach import Reach
from latentarm.tasks.replay import Replay
from latentarm.tasks.steps import Progress

ARM = planar(2)
ROUTE = np.linspace([0.3, 0.6], [1.5, 1.8], 50)


def test_its_waypoints_are_steps_that_tick_off_where_the_task_says_that_they_are_reached():
    task = Replay(ARM, (ROUTE,))
    begun = GoalTask(task, "follow", 5.0).begin(0, np.random.default_rng(0))
    waypoints = task.waypoints(0, "follow")
    assert len(begun.steps) == len(waypoints) > 1
    progress, left = Progress(begun.steps, begun.failures), list(waypoints)
    for time_s, pose in enumerate(waypoints):
        progress.update(without_things(pose, float(time_s), {}))
        while left and task.reached(pose, left[0]):
            left.pop(0)
        assert progress.done == len(waypoints) - len(left)
    assert progress.succeeded


def test_the_gripper_is_asked_something_at_the_start_and_once_each_step_is_done():
    open_at = np.arange(len(ROUTE)) < 25
    asked = GoalTask(Replay(ARM, (ROUTE,), (open_at,)), "follow", 5.0).begin(0, np.random.default_rng(0))
    assert len(asked.asks) == len(asked.steps) + 1
    assert (asked.asks[0], asked.asks[-1]) == ("open", "close")
    assert GoalTask(Replay(ARM, (ROUTE,)), "follow", 5.0).begin(0, np.random.default_rng(0)).asks == ()


def test_it_starts_where_the_task_does_and_refuses_what_the_task_does_not_know():
    task = Reach(ARM)
    way = GoalTask(task, "reach", 5.0)
    assert way.choices == tuple(goal.name for goal in task.goals)
    begun = way.begin(1, np.random.default_rng(3))
    np.testing.assert_array_equal(begun.state, task.sample_start(1, np.random.default_rng(3)))
    with pytest.raises(UserError, match="not 'stab' 1"):
        GoalTask(task, "stab", 5.0).begin(1, np.random.default_rng(3))
