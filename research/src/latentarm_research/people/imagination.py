"""How a simulated person comes to expect what they do of their inputs."""

from abc import ABC, abstractmethod
from typing import final

import numpy as np

from latentarm_research.people.foresight import Foresight
from latentarm_research.people.moment import Moment


class Imagination(ABC):
    """What a simulated person imagines, which may change with what they see."""

    @abstractmethod
    def reset(self) -> None:
        """Forget what was seen, before a new drive."""

    @abstractmethod
    def saw(self, moment: Moment) -> None:
        """Learn from what is seen at each call."""

    @abstractmethod
    def foresight(self, rng: np.random.Generator) -> Foresight:
        """What they expect of inputs now, for one decision."""


@final
class Settled(Imagination):
    """Always expects the same, whatever happens."""

    def __init__(self, foresight: Foresight) -> None:
        self._foresight = foresight

    def reset(self) -> None:
        """Nothing was learned."""

    def saw(self, moment: Moment) -> None:
        """Nothing is learned."""

    def foresight(self, rng: np.random.Generator) -> Foresight:
        """The same as ever."""
        return self._foresight
