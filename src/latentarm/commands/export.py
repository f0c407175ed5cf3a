"""`latentarm export`: recorded drives in, a native dataset out."""

import json as json_format
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.options import Json
from latentarm.commands.output import print_renderables, say


def export(
    source: Annotated[
        Positional[Path],
        arg(metavar="JOURNAL|DIR", help="A journal of `teleop` or `drive --record`, or a folder of them."),
    ] = Path("teleop"),
    out: Annotated[
        Path | None,
        arg(metavar="DST", help="New folder for the dataset; without it the episodes are listed."),
    ] = None,
    episodes: Annotated[
        tuple[str, ...],
        arg(metavar="N|N-M", help="Numbers from the list, such as 1 3-5; all complete episodes by default."),
    ] = (),
    incomplete: Annotated[bool, arg(help="Export episodes that were cut short too.")] = False,
    json: Json = False,
) -> int:
    """List what was recorded, and export it to a native dataset (LeRobotDataset v3.0).

    For example: latentarm export teleop --episodes 1 3-5 --out eaten
    """
    from latentarm.commands.exporting_body import choose, describe, listing
    from latentarm.control.recordings import list_recordings, read_recordings

    recordings = list_recordings(source)
    if out is None:
        if json:
            print(json_format.dumps(describe(recordings), indent=2))
        else:
            print_renderables(listing(recordings))
            say("Nothing was exported: name a new folder with --out.", json)
        return 0
    from latentarm.demonstrations.dataset import write_dataset
    from latentarm.demonstrations.folders import check_vacant

    check_vacant(out)
    chosen = choose(recordings, episodes, source, incomplete=incomplete)
    write_dataset(read_recordings(chosen, source=str(source), incomplete=incomplete), out)
    write_options(out, "export")
    if json:
        print(json_format.dumps(describe(chosen), indent=2))
    say(f"{len(chosen)} of {len(recordings)} episodes are in {out}/.", json)
    left = sum(not recording.entry.complete for recording in recordings)
    if left and not incomplete and not episodes:
        say(f"{left} were cut short and were left out; --incomplete exports them too.", json)
    return 0
