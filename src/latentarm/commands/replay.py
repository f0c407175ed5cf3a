"""`latentarm replay`: an incident file in, the same commands out, or where they differ."""

import json as json_format
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from latentarm.commands.output import say
from latentarm.runs.options import Json


def replay(
    file: Annotated[
        Positional[Path],
        arg(metavar="FILE", help="An incident file, or the folder that has them: its newest file."),
    ],
    json: Json = False,
) -> int:
    """Decide again what an arm was commanded on the page, and compare every command to the bit.

    Exit code 1 where one differs. For example: latentarm replay teleop/incidents
    """
    from latentarm.web.arm_process.replay import ELSEWHERE_RAD_S, replay

    found = replay(file)
    code = 0 if found["same"] else 1
    if json:
        print(json_format.dumps(found, indent=2))
        return code
    say(f"Began at {found['began_utc']} with {found['then']}.", json)
    for time_s, what in found["happened"]:
        say(f"{time_s:10.2f} s  {what}", json)
    if not found["complete"]:
        say("The file is not closed: the program was killed, or still runs.", json)
    say(f"{found['agreed']:,} of {found['ticks']:,} ticks gave the same command, to the bit.", json)
    if (first := found["first"]) is not None:
        say(f"{first['call']} differs at {first['time_s']:.3f} s, tick {first['tick']:,}:", json)
        say(f"  then {first['then']}\n  now  {first['now']}", json)
        say(f"The largest difference of a velocity is {found['largest_rad_s']:.3g} rad/s.", json)
    if found["here"] != found["then"]:
        say(f"Here: {found['here']}. Up to {ELSEWHERE_RAD_S:g} rad/s may differ, then.", json)
    return code
