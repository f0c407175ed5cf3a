"""The tasks of section 8.1 by name."""

from collections.abc import Callable
from typing import Final

from latentarm_research.tasks.planar.circle import Circle
from latentarm_research.tasks.planar.motion import PlanarMotion
from latentarm_research.tasks.planar.reach import ReachRegion
from latentarm_research.tasks.planar.rotate import Rotate
from latentarm_research.tasks.planar.sine import Sine

MOTIONS: Final[dict[str, Callable[..., PlanarMotion]]] = {
    "sine": Sine,
    "rotate": Rotate,
    "circle": Circle,
    "reach": ReachRegion,
}
