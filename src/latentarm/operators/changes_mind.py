"""A simulated person who wants something else at first (section 8.2)."""

from typing import final

import numpy as np

from latentarm.control.controller import Controller
from latentarm.errors import UserError
from latentarm.operators.operator import Operator
from latentarm.types import Context, Input, Pose


@final
class ChangesMind(Operator):
    """A simulated person who steers towards another pose until they change their mind.

    An input that is held at that moment is held until the inner operator decides anew.

    Args:
        inner: how the simulated person steers.
        first_target: the pose that they want the tool at to begin with.
        after_s: how long, from the start of each drive, s; 0 wants the true target all along.
        period_s: time between calls of `act`, s.

    Raises:
        UserError: a time is not finite, or the period is not positive or the other time negative.
    """

    def __init__(self, inner: Operator, first_target: Pose, after_s: float, period_s: float = 0.05) -> None:
        if not 0 < period_s < np.inf:
            raise UserError(f"The time between inputs must be positive and finite, not {period_s} s.")
        if not 0 <= after_s < np.inf:
            raise UserError(f"A change of mind must come after zero or more, finite seconds, not {after_s}.")
        self._inner = inner
        self._first_target = first_target
        self._first_calls = round(after_s / period_s)
        self._calls = 0

    def reset(self) -> None:
        """Want the first target again."""
        self._inner.reset()
        self._calls = 0

    def act(
        self, context: Context, controller: Controller, mode: int, target: Pose, rng: np.random.Generator
    ) -> Input:
        """The inner operator's input, towards the first target or towards ``target``."""
        wanted = self._first_target if self._calls < self._first_calls else target
        self._calls += 1
        return self._inner.act(context, controller, mode, wanted, rng)
