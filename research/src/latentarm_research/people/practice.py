"""How a simulated person gets faster and surer from trial to trial."""

import math
from dataclasses import dataclass
from typing import Final, final

from latentarm.core.errors import UserError

TRIAL_S: Final = 60.0
"""Practice of so long teaches as much as a trial, s. Chosen: about as long as the studies' trials last."""


@final
@dataclass(frozen=True)
class Practice:
    """The power law of practice: times shrink as ``N^-exponent`` (Newell and Rosenbloom 1981).

    N counts this trial, those before it and what was practised before all of them. Practice of several
    minutes thus leaves little to learn in the trials. Averages over people follow this law; single people
    rather follow an exponential (Heathcote, Brown and Mewhort 2000), which is not modelled.

    Raises:
        UserError: the exponent is negative or not finite.
    """

    exponent: float  # how fast they learn, 0 or more; at 0 they never do

    def __post_init__(self) -> None:
        if not (math.isfinite(self.exponent) and self.exponent >= 0):
            raise UserError(f"An exponent of practice must be zero or more, and finite, not {self.exponent}.")

    def time_share(self, trial: int, practice_s: float = 0.0) -> float:
        """What something takes in a trial, as a share of what it takes in the first without practice.

        Args:
            trial: number of trials before this one.
            practice_s: time practised before the first trial, s.

        Raises:
            UserError: a figure is negative or not finite.
        """
        if trial < 0 or not 0 <= practice_s < math.inf:
            raise UserError(
                f"There cannot be {trial} trials before this one, and {practice_s} s of practice:"
                " both must be zero or more."
            )
        return (1.0 + trial + practice_s / TRIAL_S) ** -self.exponent
