"""`latentarm import`: recordings in, a native dataset out."""

from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import EndEffector, Json, LimitsFile, RobotName
from latentarm.commands.output import note, say, show


def import_demonstrations(
    source: Annotated[
        Positional[Path], arg(metavar="SRC", help=".npz, .csv, .hdf5, or a LeRobot v3.0 folder.")
    ],
    destination: Annotated[Positional[Path], arg(metavar="DST", help="New folder for the dataset.")],
    robot: RobotName = "panda",
    end_effector: EndEffector = None,
    limits: LimitsFile = None,
    rate_hz: Annotated[float | None, arg(help="Sampling rate, for a file that does not say it.")] = None,
    instruction: Annotated[
        str | None, arg(help="What was done, in words, for a file that does not say it.")
    ] = None,
    actions: Annotated[
        Literal["known", "joint_velocity"],
        arg(
            help="Keep recorded actions only where they are known to be joint velocities, or take your word."
        ),
    ] = "known",
    json: Json = False,
) -> int:
    """Turn recorded demonstrations into a native dataset (LeRobotDataset v3.0).

    For example: latentarm import panda_pour_coffee.npz pour
    """
    from latentarm.demonstrations.importing import import_to
    from latentarm.experiments.inspection import summary
    from latentarm.robots.catalogue import load_robot
    from latentarm.robots.limits_file import read_limits
    from latentarm.robots.notices import notices

    arm = load_robot(robot, end_effector, None if limits is None else read_limits(limits))
    note(notices(arm))
    demonstrations = import_to(
        source,
        destination,
        arm,
        rate_hz=rate_hz,
        task=instruction,
        actions=actions,
    )
    write_options(destination, "import")
    if json:
        show(summary(demonstrations).rows(), json)
    say(
        f"{len(demonstrations.episodes)} episodes of {demonstrations.dof} joints are in {destination}/.", json
    )
    return 0
