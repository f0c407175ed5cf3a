"""The tasks of section 8.1 by name."""

from typing import Final, Protocol

from latentarm_research.tasks.planar.circle import Circle
from latentarm_research.tasks.planar.motion import Design, PlanarMotion
from latentarm_research.tasks.planar.reach import ReachRegion
from latentarm_research.tasks.planar.rotate import Rotate
from latentarm_research.tasks.planar.sine import Sine


class MakesMotion(Protocol):
    """Makes a task, as the study has it or in another design."""

    def __call__(self, design: Design = ...) -> PlanarMotion:
        """The task."""
        ...


MOTIONS: Final[dict[str, MakesMotion]] = {
    "sine": Sine,
    "rotate": Rotate,
    "circle": Circle,
    "reach": ReachRegion,
}
