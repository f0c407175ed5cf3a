"""How large the study is, what is driven with and by whom, and its streams of randomness."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Final, cast, final

from latentarm.core.errors import UserError
from latentarm.evaluation.looks import look_of
from latentarm.models.catalogue import DEFAULT_MODEL
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.people.names import OperatorName

DEMONSTRATOR: Final = "demonstrator"
SWITCHING: Final = "end_effector"
ORIENTED: Final = "learned_orientation"


@final
@dataclass(frozen=True)
class Condition:
    """A controller and the person who steers."""

    # `DEMONSTRATOR`, `SWITCHING`, `ORIENTED`, or for a model what its decoder sees, a name of `CONTEXTS`
    name: str
    model: str | None = None  # a name of `latentarm.models.catalogue.KINDS`, or None
    way_back: bool = False  # whether the model has a way back
    # a simulated person by name; None for the demonstrator, and for what all people steer with
    person: str | None = None
    # whether mode switching stands beside the model, a switch of mode away, as on the page
    beside: bool = False

    def by(self, person: str | None) -> "Condition":
        """The same with another person."""
        return replace(self, person=person)

    @property
    def label(self) -> str:
        """How tables and figures call what moves the arm."""
        if self.model is None:
            return look_of(self.name).label
        beside = f" beside {look_of(SWITCHING).label}" if self.beside else ""
        return f"{look_of(self.model).label}{' + way back' if self.way_back else ''}{beside}, {self.name}"

    @property
    def row(self) -> str:
        """The condition of a row, whose model stands beside it."""
        parts = (self.name, "way back" * self.way_back, "beside mode switching" * self.beside, self.person)
        return ", ".join(filter(None, parts))

    @property
    def folder(self) -> str:
        """The name of its folder, among those of a task."""
        parts = (self.model or "", "way_back" * self.way_back, "beside" * self.beside, self.name)
        return "_".join(filter(None, parts)).replace(" ", "_")


CONTEXTS: Final[Mapping[str, tuple[str, ...]]] = {
    "joints": ("joints",),
    "joints objects": ("joints", "objects"),
    "joints objects_in_tool": ("joints", "objects_in_tool"),
}
"""What a decoder may see, by the name of the condition; the model's parameter ``context`` for each."""


@final
@dataclass(frozen=True)
class Preset:
    """Sizes of the study."""

    name: str  # what it is called on the command line
    # of each task by each person, with mode switching and with the default; by the scripted demonstrator as
    # many
    runs: int = 50
    others: int = 20  # the same with everything else, at most
    # further runs of the demonstrator, those that succeed train the models; a fifth of them is for validation
    # and decides which epoch is best
    demonstrations: int = 60
    # kinds that are driven with, each without and with a way back
    models: tuple[str, ...] = ("cvae", "homogeneous", "low_turning")
    context: str = "joints objects_in_tool"  # what their decoders see, a name of `CONTEXTS`
    # the same, side by side, where things were moved
    moved_contexts: tuple[str, ...] = ("joints", "joints objects_in_tool")
    seeds: int = 3  # models of each kind, used in turn, so that no figure depends on one of them
    epochs: int = 60  # passes over the training pairs, at most
    batch_size: int = 256  # pairs per step
    hidden: tuple[int, ...] = (64, 64)  # units of each hidden layer
    state_noise_rad: float = 0.01  # SD of the noise on training states, rad
    way_back_m: float = 0.06  # length of the way back, m
    # who drives, names of `PEOPLE`
    people: tuple[OperatorName, ...] = ("planning", "greedy", "unsteady", "reading", "learning")

    def __post_init__(self) -> None:
        for person in self.people:
            if person not in PEOPLE:
                raise UserError(f"There is no simulated person {person!r}: choose from {', '.join(PEOPLE)}.")
        if not self.people or len(set(self.people)) < len(self.people):
            raise UserError("Name at least one simulated person, and none twice.")
        if self.runs < 1:
            raise UserError(f"The number of runs is {self.runs}: it must be at least 1.")

    @property
    def default(self) -> Condition:
        """The default model with the way back."""
        return Condition(self.context, DEFAULT_MODEL, way_back=True)

    @property
    def page(self) -> Condition:
        """The same as the page offers it."""
        return replace(self.default, beside=True)

    def asked(self, people: tuple[str, ...], runs: int | None) -> "Preset":
        """The preset with other people and runs, where any are named."""
        named = cast(tuple[OperatorName, ...], people)
        return replace(self, people=named or self.people, runs=self.runs if runs is None else runs)


PRESETS: Final[dict[str, Preset]] = {
    "paper": Preset("paper"),
    "small": Preset("small", runs=2, demonstrations=40, models=("homogeneous", "low_turning"), seeds=1),
    "smoke": Preset("smoke", runs=2, demonstrations=6, seeds=1, epochs=6, people=("planning",)),
}


class Stream(IntEnum):
    """The uses of randomness."""

    RUNS = 0
    DEMONSTRATIONS = 1
    NETWORKS = 2
