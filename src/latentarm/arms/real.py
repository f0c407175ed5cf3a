"""What a real arm can do beyond the contract of all arms: say what it is before anything moves."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

from latentarm.arms.contract import Arm
from latentarm.core.types import FloatArray


@final
@dataclass(frozen=True)
class Fact:
    """Something that was found out about an arm.

    Attributes:
        name: such as ``firmware``.
        value: in words, with its unit.
    """

    name: str
    value: str


@final
@dataclass(frozen=True, eq=False)
class FoundLimits:
    """The limits that an arm keeps by itself, as it tells them.

    Attributes:
        lower: (n,), lowest positions, rad.
        upper: (n,), highest positions, rad.
        velocity: (n,), largest speeds, rad/s.
    """

    lower: FloatArray
    upper: FloatArray
    velocity: FloatArray


@final
@dataclass(frozen=True)
class Findings:
    """What a driver finds out about an arm without moving it.

    Attributes:
        facts: firmware, limits, payload, clock, round trip, stop time, ... as far as the arm tells them.
        refusals: why it is not driven, each one sentence that says what to do; empty where it can be.
        limits: its own, where it tells them.
    """

    facts: tuple[Fact, ...]
    refusals: tuple[str, ...] = ()
    limits: FoundLimits | None = None


class RealArm(Arm, ABC):
    """An arm that exists. Its driver does all of `Arm`, over the manufacturer's own interface.

    What `look` refuses, `connect` refuses with the same sentence.
    """

    @abstractmethod
    def look(self) -> Findings:
        """Connect, find out what there is, and disconnect. Nothing moves, and nothing is changed.

        Raises:
            UserError: there is no arm, or what is there does not answer as one.
        """
