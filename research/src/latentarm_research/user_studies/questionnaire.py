"""The questions after a condition: scales, questions with options, and questions answered in words."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.core.errors import UserError

LONGEST_TEXT: Final = 2000  # characters of an answer in words
LOW, HIGH = "strongly disagree", "strongly agree"


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
    """Statements, one or more. Four or more make the score reliable (Schrum et al., ACM THRI 12:1, 2023)."""
    points: int = 7
    """Points of the answer, two or more."""
    low: str = LOW
    """Meaning of the answer 1."""
    high: str = HIGH
    """Meaning of the highest answer."""
    slider: bool = False
    """True for a slider from 1 to `points` for each item, in place of one button for each point."""

    def __post_init__(self) -> None:
        if not self.items:
            raise UserError(f"The scale {self.name} needs one item or more.")
        if self.points < 2:
            raise UserError(f"The scale {self.name} needs two points or more, not {self.points}.")


@final
@dataclass(frozen=True)
class MultipleChoice:
    """One question with options to choose from."""

    name: str
    """Name in records: at most 40 of a to z, 0 to 9 and _, a letter first."""
    text: str
    """The question."""
    options: tuple[str, ...]
    """Two or more, each another; they are asked in this order."""
    several: bool = False
    """True if several may be chosen, False for one."""
    attention: int = 0
    """Number, from 1, of the option that everybody chooses who reads the question; 0 if it checks no
    attention."""

    def __post_init__(self) -> None:
        if len(self.options) < 2 or len(set(self.options)) < len(self.options):
            raise UserError(f"The question {self.name} needs two options or more, each another.")
        if not 0 <= self.attention <= len(self.options) or (self.attention and self.several):
            raise UserError(f"The attention of {self.name} must be the number of its only right option.")


@final
@dataclass(frozen=True)
class Question:
    """One question that people answer in their own words."""

    name: str
    """Name in records: at most 40 of a to z, 0 to 9 and _, a letter first."""
    text: str
    """The question."""
