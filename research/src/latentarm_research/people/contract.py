"""What all simulated people have in common: what they see, what they expect of inputs, how they decide."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Final, final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import BoolArray, Context, FloatArray, Input, Pose
from latentarm.robots.kinematics.chain import Chain

USUAL_WITHIN_M: Final = 0.02  # how near a simulated person has to come for which their figures are stated, m


NOTHING_HELD: Final[BoolArray] = np.zeros(0, dtype=np.bool_)


@final
@dataclass(frozen=True, eq=False)
class Moment:
    """What a simulated person sees at one moment."""

    context: Context  # what the arm is at and believes
    mode: int  # the controller's mode
    target: Pose  # the pose that they want the tool at
    u: FloatArray  # (d,), the input that has just been given
    within_m: float = USUAL_WITHIN_M  # how near they have to come to it, m
    speed: float = 1.0  # share of their usual speed that is fit there, in (0, 1]
    # (K,), which of the context's things the tool holds
    held: BoolArray = field(default_factory=lambda: NOTHING_HELD)


@final
@dataclass(frozen=True, eq=False)
class LoopLimits:
    """The loop's dead zone and how fast it lets joints move; by default neither limits anything."""

    dead_zone: float = 0.0  # length of an input up to which the loop takes it for rest, in [0, 1)
    # (n,) or one for all joints, rad/s (m/s where a joint slides). What would be faster is slowed down in its
    # direction
    speed: FloatArray | float = np.inf

    def is_push(self, u: FloatArray) -> BoolArray:
        """Whether inputs (..., d) are more than rest, (...)."""
        return np.linalg.norm(u, axis=-1) > self.dead_zone

    def slowed(self, action: FloatArray) -> FloatArray:
        """Actions (..., n) as the loop lets the arm move."""
        excess = np.abs(action) / self.speed
        return action / np.maximum(excess.max(axis=-1, keepdims=True), 1.0)


UNLIMITED: Final = LoopLimits()  # no loop between the person and the arm


Foresight = Callable[[FloatArray, Context, Controller, Sequence[int], float], Pose]
"""Inputs (K, d), held in a context for a time, s, to poses (M, K) of the tool in M modes of the controller.
An input of zero leaves the tool where it is."""


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
class KnowsTheArm(Imagination):
    """The ``Psi(s + phi(f(u, c), c) dt)`` of equation 24: they know exactly what each input does."""

    def __init__(
        self,
        chain: Chain,  # the arm; only its first tool counts
        limits: LoopLimits,
    ) -> None:
        self._chain = chain
        self._limits = limits

    def reset(self) -> None:
        """Nothing was learned."""

    def saw(self, moment: Moment) -> None:
        """Nothing is learned."""

    def foresight(self, rng: np.random.Generator) -> Foresight:
        """The same as ever."""
        return self.expected

    def expected(
        self,
        inputs: FloatArray,
        context: Context,
        controller: Controller,
        modes: Sequence[int],
        horizon_s: float,
    ) -> Pose:
        """Poses to which the controller takes the tool."""
        actions = np.stack(
            [controller.action(controller.latent(inputs, context, m), context, m) for m in modes]
        )
        # The arm of a person who lets go stands still, whatever phi(0, c) is.
        actions[:, ~self._limits.is_push(inputs)] = 0.0
        # One call over all modes: (M, K, n).
        return self._chain.forward(context.state + horizon_s * self._limits.slowed(actions))


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
        """An input of length 1 at most, and whether the person switches to the next mode."""
