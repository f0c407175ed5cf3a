"""Episodes recorded in one journal or in a folder of journals."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.recordings.journal_reader import JournalEntry, JournalEpisode, list_journal, read_journal

JOURNAL_SUFFIX: Final = ".sqlite"


@final
@dataclass(frozen=True)
class NumberedEpisode:
    """One recorded episode among all those of a folder."""

    number: int  # counted from one over all journals, the oldest journal first
    journal: Path
    entry: JournalEntry


def list_recordings(path: Path) -> list[NumberedEpisode]:
    """All episodes of a journal, or of a folder's journals by name (``teleop``'s is their time).

    Raises UserError without any journal, or where one is broken.
    """
    journals = sorted(path.glob(f"*{JOURNAL_SUFFIX}")) if path.is_dir() else [path]
    if not journals:
        raise UserError(f"{path} holds no journal (*{JOURNAL_SUFFIX}): nothing was recorded there.")
    entries = [(journal, entry) for journal in journals for entry in list_journal(journal)]
    return [NumberedEpisode(number, journal, one) for number, (journal, one) in enumerate(entries, start=1)]


def read_episodes(recordings: Sequence[NumberedEpisode]) -> list[JournalEpisode]:
    """Recorded episodes from `list_recordings`; UserError where a journal is damaged."""
    wanted: dict[Path, list[int]] = {}
    for recording in recordings:
        wanted.setdefault(recording.journal, []).append(recording.entry.number)
    return [episode for journal, numbers in wanted.items() for episode in read_journal(journal, numbers)]
