"""Simulated people as a population: what each of them is like is drawn once, before anything is driven.

They have no opinions: nothing here answers a questionnaire.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm_research.people.calibration import CALIBRATED, Calibration
from latentarm_research.people.spread import LogNormal, Normal, Spread
from latentarm_research.people.traits import Traits

STREAM: Final = 17  # separates what people are like from everything else that is drawn from the same seed

MIRRORED: Final = 0.2
"""Share of people for whom the second axis is upside down. A minority of players inverts it (Corbett and
Munneke, Cogn. Res. Princ. Implic., 2025); how many of them is chosen."""


@final
@dataclass(frozen=True)
class TraitSource:
    """How one trait is spread over people, and why."""

    name: str  # of the field of `Traits`
    meaning: str  # in a few words
    unit: str  # "" for a number or a share
    spread: Spread  # over people
    source: str  # where it comes from; what is chosen says so


_TRAITS: Final = read_object(Path(__file__).parent / "traits.json")
"""Spread and source of traits by name; with ``times``, a field of `Calibration`, multiples of that."""


def trait_sources(calibration: Calibration) -> tuple[TraitSource, ...]:
    """All traits that are drawn, but for the share of `MIRRORED`.

    They are independent: nothing is known of how they go together.
    """
    return tuple(
        TraitSource(name, one["meaning"], one["unit"], _spread(calibration, **one["spread"]), one["source"])
        for name, one in _TRAITS.items()
    )


def _spread(
    calibration: Calibration,
    *,
    kind: str,
    middle: float,
    width: float,
    lowest: float,
    highest: float,
    times: str = "",
) -> Spread:
    scale = getattr(calibration, times) if times else 1.0
    spread = Normal if kind == "normal" else LogNormal
    return spread(scale * middle, width, scale * lowest, scale * highest)


TRAITS: Final = trait_sources(CALIBRATED)  # those of the people that studies are done with


def draw_people(number: int, seed: int, calibration: Calibration = CALIBRATED) -> tuple[Traits, ...]:
    """People with traits drawn from `TRAITS`.

    The same seed gives the same people, however many are drawn. With another calibration each of them keeps
    their place among all people in every trait.
    """
    if number < 1 or seed < 0:
        raise UserError(
            f"A population needs one person or more and a seed of 0 or more, not {number} and {seed}."
        )
    return tuple(_person(index, seed, calibration) for index in range(number))


def _person(number: int, seed: int, calibration: Calibration) -> Traits:
    rng = np.random.default_rng([STREAM, seed, number])
    figures = {one.name: one.spread.at(rng.random()) for one in trait_sources(calibration)}
    return Traits(number=number, mirrored=bool(rng.random() < MIRRORED), **figures)
