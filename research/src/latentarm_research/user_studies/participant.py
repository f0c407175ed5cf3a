"""The data that a served study keeps of a person beside their drives and answers."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, final

if TYPE_CHECKING:
    from latentarm_research.user_studies.drive_record import DriveRecord
    from latentarm_research.user_studies.serving.store import Store


@final
@dataclass(frozen=True)
class Participant:
    """A person who has consented. Nothing else about a person is stored."""

    key: str  # random; their steps are kept under it
    number: int | None  # of their place; somebody else may have got it if they have not finished
    conditions: tuple[str, ...]  # of their trials so far, in order
    consent: str  # SHA-256 of the text that they consented to
    consented: str  # when, ISO 8601
    practised: int  # conditions that they have practised
    devices: tuple[str, ...]  # input devices of their trials so far, the longest pushed first
    finished: bool


def devices_of(drives: "Sequence[DriveRecord]") -> tuple[str, ...]:
    """The input devices of drives, the longest pushed first."""
    pushed_s: Counter[str] = Counter()
    for drive in drives:
        pushed_s.update(drive.input_s)
    return tuple(name for name, _ in pushed_s.most_common())


def participants_of(store: "Store") -> tuple[Participant, ...]:
    """Everybody who has consented, those who have finished first."""
    found = [
        Participant(
            key,
            row["number"],
            tuple(dict.fromkeys(drive.condition for drive in sorted(drives, key=lambda one: one.order))),
            row["consent"],
            row["consented"],
            row["practised"],
            devices_of(drives),
            row["completion"] is not None,
        )
        for key, drives in store.drives().items()
        for row in store.everything(key)["people"]
        if row["consent"] is not None
    ]
    return tuple(sorted(found, key=lambda one: (not one.finished, one.number or 0, one.key)))
