"""The room inside containers."""

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class Interior:
    """The room inside a container: an upright cylinder in its frame."""

    radius_m: float
    bottom_m: float  # lowest height in the thing's frame
    top_m: float  # height of the rim in the thing's frame
