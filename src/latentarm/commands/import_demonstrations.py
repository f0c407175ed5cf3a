"""`latentarm import`: recordings in, a native dataset out."""

from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import LimitsFile, RobotName
from latentarm.commands.output import note, print_renderables, say, show
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.runs.options import EndEffector, Json


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
    *,
    options: ImportOptions,
    json: Json = False,
) -> int:
    """Turn recorded demonstrations into a native dataset (LeRobotDataset v3.0).

    For example: latentarm import panda_pour_coffee.npz pour
    """
    from latentarm.commands.inspect import import_table
    from latentarm.demonstrations.importers.importing import import_to
    from latentarm.demonstrations.summary import summarise
    from latentarm.robots.catalogue import load_robot
    from latentarm.robots.limits_file import read_limits
    from latentarm.robots.notices import notices

    arm = load_robot(robot, end_effector, None if limits is None else read_limits(limits))
    note(notices(arm))
    demonstrations = import_to(source, destination, arm, options)
    write_options(destination, "import")
    note(demonstrations.warnings)
    if json:
        show(summarise(demonstrations, arm).rows(), json)
        for subject, decision in demonstrations.import_record.items():
            say(f"{subject}: {decision}", json)
    else:
        print_renderables(import_table(demonstrations.import_record))
    say(
        f"{len(demonstrations.episodes)} episodes of {demonstrations.dof} joints are in {destination}/.", json
    )
    return 0
