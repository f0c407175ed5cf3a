"""Operators, who give inputs."""

from abc import ABC, abstractmethod

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import BoolArray, Context, Input, Pose
from latentarm_research.people.moment import NOTHING_HELD, USUAL_WITHIN_M


class Operator(ABC):
    """A simulated person at the interface, asked once per step of the loop.

    An operator remembers what it was doing (an input it holds, a switch under way), so a new drive
    begins with `reset`.
    """

    @abstractmethod
    def reset(self) -> None:
        """Forget what was being done, before a new drive."""

    @abstractmethod
    def act(
        self,
        context: Context,
        controller: Controller,
        mode: int,
        target: Pose,
        rng: np.random.Generator,
        within_m: float = USUAL_WITHIN_M,  # how near they have to come to it, m
        speed: float = 1.0,  # share of their usual speed that is fit there, in (0, 1]
        held: BoolArray = NOTHING_HELD,  # (K,), which of the context's things the tool holds
    ) -> Input:
        """The simulated person's input for this step.

        Returns:
            Inputs in [-1, 1]^d, and whether the next mode is asked for.
        """
