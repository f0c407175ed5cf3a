"""The user's statements about demonstrations to import."""

from dataclasses import dataclass
from typing import Annotated, Literal, final

from tyro.conf import arg

from latentarm.demonstrations.gripper import GripperStart
from latentarm.demonstrations.timing import Gaps

TimeUnit = Literal["s", "ms", "us", "ns"]
ActionChoice = Literal["known", "joint_velocity", "joint_position"]


@final
@dataclass(frozen=True)
class ImportOptions:
    """The user's statements about a file; all are optional. `latentarm import --help` lists the same.

    Episodes are named as in a CSV file, ``demo_0`` and so on in HDF5 files, by the file's name in a folder of
    files, else by their number from 0.
    """

    rate_hz: Annotated[float | None, arg(help="Sampling rate, if the file does not give it.")] = None
    instruction: Annotated[str | None, arg(help="What was done, in words, if the file does not say.")] = None
    actions: Annotated[
        ActionChoice,
        arg(help="Use recorded actions only if the file says what they are, or as you state here."),
    ] = "known"
    units: Annotated[
        tuple[str, ...],
        arg(
            metavar="UNIT|JOINT=UNIT",
            help="Units of the positions: rad, deg or normalized (-100 to 100 over each joint's range).",
        ),
    ] = ()
    joints: Annotated[
        tuple[str, ...],
        arg(
            metavar="COLUMN|JOINT=COLUMN",
            help="Columns by name or number from 0, in the robot's order; matched by name by default.",
        ),
    ] = ()
    gripper: Annotated[
        str | None, arg(metavar="COLUMN", help="The gripper's column; found by name by default.")
    ] = None
    gripper_starts: Annotated[
        GripperStart | None,
        arg(help="How the gripper begins, if the file only says when it was toggled; open by default."),
    ] = None
    recorded_on: Annotated[
        str | None,
        arg(metavar="NAME", help="What the file calls the robot, if that is another name for --robot."),
    ] = None
    clip_rad: Annotated[
        float, arg(help="Move positions up to this far outside a joint's limits to the limit, rad.")
    ] = 0.0
    leave_out: Annotated[
        tuple[str, ...], arg(metavar="EPISODE", help="Episodes that are not imported, by name.")
    ] = ()
    gaps: Annotated[
        Gaps,
        arg(
            help="What becomes of episodes with gaps: each part an episode, or motion across taken for even."
        ),
    ] = "refuse"
    resample_hz: Annotated[
        float | None, arg(help="Bring all episodes to this rate, joints by linear interpolation.")
    ] = None
    time_unit: Annotated[
        TimeUnit | None, arg(help="Unit of a CSV file's timestamps; known from their spacing by default.")
    ] = None
    topic: Annotated[str | None, arg(help="Topic of a bag's joints, if it has several.")] = None
