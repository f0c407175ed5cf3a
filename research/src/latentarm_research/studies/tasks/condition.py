"""A condition of the study: the controller and the person who steers."""

from dataclasses import dataclass, replace
from typing import Final, final

from latentarm.evaluation.looks import look_of

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

    def by(self, person: str | None) -> "Condition":
        """The same with another person."""
        return replace(self, person=person)

    @property
    def label(self) -> str:
        """How tables and figures call what moves the arm."""
        if self.model is None:
            return look_of(self.name).label
        return f"{look_of(self.model).label}{' + way back' if self.way_back else ''}, {self.name}"

    @property
    def row(self) -> str:
        """The condition of a row, whose model stands beside it."""
        return ", ".join(filter(None, (self.name, "way back" if self.way_back else "", self.person)))

    @property
    def folder(self) -> str:
        """The name of its folder, among those of a task."""
        return f"{self.model or ''}{'_way_back' if self.way_back else ''}_{self.name}".strip("_").replace(
            " ", "_"
        )
