"""The person who answers alignment questions, and one question."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal, final

from latentarm.alignment.answers import Motions
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain

Say = Callable[[str], None]  # shows text to the person
Kind = Literal["person", "simulated person"]
Reply = FloatArray | Literal["back"] | None
"""An input (d,), None where they would not know, or ``back`` to be asked the question before once more."""


@final
@dataclass(frozen=True, eq=False)
class Question:
    """One motion for a person to answer."""

    number: int  # counted from 1
    total: int  # at most
    motion: Motions
    chain: Chain
    reach_m: float  # the longest way of a tool in any motion, m
    axes: int


class Respondent(ABC):
    """A person who answers questions."""

    kind: ClassVar[Kind]  # for the profile

    @abstractmethod
    def answer(self, question: Question) -> Reply:
        """The input by which they would ask for the motion; UserError where nobody answers any more."""
