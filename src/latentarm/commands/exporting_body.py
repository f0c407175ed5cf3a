"""`latentarm export`: what was recorded as a list, and the choice of episodes from it."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from latentarm.control.recordings import Recording
from latentarm.errors import UserError
from latentarm.untrusted.terminal import visible

if TYPE_CHECKING:
    from rich.table import Table

UNKNOWN = "–"


def choose(
    recordings: Sequence[Recording], ranges: Sequence[str], source: Path, *, incomplete: bool
) -> list[Recording]:
    """The episodes that somebody asked for by number.

    Args:
        recordings: all there are.
        ranges: numbers such as ``3`` and ranges such as ``5-8``; empty for all.
        source: where they are, for the message.
        incomplete: take episodes that were cut short too.

    Raises:
        UserError: a range is invalid, an episode does not exist, or it was cut short and was not asked for.
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


def describe(recordings: Sequence[Recording]) -> list[dict[str, object]]:
    """The list as plain data; what is unknown is None."""
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
                "person": by.person or None,
                "run": by.run or None,
                "run_fingerprint": by.run_fingerprint or None,
                "profile": by.profile or None,
                "controller": by.controller or None,
                "device": by.device or None,
                "version": by.version or None,
            }
        )
    return described


def listing(recordings: Sequence[Recording]) -> "Table":
    """The list as a table for the terminal."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

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
