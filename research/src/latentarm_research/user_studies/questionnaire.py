"""What people are asked after a condition: scales of several items each, in our own words."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.core.errors import UserError

FEWEST_ITEMS: Final = 4  # items of a scale, at least (Schrum et al., ACM THRI 12:1, 2023)


@final
@dataclass(frozen=True)
class Item:
    """One statement, with which people agree or disagree."""

    text: str
    """The statement."""
    reversed: bool = False
    """True if agreement means less of what the scale measures."""


@final
@dataclass(frozen=True)
class Scale:
    """One thing that several items ask about; its score is their mean."""

    name: str
    """Name in records and claims."""
    label: str
    """Name in tables and figures."""
    items: tuple[Item, ...]
    """Statements, four or more."""
    points: int = 7
    """Points of the answer, from "strongly disagree" to "strongly agree", two or more."""

    def __post_init__(self) -> None:
        if len(self.items) < FEWEST_ITEMS:
            raise UserError(
                f"The scale {self.name} needs {FEWEST_ITEMS} items or more, not {len(self.items)}."
            )
        if self.points < 2:
            raise UserError(f"The scale {self.name} needs two points or more, not {self.points}.")


def scale(name: str, label: str, agree: tuple[str, ...], disagree: tuple[str, ...]) -> Scale:
    """A scale of statements for and against. Raises a `UserError` where there are too few items."""
    return Scale(name, label, (*map(Item, agree), *(Item(text, True) for text in disagree)))


PREFER: Final = scale(
    "prefer",
    "Prefer",
    ("I would use this control again.", "I liked this control."),
    ("I would rather not use this control.", "I disliked this control."),
)
"""Asked alike wherever people compare controls."""
