"""The files of a study beside its database: the list of links, and the steps of drives."""

import shutil
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.untrusted.opening import read_bytes
from latentarm.demonstrations.bounds import MAX_TEXT_BYTES
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.serving.store import Deleted

LINKS: Final = "links.csv"
DRIVES: Final = "drives"  # of the drives under way; in it a folder for each person, and there one by kind
STEPS: Final = "steps"  # a folder for each person, and in it a file for each of their drives


def check_links(out: Path, codes: Sequence[str]) -> None:
    """Raise a `UserError` where the list of links in the folder has other codes, which people may have."""
    path = out / LINKS
    if path.exists():
        _, *there = read_bytes(path, MAX_TEXT_BYTES).decode("utf-8", "replace").splitlines()
        if not {one.rpartition("=")[2] for one in there} <= {*codes}:
            raise UserError(
                f"{path} has links that the study's database does not know: restore the database, or move the"
                " file away if nobody has them."
            )


def write_links(out: Path, address: str, codes: Sequence[str]) -> None:
    """Write the list of the links to an address into the folder of the study."""
    write_text(out / LINKS, "\n".join(["link", *(f"{address}?code={code}" for code in codes), ""]))


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


def forget_strangers(out: Path, known: Collection[str]) -> None:
    """Remove the steps of people without one of these keys: another server may have deleted them."""
    for folder in (out / STEPS).glob("*"):
        if folder.name not in known:
            shutil.rmtree(folder, ignore_errors=True)


def forget(out: Path, people: Sequence[Deleted]) -> None:
    """Remove people who were deleted: their drives with the steps, and the codes of their links."""
    for one in people:
        for folder in (DRIVES, STEPS):
            shutil.rmtree(out / folder / one.key, ignore_errors=True)
    if (out / LINKS).exists():
        text = read_bytes(out / LINKS, MAX_TEXT_BYTES).decode("utf-8", "replace")
        for one in people:
            text = text.replace(f"={one.link}\n", f"={one.next_code}\n")
        write_text(out / LINKS, text)
