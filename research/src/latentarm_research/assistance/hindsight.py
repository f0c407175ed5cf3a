"""Hindsight optimisation: the person's action plus the help that is expected to lower their cost the most.

Javdani, Admoni, Pellegrinelli, Srinivasa and Bagnell, "Shared autonomy via hindsight optimization for
teleoperation and teaming", 2018.
"""

from typing import final

from latentarm.assistance.assistance import Contribution
from latentarm.core.types import FloatArray
from latentarm_research.assistance.expected_help import ExpectedHelp


@final
class HindsightOptimisation(ExpectedHelp):
    """``a = a_h + Σ_g b(g) a_g``: help is added to whatever the person does, and goes on when they let go.

    Made for the belief of `HindsightBelief`.
    """

    @property
    def acts_at_rest(self) -> bool:
        """Yes."""
        return True

    def contribution(
        self, u: FloatArray, action_human: FloatArray, state: FloatArray, belief: FloatArray
    ) -> Contribution:
        """All of the help is added."""
        return Contribution(self.action(action_human, state, belief), alpha=0.0, added=1.0)
