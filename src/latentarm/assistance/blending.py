"""The robot's action (equation 3), and its blending with the person's (equations 2 and 10)."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray


def blend(action_human: FloatArray, action_assist: FloatArray, alpha: float | FloatArray) -> FloatArray:
    """``a = (1 - alpha) a_h + alpha a_r`` (equation 2; with equation 3 it is equation 10).

    Actions are (..., m), rad/s; an alpha (...,) of 0 leaves all to the person, of 1 all to the robot.
    """
    share = np.asarray(alpha)[..., None]
    return (1.0 - share) * action_human + share * action_assist


class Arbitration(ABC):
    """Decides how much the robot helps."""

    @property
    @abstractmethod
    def acts_at_rest(self) -> bool:
        """Whether the robot helps a person who gives no input. Where it does not, ``alpha`` is zero there."""

    @abstractmethod
    def alpha(self, u: FloatArray, belief: FloatArray) -> FloatArray:
        """The arbitration of equation 2 (...,), in [0, 1]; zero for an input that is not finite.

        The person's input is (..., d), the belief (..., G).
        """


@final
@dataclass(frozen=True)
class FixedAlpha(Arbitration):
    """The same alpha whatever the robot believes, faded out as the person lets go of the input.

    The paper's alpha (equation 10) does not fade, and it names no value but 0.5, in equations 12 to 14 for
    simplicity. The default is ours and lower: it leaves most to the person.

    Attributes:
        value: alpha in [0, 1] at inputs of ``full_at`` and more.
        full_at: ‖u‖ from which help is full; below, alpha shrinks in proportion, to zero at zero.

    Raises:
        UserError: a parameter is out of its range.
    """

    value: float = 0.15
    full_at: float = 0.3

    def __post_init__(self) -> None:
        _check_share("arbitration alpha", self.value)
        _check_full_at(self.full_at)

    @property
    def acts_at_rest(self) -> bool:
        return False

    def alpha(self, u: FloatArray, belief: FloatArray) -> FloatArray:
        """Constant, times ‖u‖ / full_at where that is below one; see `Arbitration.alpha`."""
        return self.value * _fade(u, self.full_at)


@final
@dataclass(frozen=True)
class ConfidenceAlpha(Arbitration):
    """More help with more confidence, faded out as the person lets go of the input.

    After Dragan and Srinivasa (2013). Confidence is ``(max b - 1/G) / (1 - 1/G)``: 0 where all goals are
    as likely, 1 where one is certain; 1 where there is one goal only. A belief's floor f keeps it at
    ``1 - f G`` or below.

    Attributes:
        most: alpha in [0, 1] where the robot is sure and the input is ``full_at`` or more.
        unsure_below: confidence in [0, 1) up to which there is no help.
        sure_above: confidence in (unsure_below, 1] from which help is at its most; linear between.
        full_at: ‖u‖ from which help is full; below, alpha shrinks in proportion, to zero at zero.

    Raises:
        UserError: a parameter is out of its range.
    """

    most: float = 0.5
    unsure_below: float = 0.2
    sure_above: float = 0.8
    full_at: float = 0.3

    def __post_init__(self) -> None:
        _check_share("most of the arbitration alpha", self.most)
        if not 0 <= self.unsure_below < self.sure_above <= 1:
            raise UserError(
                "The arbitration's confidences must be in [0, 1], unsure_below less than sure_above, "
                f"not {self.unsure_below} and {self.sure_above}."
            )
        _check_full_at(self.full_at)

    @property
    def acts_at_rest(self) -> bool:
        return False

    def alpha(self, u: FloatArray, belief: FloatArray) -> FloatArray:
        """Grows with the confidence, and with ‖u‖ up to ``full_at``; see `Arbitration.alpha`."""
        sure = (confidence(belief) - self.unsure_below) / (self.sure_above - self.unsure_below)
        return self.most * np.minimum(np.maximum(sure, 0.0), 1.0) * _fade(u, self.full_at)


def confidence(belief: FloatArray) -> FloatArray:
    """How sure the robot is, ``(max b - 1/G) / (1 - 1/G)`` (...,); 1 where there is one goal only."""
    count = belief.shape[-1]
    if count == 1:
        return np.ones(belief.shape[:-1])
    sure = (count * np.maximum.reduce(belief, axis=-1) - 1.0) / (count - 1.0)
    return np.minimum(np.maximum(sure, 0.0), 1.0)


def _fade(u: FloatArray, full_at: float) -> FloatArray:
    """‖u‖ / full_at up to one, (...,); zero for an input that is not finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        size = np.sqrt(np.vecdot(u, u))
        return np.where(np.isfinite(size), np.minimum(size / full_at, 1.0), 0.0)


def _check_share(name: str, value: float) -> None:
    if not 0 <= value <= 1:
        raise UserError(f"The {name} must be in [0, 1], not {value}.")


def _check_full_at(full_at: float) -> None:
    if not 0 < full_at <= 1:
        raise UserError(f"The input at which help is full must be in (0, 1], not {full_at}.")


def assistive_action(
    state: FloatArray, belief: FloatArray, goals: FloatArray, gain_per_s: float = 1.0
) -> FloatArray:
    """``a_r = k Σ_g b(g) (g - s)`` (..., n), rad/s (equation 3): towards goals (G, n) by their probability.

    The paper's ``g - s`` is a displacement; the gain k, 1/s, makes it a velocity.
    """
    return gain_per_s * (belief @ goals - state * belief.sum(axis=-1, keepdims=True))
