"""`latentarm robots`: what is known of a robot."""

import json as json_format
from typing import Annotated

from tyro.conf import Positional, arg

from latentarm.commands.options import EndEffector, Json, LimitsFile
from latentarm.commands.output import print_renderables


def robots(
    robot: Annotated[
        Positional[str | None],
        arg(metavar="ROBOT", help="One robot, by name or path; all known ones without."),
    ] = None,
    end_effector: EndEffector = None,
    limits: LimitsFile = None,
    json: Json = False,
) -> int:
    """List the robots, or show one: joints, limits and end-effector.

    For example: latentarm robots panda
    """
    from latentarm.commands.robot_sheet_body import describe, sheets

    if json:
        print(json_format.dumps(describe(robot, end_effector, limits), indent=2))
    else:
        print_renderables(*sheets(robot, end_effector, limits))
    return 0
