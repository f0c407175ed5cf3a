"""A simulated person drives at a task with things, in physics."""

from dataclasses import replace

import numpy as np

from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.tasks.catalogue import make_scene_task
from latentarm.tasks.eating.table import fork
from latentarm.tasks.scene_task import SceneTask
from latentarm.tasks.steps import TaskStep, Waypoint
from latentarm_research.drives.drive import REARM_S, Setup, drive
from latentarm_research.people.catalogue import PEOPLE


class ThroughThePlate(SceneTask):
    """Somebody means to go where a plate is in the way, and starts just over it."""

    inner = make_scene_task("marshmallows")
    name, robot, choices = "through_the_plate", inner.robot, ("down",)
    obstacles, time_limit_s = inner.obstacles, 8.0

    def begin(self, choice, rng):
        begun = self.inner.begin(choice, rng)
        place = begun.scene.thing("plate").pose.position
        state = min(begun.goals, key=lambda goal: np.linalg.norm(goal.pose.position - place)).configuration
        below = Waypoint(lambda _: fork(place, -0.1), within_m=0.01)
        return replace(
            begun,
            state=state,
            steps=(TaskStep("reached", "plate", "below the plate", lambda _: False, (below,)),),
        )


def test_an_arm_that_meets_a_dish_stops_and_the_person_enables_it_again():
    task = ThroughThePlate()
    setup = Setup(task, EndEffectorController(task.robot), PEOPLE["greedy"])
    trace = drive(setup, 0, np.random.default_rng(3))
    figures = trace.figures
    assert figures.table_force_n > 50.0
    # At rest from each stop on, and then tried again: more than once, and no more often than that allows.
    assert 2 <= figures.stops <= figures.time_s / REARM_S
    assert not figures.success
    assert trace.ended_in == "below the plate"
