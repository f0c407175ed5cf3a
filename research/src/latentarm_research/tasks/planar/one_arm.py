"""What the tasks of one planar arm have in common."""

from abc import ABC

from latentarm.core.types import FloatArray
from latentarm.robots.planar import planar
from latentarm_research.tasks.planar.motion import DESIGN, Design, PlanarMotion
from latentarm_research.tasks.planar.resolved_rate import Constraint, ToolPlace, curled


class OneArm(PlanarMotion, ABC):
    """One arm of 5 joints, curled, whose tool's place is what the task constrains."""

    closing = (0, 1)  # the first two joints

    def __init__(self, design: Design = DESIGN) -> None:
        super().__init__(planar(5), design)

    @property
    def nominal(self) -> FloatArray:
        """See `PlanarMotion`."""
        return curled(self.robot)

    @property
    def constraint(self) -> Constraint:
        """The tool's place."""
        return ToolPlace(self.robot)
