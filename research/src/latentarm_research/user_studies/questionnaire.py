"""What people are asked after a condition: scales of several items each, in our own words."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.core.errors import UserError

FEWEST_ITEMS: Final = 4
"""Items of a scale, at least (Schrum et al., ACM THRI 12:1, 2023)."""


@final
@dataclass(frozen=True)
class Item:
    """One statement, with which people agree or disagree.

    Attributes:
        text: the statement.
        reversed: agreement means less of what the scale measures.
    """

    text: str
    reversed: bool = False


@final
@dataclass(frozen=True)
class Scale:
    """One thing that several items ask about; its score is their mean.

    Attributes:
        name: the measure's name in records and claims.
        label: as tables and figures call it.
        items: at least `FEWEST_ITEMS`, some of them reversed.
        points: of the answer, from "strongly disagree" to "strongly agree".

    Raises:
        UserError: there are too few items or points.
    """

    name: str
    label: str
    items: tuple[Item, ...]
    points: int = 7

    def __post_init__(self) -> None:
        if len(self.items) < FEWEST_ITEMS:
            raise UserError(
                f"The scale {self.name} needs {FEWEST_ITEMS} items or more, not {len(self.items)}."
            )
        if self.points < 2:
            raise UserError(f"The scale {self.name} needs two points or more, not {self.points}.")


def scale(name: str, label: str, agree: tuple[str, ...], disagree: tuple[str, ...]) -> Scale:
    """A scale of statements for and against.

    Args:
        name: the measure's name.
        label: as tables call it.
        agree: statements that say more of it.
        disagree: statements that say less of it.

    Raises:
        UserError: there are too few items.
    """
    return Scale(name, label, (*map(Item, agree), *(Item(text, True) for text in disagree)))


PREFER: Final = scale(
    "prefer",
    "Prefer",
    ("I would use this control again.", "I liked this control."),
    ("I would rather not use this control.", "I disliked this control."),
)
"""Asked alike wherever people compare controls."""
