"""Options that several commands share."""

from pathlib import Path
from typing import Annotated

from tyro.conf import arg

from latentarm.alignment.contract import Seat
from latentarm.arms.catalogue import ARMS

_ARMS = ",".join(ARMS)
Arm = Annotated[
    str | None,
    arg(
        metavar=f"{{{_ARMS}}}",
        help="What moves; by default kinematic, and mujoco at a task with things, which only physics holds.",
    ),
]
AnyArm = Annotated[
    str | None,
    arg(
        metavar=f"{{{_ARMS},URL}}",
        help="What moves; by default kinematic, and mujoco at a task with things, which only physics holds. A"
        " real arm is named by its address, such as franka://172.16.0.2; see `latentarm guide your-arm`.",
    ),
]
RobotName = Annotated[
    str, arg(help="A robot's name (see `latentarm robots`) or the path of an MJCF or URDF file.")
]
JointSpeed = Annotated[
    float | None, arg(metavar="RAD_PER_S", help="Fastest that a joint may turn: 0.5 at most, and by default.")
]
LinkSpeed = Annotated[
    float | None,
    arg(metavar="M_PER_S", help="Fastest that any point of the arm may move: 0.25 at most, and by default."),
]
LimitsFile = Annotated[
    Path | None,
    arg(metavar="FILE", help="TOML or YAML file that states the robot's limits, see `latentarm guide arms`."),
]
ZonesFile = Annotated[
    Path | None,
    arg(
        metavar="FILE",
        help="TOML file of zones in which the arm is slow, such as about a face, of what it keeps out of,"
        " such as a table, and of what it grips, such as a cup; `latentarm guide zones.toml` prints one.",
    ),
]
Seated = Annotated[
    Seat | None,
    arg(
        help="Where a person without a profile sits: the stick is turned so that Right leads right and Up up"
        " or away in the page's first view. None leaves it as the model learned it, z = u."
    ),
]
