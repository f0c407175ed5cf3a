"""What was fitted of the simulated people, to mode switching and to public logs of people alone."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from typing import Any, Final, final

from latentarm.errors import UserError


@final
@dataclass(frozen=True)
class Calibration:
    """The figures of the simulated people that are fitted; all others are given.

    Attributes:
        push_variation: of the median person, see `latentarm.operators.hand.HandConfig`.
        switch_s: the median person's time for a mode switch, in which the stick is let go, s.

    Raises:
        UserError: a figure is not positive.
    """

    push_variation: float
    switch_s: float

    def __post_init__(self) -> None:
        if not (self.push_variation > 0 and self.switch_s > 0):
            raise UserError("The figures of a calibration must be positive.")


_FROZEN: Final[dict[str, Any]] = json.loads(
    (files("latentarm.operators") / "calibration.json").read_text(encoding="utf-8")
)

PROVENANCE: Final[Mapping[str, Any]] = _FROZEN.pop("provenance")
"""How `CALIBRATED` was fitted: the command, the seed, what was aimed at, and all figures before and after."""

CALIBRATED: Final = Calibration(**_FROZEN)
"""Frozen before any study is run with these people; see `scripts/people_from_logs.py` for the variation of
pushes and `scripts/calibrate_population.py` for the time of a mode switch."""

BEFORE: Final = replace(CALIBRATED, switch_s=0.8)
"""Before the time of a switch was fitted: it is that of the other simulated people."""
