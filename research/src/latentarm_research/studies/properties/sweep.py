"""Other designs of the simulation: the study's own with one thing changed, and wider networks.

Wider networks that train for longer learn postures that differ more, so their designs vary the spread of the
postures and the least conditioning as well.
"""

import math
from dataclasses import replace
from typing import Final

from latentarm_research.studies.properties.preset import Preset

AS_CHOSEN: Final = "as chosen"
"""The design of the study."""

SPREADS_RAD: Final = (0.3, 0.9)
WIDE_UNITS: Final = 128
WIDE_SPREADS_RAD: Final = (0.05, 0.4, 0.7, 0.9)
LOWER_CONDITIONING: Final = (0.9, 0.3)
"""Spread, rad, and least conditioning."""


def designs(preset: Preset) -> dict[str, Preset]:
    """Every design by what it is called, that of the preset first; only that one unless it sweeps."""
    found = {AS_CHOSEN: replace(preset, sweeps=False)}
    return found | (_varied(preset) if preset.sweeps else {})


def _varied(preset: Preset) -> dict[str, Preset]:
    own, base = preset.design, replace(preset, sweeps=False)
    few = max(preset.episodes // 10, 5)
    wide = replace(base, hidden=(WIDE_UNITS,) * len(base.hidden), epochs=3 * base.epochs)
    words = f"{WIDE_UNITS} units, three times the epochs, postures spread by"
    spread, least = LOWER_CONDITIONING
    return {
        **{
            f"postures spread by {size:g} rad": replace(base, design=replace(own, spread_rad=size))
            for size in SPREADS_RAD
        },
        "postures nearest to the place": replace(base, design=replace(own, placed="nearest")),
        "speeds of a swing": replace(base, design=replace(own, pace="swing")),
        "one hidden layer": replace(base, hidden=base.hidden[:1]),
        "a tenth of the demonstrations, ten times the pairs of each": replace(
            base, episodes=few, design=replace(own, samples=math.ceil(base.episodes * own.samples / few))
        ),
        **{
            f"{words} {size:g} rad": replace(wide, design=replace(own, spread_rad=size))
            for size in WIDE_SPREADS_RAD
        },
        f"{words} {spread:g} rad, conditioning {least:g}": replace(
            wide, design=replace(own, spread_rad=spread, least_conditioning=least)
        ),
    }
