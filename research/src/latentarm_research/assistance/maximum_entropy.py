"""The belief of a person who is noisily optimal over the way that remains: Javdani et al., 2018.

"Shared autonomy via hindsight optimization for teleoperation and teaming", after maximum-entropy
inverse optimal control.
"""

from collections.abc import Sequence
from typing import Unpack, final

import numpy as np

from latentarm.assistance.belief import Belief, BeliefOptions, log_choice, not_negative, positive
from latentarm.core.types import FloatArray


@final
class MaximumEntropyBelief(Belief):
    """A person who weighs what an input leaves to be done: ``log P(u | s, g) = V_g(s) - Q_g(s, u)``.

    Every rad of the way costs ``cost_per_rad``, less within ``near_rad`` of the goal, in proportion to
    the distance d. The cost-to-go of the straight way then has the closed form::

        V(d) = c d² / (2 delta)     for d <= delta
               c d - c delta / 2    beyond

    ``Q_g(s, u) = V(‖g - (s + a_h(u) tau)‖)`` is the cost-to-go after the look-ahead; what the look-ahead
    itself costs depends on the state alone and cancels. ``V_g(s) = -log Σ_{u' in U} exp(-Q_g(s, u'))``
    makes it a distribution over `alternatives`.

    Unlike in `BoltzmannBelief`, evidence does not grow with the distance to a goal. If all goals are within
    delta, the two rules are identical with beta = c / (2 delta): delta should therefore be
    wide enough to hold what is done at a goal, or stabbing and scooping there speak against it.

    Args:
        goals: (G, n), the goals' configurations, rad.
        cost_per_rad: c, 1/rad, in units of log probability; 0 learns nothing.
        near_rad: delta, rad.
        horizon_s: the look-ahead tau, s.
        options: see `Belief`.

    Raises:
        UserError: a parameter is not finite or out of its range.
    """

    def __init__(
        self,
        goals: FloatArray | Sequence[FloatArray],
        cost_per_rad: float = 20.0,
        near_rad: float = 0.5,
        horizon_s: float = 0.5,
        **options: Unpack[BeliefOptions],
    ) -> None:
        super().__init__(goals, horizon_s, **options)
        self.cost_per_rad = not_negative("cost_per_rad", cost_per_rad)
        self.near_rad = positive("near_rad", near_rad)

    def log_likelihood(self, state: FloatArray, actions: FloatArray) -> FloatArray:
        """``V_g(s) - Q_g(s, u)`` of one decision; see `Belief.log_likelihood`."""
        reached = state[..., None, :] + self.horizon_s * actions
        to_go = self.cost_to_go(np.linalg.norm(self.goals - reached[..., None, :], axis=-1))
        return log_choice(to_go[..., :1, :] - to_go)

    def cost_to_go(self, distance: FloatArray) -> FloatArray:
        """``V(d)`` for distances (...), rad, in units of log probability."""
        # Both branches as one: quadratic up to delta, then straight on at the slope that it has there.
        near = np.minimum(distance, self.near_rad)
        return self.cost_per_rad * (near * near / (2.0 * self.near_rad) + (distance - near))
