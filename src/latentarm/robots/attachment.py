"""What an arm can carry in place of its bare hand, and what that can do."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.scene.interior import Interior

TINES_BODY: Final = "tines"
"""Name of the body of an attachment's tines in the robot's model; its frame is the tool's."""

ATTACHMENT_BODY: Final = "attachment"
"""Name of the body of its other solids; its frame is the tool's."""

ATTACHED_BODIES: Final = (ATTACHMENT_BODY, TINES_BODY)


@final
@dataclass(frozen=True, eq=False)
class Tines:
    """Parallel tines; z of the tool's frame points where they do, y lies across them.

    Attributes:
        tips: (K, 3), in the tool's frame, m.
        length_m: of each tine, from its tip back, m.
        edge_half_m: half of the edge that cuts. It lies on the y axis of the tool's frame, across all tips.
    """

    tips: FloatArray
    length_m: float
    edge_half_m: float


@final
@dataclass(frozen=True, eq=False)
class Vessel:
    """A container that is fixed to the tool.

    Attributes:
        frame: (4, 4), its own frame, with z out of its opening, in the tool's.
        interior: the room in it, in its own frame.
    """

    frame: FloatArray
    interior: Interior

    def pose(self, tool: Pose) -> Pose:
        """Where its frame is, with the tool at a pose."""
        return Pose(tool.position + tool.rotation @ self.frame[:3, 3], tool.rotation @ self.frame[:3, :3])


@final
@dataclass(frozen=True, eq=False)
class Attachment:
    """What an arm carries in place of its bare hand.

    Attributes:
        name: what a person would call it.
        tines: what it stabs and cuts with, or None.
        vessel: the container that it is, or None.
    """

    name: str
    tines: Tines | None = None
    vessel: Vessel | None = None
