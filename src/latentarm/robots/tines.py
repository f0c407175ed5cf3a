"""The tines of a fork in place of the bare hand."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.core.types import FloatArray

TINES_BODY: Final = "tines"  # the tines' body in the robot's model; its frame is the tool's
HANDLE_BODY: Final = "attachment"  # the body of the fork's other solids; its frame is the tool's


@final
@dataclass(frozen=True, eq=False)
class Tines:
    """Parallel tines; z of the tool's frame points along them, y lies across them."""

    tips: FloatArray  # (K, 3), in the tool's frame, m
    length_m: float  # of each tine
    # half of the cutting edge, which lies on the y axis of the tool's frame, across all tips
    edge_half_m: float
