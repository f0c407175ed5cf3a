"""The files of a study beside its database: the list of links, and the steps of drives."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from latentarm.core.files import write_text
from latentarm.core.untrusted.opening import read_bytes
from latentarm.demonstrations.bounds import MAX_TEXT_BYTES
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.serving.store import Deleted

LINKS: Final = "links.csv"
STEPS: Final = "steps"  # a folder for each person, and in it a file for each of their drives


def write_links(out: Path, links: Sequence[str]) -> None:
    """Write the list into the folder of the study."""
    write_text(out / LINKS, "\n".join(["link", *links, ""]))


def steps_path(out: Path, key: str, drive: DriveRecord) -> Path:
    """The file with the steps of a person's drive."""
    named = (drive.order, drive.task, drive.trial, drive.choice, drive.attempt)
    return out / STEPS / key / f"{'-'.join(map(str, named))}.safetensors"


def steps_of(out: Path, key: str) -> list[Path]:
    """The files with the steps of a person's drives."""
    return sorted((out / STEPS / key).glob("*.safetensors"))


def keep_steps(out: Path, key: str, drive: DriveRecord, written: Path) -> None:
    """Move the file that a drive has written to where it stays."""
    if written.exists():
        path = steps_path(out, key, drive)
        path.parent.mkdir(parents=True, exist_ok=True)
        written.replace(path)


def forget(out: Path, people: Sequence[Deleted]) -> None:
    """Remove people who were deleted: their steps, and the codes of their links."""
    for one in people:
        shutil.rmtree(out / STEPS / one.key, ignore_errors=True)
    if (out / LINKS).exists():
        text = read_bytes(out / LINKS, MAX_TEXT_BYTES).decode("utf-8", "replace")
        for one in people:
            text = text.replace(f"={one.link}\n", f"={one.next_code}\n")
        write_text(out / LINKS, text)
