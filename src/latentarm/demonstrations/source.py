"""The raw contents of a file of demonstrations."""

from dataclasses import dataclass
from typing import Literal, final

from latentarm.types import Demonstrations

ActionKind = Literal["velocity", "position", "unknown"]


@final
@dataclass(frozen=True)
class SourceData:
    """Demonstrations as a file has them: all its columns, in its order and its units.

    Attributes:
        demonstrations: the states' columns stand as joints, under the file's names or made-up ones;
            ``robot`` is what the file calls the robot, or "".
        layout: the kind of file, for people.
        in_rad: whether the file, or its layout, says that positions are in rad.
        actions: what the file's actions are, as far as it says so.
    """

    demonstrations: Demonstrations
    layout: str
    in_rad: bool
    actions: ActionKind = "velocity"
