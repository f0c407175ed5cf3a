"""Attachments in place of the bare hand, and what each can do."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.scene.thing import Interior

TINES_BODY: Final = "tines"  # the tines' body in the robot's model; its frame is the tool's
ATTACHMENT_BODY: Final = "attachment"  # the body of its other solids; its frame is the tool's
ATTACHED_BODIES: Final = (ATTACHMENT_BODY, TINES_BODY)


@final
@dataclass(frozen=True, eq=False)
class Tines:
    """Parallel tines; z of the tool's frame points along them, y lies across them."""

    tips: FloatArray  # (K, 3), in the tool's frame, m
    length_m: float  # of each tine
    # half of the cutting edge, which lies on the y axis of the tool's frame, across all tips
    edge_half_m: float


@final
@dataclass(frozen=True, eq=False)
class Vessel:
    """A container fixed to the tool."""

    frame: FloatArray  # (4, 4), its frame in the tool's, with z out of its opening
    interior: Interior  # in its own frame

    def pose(self, tool: Pose) -> Pose:
        """The pose of its frame when the tool is at a pose."""
        return Pose(tool.position + tool.rotation @ self.frame[:3, 3], tool.rotation @ self.frame[:3, :3])


@final
@dataclass(frozen=True, eq=False)
class Attachment:
    """An attachment that an arm carries in place of its bare hand."""

    name: str
    tines: Tines | None = None  # its tines, or None
    vessel: Vessel | None = None  # the container, or None
