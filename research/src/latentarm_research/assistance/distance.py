"""Belief from progress towards each goal.

Dragan and Srinivasa, "A policy-blending formalism for shared control", 2013.
"""

from collections.abc import Sequence
from typing import Unpack, final

import numpy as np

from latentarm.assistance.belief import Belief, BeliefOptions, not_negative
from latentarm.core.types import FloatArray


@final
class DistanceBelief(Belief):
    """A person whose whole motion so far leads efficiently to the goal.

    ::

        b(g) ∝ exp(-beta (‖g - s_t‖ - ‖g - s_0‖)) b_0(g)

    that is, a goal gains by how much nearer the person has brought the arm. Taken step by step, an action
    is weighed by what it alone would change over one period::

        log P(u | s, g) = -beta (‖g - (s + a_h(u) period)‖ - ‖g - s‖)

    These steps add up to the formula above where the arm does what the person commands, at any rate of
    the loop; when the robot helps, its own motion is not evidence. Alternatives are not
    considered. Someone who has arrived and moves away from every goal alike loses belief in the
    goal that they are at: they leave it by more than they leave the others.

    Args:
        goals: (G, n), the goals' configurations, rad.
        beta: rationality, 1/rad; 0 learns nothing.
        options: see `Belief`; the look-ahead is one period.

    Raises:
        UserError: a parameter is not finite or out of its range.
    """

    def __init__(
        self,
        goals: FloatArray | Sequence[FloatArray],
        beta: float = 5.0,
        **options: Unpack[BeliefOptions],
    ) -> None:
        super().__init__(goals, **options)
        self.beta = not_negative("beta", beta)

    def log_likelihood(self, state: FloatArray, actions: FloatArray) -> FloatArray:
        """``log P(u | s, g)`` of one period's motion; see `Belief.log_likelihood`."""
        before = self.goals - state[..., None, :]
        after = before - self.horizon_s * actions[..., :1, :]
        return -self.beta * (np.linalg.norm(after, axis=-1) - np.linalg.norm(before, axis=-1))
