"""What was fitted of the simulated people, to mode switching and to movements along one axis alone."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.errors import UserError


@final
@dataclass(frozen=True)
class Calibration:
    """The figures of the simulated people that are fitted; all others are given.

    Attributes:
        decision_s: the median person's time from decision to decision, s.
        switch_s: the median person's time for a mode switch, in which the stick is let go, s.

    Raises:
        UserError: a figure is not positive.
    """

    decision_s: float
    switch_s: float

    def __post_init__(self) -> None:
        if not (self.decision_s > 0 and self.switch_s > 0):
            raise UserError("The times of a calibration must be positive.")


BEFORE: Final = Calibration(decision_s=0.5, switch_s=0.8)
"""Before anything was fitted. People correct their course twice a second at best (Loram, Gollee, Lakie and
Gawthrop, J. Physiol. 589:307, 2011); the time of a switch is that of the other simulated people."""

CALIBRATED: Final = BEFORE
"""Not fitted yet."""
