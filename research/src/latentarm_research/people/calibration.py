"""What was fitted of the simulated people, to mode switching and to movements along one axis alone."""

import json
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, Final, final


@final
@dataclass(frozen=True)
class Calibration:
    """The figures of the simulated people that are fitted; all others are given."""

    push_variation: float  # of the median person, see `latentarm_research.people.motor_noise.HandConfig`
    switch_s: float  # the median person's time for a mode switch, in which the stick is let go, s


BEFORE: Final = Calibration(push_variation=0.1, switch_s=0.8)
"""Before anything was fitted: chosen, and the time of a switch is that of the other simulated people."""

_FROZEN: Final[dict[str, Any]] = json.loads(
    (files("latentarm_research.people") / "calibration.json").read_text(encoding="utf-8")
)

del _FROZEN["provenance"]  # how it was fitted: command, seed, aim, and all figures before and after

CALIBRATED: Final = Calibration(**_FROZEN)
"""Frozen before these people drove any latent action; `latentarm measure calibration` measures it."""
