"""What the three tasks have in common: a Panda whose hand is led along poses by a simulated person.

The paper says which two degrees of freedom each task has and leaves the rest open. Chosen here: in the plane
the hand points down, at one height; over the bowl it stays where it is, goes up and down and tilts about the
base's x axis. Demonstrations wander smoothly, so that every direction is shown everywhere.
"""

from abc import ABC, abstractmethod
from functools import cached_property
from typing import ClassVar, Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.tasks.inverse_kinematics import solve
from latentarm_research.tasks.pouring.tool_path import RATE_HZ, ToolPath, follow

HOME_RAD: Final = (0.0, -0.6, 0.0, -2.4, 0.0, 1.9, np.pi / 4)
"""Posture that starts stay close to: the hand points down before the arm."""


class PouringTask(ABC):
    """Two degrees of freedom of a Panda's hand, shown by a simulated person."""

    name: ClassVar[str]  # in snake_case

    @abstractmethod
    def draw(self, rng: np.random.Generator) -> ToolPath:
        """Where the hand goes in one demonstration."""

    @cached_property
    @final
    def robot(self) -> Robot:
        """A Panda."""
        return load_robot("panda")

    @final
    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Demonstrations by a simulated person, states alone, as from a hand on the arm."""
        if episodes < 1:
            raise UserError(f"Ask for at least one demonstration, not {episodes}.")
        paths = [self.draw(rng) for _ in range(episodes)]
        start = [solve(self.robot, path.poses(0), np.array(HOME_RAD)) for path in paths]
        return Demonstrations(
            episodes=tuple(
                Episode(state, np.arange(len(state)) / RATE_HZ, task=self.name)
                for state in follow(self.robot.chain, np.stack(start), paths)
            ),
            rate_hz=RATE_HZ,
            joint_names=self.robot.joint_names,
            robot=self.robot.name,
        )
