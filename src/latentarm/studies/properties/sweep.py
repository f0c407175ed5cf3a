"""Designs of the simulation, each different from the study's own in one thing."""

import math
from dataclasses import replace
from typing import Final

from latentarm.studies.properties.preset import Preset

AS_CHOSEN: Final = "as chosen"
"""The design of the study."""

SPREADS_RAD: Final = (0.15, 0.3, 0.6, 0.9)
CONDITIONINGS: Final = (0.3,)


def designs(preset: Preset) -> dict[str, Preset]:
    """Every design by what it is called, that of the preset first; only that one unless it sweeps."""
    found = {AS_CHOSEN: replace(preset, sweeps=False)}
    return found | (_varied(preset) if preset.sweeps else {})


def _varied(preset: Preset) -> dict[str, Preset]:
    own, base = preset.design, replace(preset, sweeps=False)
    few = max(preset.episodes // 10, 5)
    changed = {
        **{f"postures spread by {size:g} rad": replace(own, spread_rad=size) for size in SPREADS_RAD},
        "postures nearest to the place": replace(own, placed="nearest"),
        "speeds of a swing": replace(own, pace="swing"),
        **{
            f"spread 0.6 rad, conditioning {least:g}": replace(own, spread_rad=0.6, least_conditioning=least)
            for least in CONDITIONINGS
        },
    }
    return {
        **{label: replace(base, design=design) for label, design in changed.items()},
        "one hidden layer": replace(base, hidden=base.hidden[:1]),
        "a tenth of the demonstrations, ten times the pairs of each": replace(
            base, episodes=few, design=replace(own, samples=math.ceil(base.episodes * own.samples / few))
        ),
        "twice the epochs": replace(base, epochs=2 * base.epochs),
    }
