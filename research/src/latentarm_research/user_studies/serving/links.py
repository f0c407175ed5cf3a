"""The list of a study's links, which the experimenter sends to people."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from latentarm.core.files import write_text
from latentarm.core.untrusted.opening import read_bytes
from latentarm.demonstrations.bounds import MAX_TEXT_BYTES

LINKS: Final = "links.csv"


def write_links(out: Path, links: Sequence[str]) -> None:
    """Write the list into the folder of the study."""
    write_text(out / LINKS, "\n".join(["link", *links, ""]))


def renew_links(out: Path, renewed: Mapping[str, str]) -> None:
    """Put new codes in the place of those of people who were deleted."""
    if not (out / LINKS).exists():
        return
    text = read_bytes(out / LINKS, MAX_TEXT_BYTES).decode("utf-8", "replace")
    for old, new in renewed.items():
        text = text.replace(f"={old}\n", f"={new}\n")
    write_text(out / LINKS, text)
