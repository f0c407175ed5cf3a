"""`latentarm report`: what happened and with which settings, in one file to send to somebody."""

import base64
import json as json_format
import platform
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime, timedelta
from importlib.metadata import distributions, requires
from pathlib import Path
from typing import Annotated, Any, Final
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

import numpy as np
from tyro.conf import Positional, arg

from latentarm import __version__
from latentarm.commands.output import say
from latentarm.core.call_log import read_calls
from latentarm.core.errors import UserError
from latentarm.core.exact_json import of_json
from latentarm.core.files import written_whole
from latentarm.core.journal_limits import JournalLimits
from latentarm.core.machine import examine_machine
from latentarm.core.untrusted.opening import read_bytes
from latentarm.runs.options import Json

MOST_BYTES: Final = 24 << 20  # what most mail takes; the newest incident file is never left out
_LOG_BYTES: Final = 1 << 18  # of each log, from its end
_LOOK_S: Final = 0.5
_RUN_CONFIG: Final = "run/config.json"
_TOLD: Final = ("kind", "parameters", "layout", "versions")  # of that file
_ADDRESSES: Final = re.compile(r"(?<=://)[^\s/?'\",)]+|\b\d{1,3}(?:\.\d{1,3}){3}(?::\d+)?\b")


def report(
    folder: Annotated[
        Positional[Path],
        arg(metavar="DIR", help="The folder that `teleop --out` names, or an incident file."),
    ] = Path("teleop"),
    out: Annotated[Path, arg(metavar="FILE.zip", help="The file to write.")] = Path("report.zip"),
    drive: Annotated[
        str | None,
        arg(metavar="WHEN", help="When the drive was, such as 2026-11-26T14:05, if it is not the last one."),
    ] = None,
    json: Json = False,
) -> int:
    """Pack what happened into one file: versions, settings, stops, readings, commands, logs.

    It has no names of people, addresses or PINs, and no pictures. For example: latentarm report teleop
    """
    files, left_out = _chosen(folder, drive)
    incidents = [_summary(file) for file in files]
    hidden = {**dict.fromkeys(_people(folder), "Somebody"), str(folder.absolute()): folder.name}
    about = {
        "made_utc": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": _versions(),
        "machine": [
            asdict(one) for one in examine_machine(folder, JournalLimits().least_free_bytes, _LOOK_S)
        ],
        "incidents": incidents,
    }
    with written_whole(out) as part, ZipFile(part, "w", ZIP_DEFLATED) as packed:
        packed.writestr("report.json", _unnamed(json_format.dumps(about, indent=1), hidden))
        for log in sorted(folder.glob("*.log*")):
            end = read_bytes(log, 1 << 30)[-_LOG_BYTES:].decode(errors="replace")
            packed.writestr(f"logs/{log.name}", _unnamed(end, hidden))
        for file in files:
            packed.write(file, f"incidents/{file.name}", ZIP_STORED)
    if json:
        print(json_format.dumps(about, indent=2))
    for one in incidents:
        stops = sum("stopped" in event for event in one["events"])
        said = one["damaged"] or f"{one['ticks']:,} ticks, {stops} stops"
        say(f"{one['file']}: {said}", json)
    if left_out:
        one = f"{left_out[0].name} and {len(left_out) - 1} older incident files are"
        say(f"{one} left out, as they are too large together: choose by --drive.", json)
    say(f"{out} has {out.stat().st_size / 1e6:.1f} MB. To see what happened: latentarm replay {out}", json)
    return 0


def _chosen(folder: Path, drive: str | None) -> tuple[list[Path], list[Path]]:
    """Incident files, the newest first: those to send, and older ones that would make too much."""
    from latentarm.web.arm_process.incident import began, incident_files

    files = incident_files(folder)[::-1]
    if drive is not None:
        try:
            # To the minute, as the page shows it: the file began before that minute was over.
            until = datetime.fromisoformat(drive).astimezone(UTC) + timedelta(minutes=1)
        except ValueError as error:
            raise UserError(f"--drive {drive!r} is no time: write it as 2026-11-26T14:05.") from error
        files = [file for file in files if (at := began(file)) is not None and at < until]
        if not files:
            raise UserError(f"{folder} has no incident file from before {drive}.")
    sizes = np.cumsum([file.stat().st_size for file in files])
    most = max(1, int((sizes <= MOST_BYTES).sum()))
    return files[:most], files[most:]


def _summary(file: Path) -> dict[str, Any]:
    """Summary of an incident file, without replaying it."""
    from latentarm.web.arm_process.incident import VERSION

    lines = read_calls(file)
    head, config = next(lines), b""
    events: list[dict[str, Any]] = []
    ticks, first_s, time_s = 0, None, 0.0
    damaged = None
    try:
        if head.get("incident") != VERSION:
            raise UserError("It was written by another version of latentarm.")
        for line in lines:
            if line.get("file") == _RUN_CONFIG:
                config += base64.b64decode(line["data"])
            elif line.get("call") == "__call__":
                first_s = line["given"][3] if first_s is None else first_s
                time_s, ticks = line["given"][3] - first_s, ticks + 1
                events += _news(events, time_s, line["answer"]["stop"])
    except (UserError, LookupError, TypeError) as error:
        damaged = str(error)
    about = {name: head.get(name) for name in ("began_utc", "computer", "settings", "robot", "model")}
    found = () if damaged and not ticks else of_json(head["spec"]["fields"]["found"])
    return {
        "file": file.name,
        **about,
        "arm": dict(found),
        "run": {name: json_format.loads(config)["model"][name] for name in _TOLD} if config else None,
        "seconds": round(time_s, 2),
        "ticks": ticks,
        "events": events,
        "damaged": damaged,
    }


def _news(events: Sequence[dict[str, Any]], time_s: float, stop: dict[str, Any] | None) -> Iterator[Any]:
    """The event of a tick, if it says something new: enabled, or stopped with code and words."""
    said = {"enabled": True} if stop is None else {"stopped": stop["code"], "words": stop["reason"]}
    if not events or {**events[-1], "time_s": 0} != {**said, "time_s": 0}:
        yield {"time_s": round(time_s, 3), **said}


def _versions() -> dict[str, Any]:
    named = {re.split(r"[^\w.-]", one)[0].lower() for one in requires("latentarm") or ()}
    installed = {one.metadata["Name"].lower(): one.version for one in distributions()}
    return {
        "latentarm": __version__,
        "python": platform.python_version(),
        "system": platform.platform(),
        "packages": {name: installed[name] for name in sorted(named & installed.keys())},
    }


def _people(folder: Path) -> list[str]:
    """Names of people with records."""
    from latentarm.web.records.people import PERSON_NAME
    from latentarm.web.records.records import FOLDER

    documents = (folder / FOLDER / "people").glob(f"*/{PERSON_NAME}")
    return [json_format.loads(read_bytes(one, 1 << 20))["name"] for one in documents]


def _unnamed(text: str, hidden: Mapping[str, str]) -> str:
    """A text without addresses, the folder of this user, and what else is hidden behind other words."""
    text = _ADDRESSES.sub("...", text)
    for name, other in {**hidden, str(Path.home()): "~"}.items():
        text = other.join(re.split(rf"(?<!\w){re.escape(name)}(?!\w)", text))
    return text
