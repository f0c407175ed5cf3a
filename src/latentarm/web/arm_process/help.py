"""How much the robot helps, in levels that a person chooses while the arm is driven."""

from typing import Final, final

from latentarm.assistance.blending import Arbitration, ConfidenceAlpha, FixedAlpha
from latentarm.core.call_log import CallLog, logged
from latentarm.core.types import FloatArray
from latentarm.web.protocol.orders import HelpLevel

USUAL_HELP: Final[HelpLevel] = "medium"

LEVELS: Final[dict[HelpLevel, Arbitration]] = {
    "off": FixedAlpha(0.0),
    "low": ConfidenceAlpha(0.05),
    "medium": ConfidenceAlpha(0.1),
    "high": ConfidenceAlpha(0.3),
}
"""Help grows with the robot's confidence, and stays at zero until the robot can tell what the person wants.

Measured by ``latentarm measure help``: ``medium`` halves the mean time to goals that the robot knows, and
lets as many reach something else as without help (14 of 15 simulated drives); ``high`` takes a little less
time, and keeps most people from anything else."""


@final
class Help(Arbitration):
    """Help whose level can be changed while the arm is driven."""

    def __init__(self) -> None:
        self.calls: CallLog | None = None  # records changes; None for nowhere
        self.level: HelpLevel = "off"

    @logged
    def choose(self, level: HelpLevel) -> None:
        self.level = level

    @property
    def on(self) -> bool:
        return self.level != "off"

    @property
    def acts_at_rest(self) -> bool:
        """No: an arm whose person lets go stands still."""
        return False

    def alpha(self, u: FloatArray, belief: FloatArray) -> FloatArray:
        """The level's, or zero; see `Arbitration.alpha`."""
        return LEVELS[self.level].alpha(u, belief)
