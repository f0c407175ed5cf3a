"""`latentarm replay`: an incident file in, the same commands out, or where they differ."""

import json as json_format
from pathlib import Path
from typing import Annotated, Any

from tyro.conf import Positional, arg

from latentarm.commands.output import say
from latentarm.runs.options import Json


def replay(
    file: Annotated[
        Positional[Path],
        arg(
            metavar="FILE",
            help="What `latentarm report` wrote, an incident file, or a folder of them: its newest one.",
        ),
    ],
    json: Json = False,
) -> int:
    """Decide again what an arm was commanded on the page, and compare every command to the bit.

    Exit code 1 where one differs. For example: latentarm replay report.zip
    """
    from latentarm.web.arm_process.replay import replay_all

    found = replay_all(file)
    if json:
        print(json_format.dumps(found, indent=2))
    else:
        for one in found.values():
            _tell(one)
    return 0 if all(one["same"] for one in found.values()) else 1


def _tell(found: dict[str, Any]) -> None:
    from latentarm.web.arm_process.replay import ELSEWHERE_RAD_S

    say(f"Began at {found['began_utc']} with {found['then']}.", json=False)
    for time_s, what in found["happened"]:
        say(f"{time_s:10.2f} s  {what}", json=False)
    if not found["complete"]:
        say("The file is not closed: the program was killed, or still runs.", json=False)
    say(f"{found['agreed']:,} of {found['ticks']:,} ticks gave the same command, to the bit.", json=False)
    if (first := found["first"]) is not None:
        say(f"{first['call']} differs at {first['time_s']:.3f} s, tick {first['tick']:,}:", json=False)
        say(f"  then {first['then']}\n  now  {first['now']}", json=False)
        say(f"The largest difference of a velocity is {found['largest_rad_s']:.3g} rad/s.", json=False)
    if found["here"] != found["then"]:
        say(f"Here: {found['here']}. Up to {ELSEWHERE_RAD_S:g} rad/s may differ, then.", json=False)
