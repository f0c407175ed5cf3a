"""`latentarm import`: recordings in, a native dataset out."""

from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import EndEffector, Json, LimitsFile, RobotName
from latentarm.commands.output import note, print_renderables, say, show


def import_demonstrations(
    source: Annotated[
        Positional[Path],
        arg(
            metavar="SRC",
            help=".npz, .csv (.gz), .hdf5, .bag, .mcap, .db3, a folder of these, or of LeRobot or HARMONIC.",
        ),
    ],
    destination: Annotated[Positional[Path], arg(metavar="DST", help="New folder for the dataset.")],
    robot: RobotName = "panda",
    end_effector: EndEffector = None,
    limits: LimitsFile = None,
    rate_hz: Annotated[float | None, arg(help="Sampling rate, if the file does not give it.")] = None,
    instruction: Annotated[str | None, arg(help="What was done, in words, if the file does not say.")] = None,
    actions: Annotated[
        Literal["known", "joint_velocity", "joint_position"],
        arg(help="Use recorded actions only if the file says what they are, or as you state here."),
    ] = "known",
    units: Annotated[
        tuple[str, ...],
        arg(
            metavar="UNIT|JOINT=UNIT",
            help="Units of the positions: rad, deg or normalized (-100 to 100 over each joint's range).",
        ),
    ] = (),
    joints: Annotated[
        tuple[str, ...],
        arg(
            metavar="COLUMN|JOINT=COLUMN",
            help="Columns by name or number from 0, in the robot's order; matched by name by default.",
        ),
    ] = (),
    gripper: Annotated[
        str | None, arg(metavar="COLUMN", help="The gripper's column; found by name by default.")
    ] = None,
    gripper_starts: Annotated[
        Literal["open", "closed"] | None,
        arg(help="How the gripper begins, if the file only says when it was toggled; open by default."),
    ] = None,
    recorded_on: Annotated[
        str | None,
        arg(metavar="NAME", help="What the file calls the robot, if that is another name for --robot."),
    ] = None,
    clip_rad: Annotated[
        float, arg(help="Move positions up to this far outside a joint's limits to the limit, rad.")
    ] = 0.0,
    leave_out: Annotated[
        tuple[str, ...], arg(metavar="EPISODE", help="Episodes that are not imported, by name.")
    ] = (),
    gaps: Annotated[
        Literal["refuse", "split", "keep"],
        arg(
            help="What becomes of episodes with gaps: each part an episode, or motion across taken for even."
        ),
    ] = "refuse",
    resample_hz: Annotated[
        float | None, arg(help="Bring all episodes to this rate, joints by linear interpolation.")
    ] = None,
    time_unit: Annotated[
        Literal["s", "ms", "us", "ns"] | None,
        arg(help="Unit of a CSV file's timestamps; known from their spacing by default."),
    ] = None,
    topic: Annotated[str | None, arg(help="Topic of a bag's joints, if it has several.")] = None,
    json: Json = False,
) -> int:
    """Turn recorded demonstrations into a native dataset (LeRobotDataset v3.0).

    For example: latentarm import panda_pour_coffee.npz pour
    """
    from latentarm.commands.inspect import import_table, summary
    from latentarm.demonstrations.importing import import_to
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
        units=units,
        joints=joints,
        gripper=gripper,
        gripper_starts=gripper_starts,
        recorded_on=recorded_on,
        clip_rad=clip_rad,
        leave_out=leave_out,
        gaps=gaps,
        resample_hz=resample_hz,
        time_unit=time_unit,
        topic=topic,
    )
    write_options(destination, "import")
    note(demonstrations.warnings)
    if json:
        show(summary(demonstrations).rows(), json)
        for subject, decision in demonstrations.import_record.items():
            say(f"{subject}: {decision}", json)
    else:
        print_renderables(import_table(demonstrations.import_record))
    say(
        f"{len(demonstrations.episodes)} episodes of {demonstrations.dof} joints are in {destination}/.", json
    )
    return 0
