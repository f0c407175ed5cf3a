"""How a simulated person decides what to do with the stick."""

from abc import ABC, abstractmethod

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import Input
from latentarm_research.people.imagination import Imagination
from latentarm_research.people.moment import Moment


class Decision(ABC):
    """A way to decide, asked once per step of the loop; it remembers what is being done."""

    @abstractmethod
    def reset(self) -> None:
        """Forget what was being done, before a new drive."""

    @property
    @abstractmethod
    def holding(self) -> bool:
        """Whether the next call of `decide` goes on with what is being done, without deciding."""

    @abstractmethod
    def decide(
        self,
        moment: Moment,
        controller: Controller,
        imagination: Imagination,  # where they expect inputs to lead
        rng: np.random.Generator,
    ) -> Input:
        """What the person means to do now.

        Returns:
            An input of length 1 at most, and whether the next mode is asked for.
        """
