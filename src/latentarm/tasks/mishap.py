"""Irreversible failures in a run of a task with things."""

from dataclasses import dataclass
from typing import Final, Literal, final

MishapKind = Literal["dropped", "knocked_over", "spilled", "pressed"]  # kind of failure
_SAID: Final[dict[MishapKind, str]] = {
    "dropped": "dropped the",
    "knocked_over": "knocked over the",
    "spilled": "spilled the",
    "pressed": "pressed too hard on the",
}


@final
@dataclass(frozen=True)
class Mishap:
    """An irreversible failure, and the thing or the grains that it happened to."""

    kind: MishapKind
    thing: str

    @property
    def text(self) -> str:
        """A few words for tables and films: "dropped the cup"."""
        return f"{_SAID[self.kind]} {self.thing}"
