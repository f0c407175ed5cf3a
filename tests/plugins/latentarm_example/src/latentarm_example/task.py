"""Two buttons to press, for a Panda."""

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, FloatArray, Goal, Pose
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.tasks.demonstrator import demonstrate_goals
from latentarm.tasks.task import Task

PRESSED_M = 0.03
"""A button is pressed where the tool is this near to it."""


class TwoButtons(Task):
    """A button to the left and one to the right."""

    name = "two_buttons"
    manners = ("press",)
    obstacles = ()

    def __init__(self) -> None:
        self._robot = load_robot("panda")
        self._goals = tuple(self._button(name, turn) for name, turn in (("left", 0.6), ("right", -0.6)))

    @property
    def robot(self) -> Robot:
        return self._robot

    @property
    def goals(self) -> tuple[Goal, ...]:
        return self._goals

    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        return self._robot.home + rng.uniform(-0.05, 0.05, self._robot.dof)

    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        if not 0 <= goal < len(self._goals) or manner not in self.manners:
            raise UserError(f"The buttons are 0 and 1, to be pressed: there is no {manner!r} of {goal}.")
        return (self._goals[goal].pose,)

    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        return float(np.linalg.norm(pose.position - waypoint.position)) < PRESSED_M

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        return demonstrate_goals(
            self, lambda goal: self._goals[goal].configuration[None], "press", episodes, rng
        )

    def _button(self, name: str, turn: float) -> Goal:
        configuration = self._robot.home.copy()
        configuration[0] += turn
        return Goal(name, configuration, self._robot.chain.forward(configuration))
