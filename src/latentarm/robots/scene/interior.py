"""The room inside containers."""

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class Interior:
    """The room inside a container: an upright cylinder in its frame.

    Attributes:
        radius_m: m.
        bottom_m: lowest height in the thing's frame, m.
        top_m: height of the rim in the thing's frame, m.
    """

    radius_m: float
    bottom_m: float
    top_m: float
