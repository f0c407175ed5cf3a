"""The data that a served study keeps of a person beside their drives and answers."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

if TYPE_CHECKING:
    from latentarm_research.user_studies.serving.store import Store


@final
@dataclass(frozen=True)
class Participant:
    """A person who has consented. Input devices are not stored, nor anything else about a person."""

    key: str  # random; their steps are kept under it
    number: int | None  # of their place; somebody else may have got it if they have not finished
    conditions: tuple[str, ...]  # of their trials so far, in order
    consent: str  # SHA-256 of the text that they consented to
    consented: str  # when, ISO 8601
    practised: int  # conditions that they have practised
    finished: bool


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
            row["completion"] is not None,
        )
        for key, drives in store.drives().items()
        for row in store.everything(key)["people"]
        if row["consent"] is not None
    ]
    return tuple(sorted(found, key=lambda one: (not one.finished, one.number or 0, one.key)))
