"""`latentarm replay`: an incident file in, the same commands out, or where they differ."""

import json as json_format
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from latentarm.commands.options import Json
from latentarm.commands.output import say


def replay(
    file: Annotated[
        Positional[Path], arg(metavar="FILE", help="An incident file, from incidents/ of `teleop --out`.")
    ],
    json: Json = False,
) -> int:
    """Decide again what an arm was commanded on the page, and compare every command to the bit.

    Exit code 1 where a command differs. For example: latentarm replay teleop/incidents/20261125.incident.gz
    """
    from latentarm.web.arm_process.replay import ELSEWHERE_RAD_S, replay

    done = replay(file)
    if json:
        print(json_format.dumps({"same": done.same, **asdict(done)}, indent=2))
        return 0 if done.same else 1
    say(f"Driven from {done.began_utc} on, {' on '.join(done.recorded.values())}.", json)
    for time_s, what in done.happened:
        say(f"{time_s:10.2f} s  {what}", json)
    if not done.complete:
        say("The file was cut off here: the program was killed, or still runs.", json)
    if done.here != done.recorded:
        most = f"differences of up to {ELSEWHERE_RAD_S:g} rad/s are taken as none"
        say(f"This is another platform ({' on '.join(done.here.values())}): {most}.", json)
    if done.first is None:
        say(f"All {done.ticks:,} ticks gave the same commands, to the bit.", json)
    else:
        first = f"{done.first['call']} at tick {done.first['tick']:,}, {done.first['time_s']:.3f} s"
        say(f"{done.agreed:,} of {done.calls:,} calls agree to the bit, up to {first}:", json)
        say(f"  then {done.first['then']}\n  now  {done.first['now']}", json)
        say(f"The largest difference of a velocity is {done.largest_rad_s:.3g} rad/s.", json)
    return 0 if done.same else 1
