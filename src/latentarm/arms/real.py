"""Real arms: their description before anything moves, and guiding by hand."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

from latentarm.arms.contract import Arm
from latentarm.core.types import FloatArray


@final
@dataclass(frozen=True)
class Fact:
    """A fact about an arm, such as ``firmware``, and its value in words, with its unit."""

    name: str
    value: str


@final
@dataclass(frozen=True, eq=False)
class FoundLimits:
    """Limits that an arm reports and keeps by itself, each (n,); infinite or None where it states none."""

    lower: FloatArray  # rad
    upper: FloatArray  # rad
    velocity: FloatArray  # rad/s
    acceleration: FloatArray | None = None  # rad/s²
    jerk: FloatArray | None = None  # rad/s³
    rounding: float = 1e-3  # the robot's limits may exceed these by so much


@final
@dataclass(frozen=True)
class Findings:
    """A driver's findings about an arm, without moving it."""

    # firmware, limits, payload, clock, round trip, stop time, ... as far as the arm reports them.
    facts: tuple[Fact, ...]
    refusals: tuple[str, ...] = ()  # reasons not to drive it, each one sentence that says what to do
    limits: FoundLimits | None = None  # its own, if it reports them
    notices: tuple[str, ...] = ()  # to be known before driving, each one sentence


class RealArm(Arm, ABC):
    """A physical arm. Its driver does all of `Arm`, over the manufacturer's own interface.

    If `look` refuses, `connect` refuses with the same sentence.
    """

    @abstractmethod
    def look(self) -> Findings:
        """Connect, inspect, and disconnect. Nothing moves, and nothing changes.

        Raises:
            UserError: there is no arm, or what is there does not answer as one.
        """

    @abstractmethod
    def watch(self) -> None:
        """Connect as `connect` does, but only to read: nothing is claimed, set, cleared or switched.

        Until `close`, only `read` and `status` are called, which send the arm no command of any kind.

        Raises:
            UserError: as `connect`.
        """


class GuidableArm(RealArm, ABC):
    """A real arm that carries its own weight while a person moves it by hand.

    `guide` asks a disabled arm for that. While `status` says *guided*, the arm goes only where a hand pushes
    it, though it may sag under an unknown load. `disable` and `close` end it, and so do an emergency stop, a
    fault and a lost connection: the arm then holds its position, and `status` says *guided* until it does. It
    ignores `send`.
    """

    @abstractmethod
    def guide(self) -> None:
        """Ask a disabled arm to be moved by hand; `status` says when it can be.

        Nothing happens in any other phase, nor at a second call.

        Raises:
            UserError: it cannot be asked for from here; the sentence says what to do at the arm.
        """
