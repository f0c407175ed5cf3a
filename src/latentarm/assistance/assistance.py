"""Help by the robot: the base class of every kind, and its factory."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Protocol, Self, final

from latentarm.core.types import FloatArray


@final
@dataclass(frozen=True, eq=False)
class Contribution:
    """The robot's part of the motion at one moment: ``a = (1 - alpha) a_h + (alpha + added) a_r``.

    Raises:
        ValueError: a share is not in [0, 1].
    """

    action: FloatArray  # (n,), the assistive action ``a_r``, rad/s
    alpha: float  # how much of it takes the place of the person's action, in [0, 1]: the alpha of equation 2
    added: float = 0.0  # how much of it is added to the person's action, in [0, 1]

    def __post_init__(self) -> None:
        for share in (self.alpha, self.added):
            if not 0.0 <= share <= 1.0:
                raise ValueError(f"an arbitration of {share} is not in [0, 1]")

    def with_person(self, action_human: FloatArray) -> FloatArray:
        """The action of both, rad/s, where the person's is ``a_h`` (n,), rad/s."""
        return (1.0 - self.alpha) * action_human + (self.alpha + self.added) * self.action


class Assistance(ABC):
    """How the robot helps towards the goals that it believes in; stateless.

    The loop asks once per step, and executes no more than its safety filters let through. The belief is that
    of `latentarm.assistance.belief`, updated by a rule of its own.
    """

    @property
    @abstractmethod
    def acts_at_rest(self) -> bool:
        """Whether the robot moves while the person gives no input."""

    @abstractmethod
    def contribution(
        self, u: FloatArray, action_human: FloatArray, state: FloatArray, belief: FloatArray
    ) -> Contribution:
        """The robot's action now.

        The person's input ``u`` is (d,), their action ``a_h`` (n,), rad/s (zero where the input is), the
        state (n,), rad, and the belief over goals (G,).
        """

    @abstractmethod
    def over(self, goals: FloatArray) -> Self:
        """The same help after its goals have moved to ``goals`` (G, n), rad."""

    @abstractmethod
    def bound_rad(self, given: Contribution, state: FloatArray, belief: FloatArray, sigma_h: float) -> float:
        """Radius of the ball about the likeliest goal that the help keeps the arm near (equation 14).

        ``given.alpha`` is above 0, and no input of the person exceeds ``sigma_h``, rad/s. NaN where no bound
        is known.
        """


class AssistanceRule(Protocol):
    """Makes an `Assistance` for given goals, such as a class of them with its parameters bound."""

    def __call__(self, goals: FloatArray) -> Assistance:
        """Help towards goals (G, n), rad."""
        ...
