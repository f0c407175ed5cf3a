"""`latentarm export`: recorded drives in, a native dataset out."""

import json as json_format
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text
from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.output import print_renderables, say
from latentarm.core.errors import UserError
from latentarm.core.untrusted.terminal import visible
from latentarm.demonstrations.folders import check_vacant
from latentarm.runs.options import Json

if TYPE_CHECKING:
    from latentarm.recordings.folder import NumberedEpisode

UNKNOWN = "–"
_BY = ("person", "run", "run_fingerprint", "profile", "controller", "device", "version")


def choose(
    recordings: "Sequence[NumberedEpisode]", ranges: Sequence[str], source: Path, *, incomplete: bool
) -> "list[NumberedEpisode]":
    """The episodes of some numbers; all complete ones without ranges such as ``3`` and ``5-8``.

    Raises UserError where a range is invalid, an episode does not exist, or it was cut short and
    ``incomplete`` is False.
    """
    numbers = [number for text in ranges for number in _numbers(text, len(recordings), source)]
    if not ranges:
        return [recording for recording in recordings if incomplete or recording.entry.complete]
    chosen = [recording for recording in recordings if recording.number in set(numbers)]
    cut = [recording.number for recording in chosen if not recording.entry.complete]
    if cut and not incomplete:
        raise UserError(
            f"{source}: episode {cut[0]} was cut short: leave it out, or pass --incomplete to export it too."
        )
    return chosen


def describe(recordings: "Sequence[NumberedEpisode]") -> list[dict[str, object]]:
    """The list as plain data; unknown values are None."""
    described: list[dict[str, object]] = []
    for recording in recordings:
        entry = recording.entry
        header, by = entry.header, entry.header.provenance
        described.append(
            {
                "episode": recording.number,
                "journal": str(recording.journal),
                "task": header.task,
                "started_utc": by.started_utc or None,
                "duration_s": entry.duration_s,
                "samples": entry.samples,
                "complete": entry.complete,
                "robot": header.robot,
                "settings": dict(header.settings) or None,
                **{name: getattr(by, name) or None for name in _BY},
            }
        )
    return described


def listing(recordings: "Sequence[NumberedEpisode]") -> Table:
    """The list as a table for the terminal."""
    several = len({recording.journal for recording in recordings}) > 1
    about = ("episode", "task", "started (UTC)", "s", "complete", "person", "run", "profile", "mode")
    table = Table(*about, "device", *(["journal"] if several else []), box=SIMPLE_HEAD, padding=0)
    for recording in recordings:
        entry = recording.entry
        by = entry.header.provenance
        texts = [
            str(recording.number),
            entry.header.task,
            by.started_utc.removesuffix("+00:00").replace("T", " "),
            f"{entry.duration_s:.1f}",
            "yes" if entry.complete else "cut short",
            by.person,
            by.run,
            by.profile,
            by.controller,
            by.device,
            *([recording.journal.name] if several else []),
        ]
        table.add_row(*(Text(visible(text) or UNKNOWN) for text in texts))
    return table


def _numbers(text: str, most: int, source: Path) -> range:
    found = re.fullmatch(r"(\d{1,9})(?:-(\d{1,9}))?", text)
    if found is None:
        raise UserError(f"--episodes {text!r} is neither a number, such as 3, nor a range, such as 5-8.")
    first, last = int(found[1]), int(found[2] or found[1])
    if not 1 <= first <= last <= most:
        raise UserError(f"{source} has episodes 1 to {most}: there is no {text}.")
    return range(first, last + 1)


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
    format: Annotated[  # noqa: A002 - the option's name
        Literal["lerobot", "mcap"],
        arg(help="A dataset (a folder), or one MCAP file for Foxglove and other viewers."),
    ] = "lerobot",
    incomplete: Annotated[bool, arg(help="Export episodes that were cut short too.")] = False,
    json: Json = False,
) -> int:
    """List what was recorded, and export it to a native dataset (LeRobotDataset v3.0) or to MCAP.

    For example: latentarm export teleop --episodes 1 3-5 --out eaten
    """
    from latentarm.demonstrations.dataset import write_dataset
    from latentarm.recordings.dataset_export import demonstrations_of
    from latentarm.recordings.folder import list_recordings, read_episodes
    from latentarm.recordings.mcap_export import write_mcap

    recordings = list_recordings(source)
    if out is None:
        if json:
            print(json_format.dumps(describe(recordings), indent=2))
        else:
            print_renderables(listing(recordings))
            say("Nothing was exported: name a new folder with --out.", json)
        return 0
    check_vacant(out)
    chosen = choose(recordings, episodes, source, incomplete=incomplete)
    recorded = read_episodes(chosen)
    if format == "mcap":
        write_mcap(recorded, out)
    else:
        write_dataset(demonstrations_of(recorded, source=str(source), incomplete=incomplete), out)
        write_options(out, "export")
    if json:
        print(json_format.dumps(describe(chosen), indent=2))
    folder = "" if format == "mcap" else "/"
    say(f"{len(chosen)} of {len(recordings)} episodes are in {out}{folder}.", json)
    left = sum(not recording.entry.complete for recording in recordings)
    if left and not incomplete and not episodes:
        say(f"{left} were cut short and were left out; --incomplete exports them too.", json)
    return 0
