"""Types of options whose choices are the names in a catalogue, plug-ins included."""

from typing import TYPE_CHECKING, Literal

from latentarm.arms.catalogue import ARMS
from latentarm.assistance.catalogue import BELIEFS

if TYPE_CHECKING:
    ArmName = str
    BeliefName = str
else:
    ArmName = Literal[tuple(ARMS)]
    BeliefName = Literal[tuple(BELIEFS)]
