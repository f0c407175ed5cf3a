"""Simulated people as a population: what each of them is like is drawn once, before anything is driven.

They have no opinions: nothing here answers a questionnaire.
"""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
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


def trait_sources(calibration: Calibration) -> tuple[TraitSource, ...]:
    """All traits that are drawn, but for the share of `MIRRORED`.

    They are independent: nothing is known of how they go together.
    """
    variation, switch_s = calibration.push_variation, calibration.switch_s
    return (
        TraitSource(
            "reaction_s",
            "reaction time",
            "s",
            LogNormal(0.213, 0.12, 0.16, 0.35),
            "mean of 1469 people to a visual stimulus, without the delays of the display (Woods et al.,"
            " Front. Hum. Neurosci. 9:131, 2015); spread chosen",
        ),
        TraitSource(
            "tremor",
            "tremor, RMS share of full deflection",
            "",
            LogNormal(0.02, 0.4, 0.005, 0.06),
            "chosen; its band, 8 to 12 Hz, is that of physiological tremor (Elble and Randall, J."
            " Neurophysiol. 39:370, 1976)",
        ),
        TraitSource(
            "push_variation",
            "SD of a push, share of its length",
            "",
            LogNormal(variation, 0.25, 0.5 * variation, 2.0 * variation),
            "median calibrated; spread chosen. That it goes with the push: Harris and Wolpert, Nature"
            " 394:780, 1998",
        ),
        TraitSource(
            "rationality",
            "beta of equation 24, first trial",
            "1/m²",
            LogNormal(2500.0, 0.35, 1000.0, 8000.0),
            "chosen: after 5 minutes of practice, what the median person's pushes leave has an SD of half of"
            " what counts as near enough",
        ),
        TraitSource(
            "look_ahead_s",
            "look-ahead, dt of equation 24",
            "s",
            LogNormal(0.5, 0.2, 0.35, 1.0),
            "chosen: that of the other simulated people",
        ),
        TraitSource(
            "plan_s",
            "plans ahead where one input does not help",
            "s",
            LogNormal(2.0, 0.4, 0.5, 4.0),
            "chosen",
        ),
        TraitSource(
            "decision_s",
            "time between decisions, first trial",
            "s",
            LogNormal(0.5, 0.15, 0.3, 0.9),
            "people correct their course twice a second at best (Loram et al., J. Physiol. 589:307, 2011);"
            " spread chosen",
        ),
        TraitSource(
            "switch_s",
            "time of a mode switch, first trial",
            "s",
            LogNormal(switch_s, 0.25, 0.5 * switch_s, 2.0 * switch_s),
            "median calibrated; spread chosen",
        ),
        TraitSource(
            "switch_cost_m",
            "how much nearer a mode switch must bring the tool",
            "m",
            LogNormal(0.008, 0.3, 0.004, 0.014),
            "chosen, well below the 0.02 m that usually counts as near enough, so that nobody is content to"
            " miss",
        ),
        TraitSource(
            "lapses_per_min",
            "lapses of attention",
            "1/min",
            LogNormal(0.3, 0.6, 0.05, 2.0),
            "chosen: three in 10 minutes",
        ),
        TraitSource(
            "lapse_s",
            "mean duration of a lapse",
            "s",
            LogNormal(0.9, 0.25, 0.6, 1.8),
            "chosen, between the 0.5 s from which a late response counts as a lapse (Dinges and Powell 1985)"
            " and the 2.7 s beyond which eyes were closed (Anderson et al., Sleep 33:197, 2010)",
        ),
        TraitSource(
            "learning",
            "exponent of the power law of practice",
            "",
            LogNormal(0.2, 0.4, 0.05, 0.6),
            "the law is Newell and Rosenbloom's (1981); the exponent is chosen",
        ),
        TraitSource(
            "own_speed",
            "own speed, share of full",
            "",
            LogNormal(0.8, 0.2, 0.4, 1.0),
            "chosen",
        ),
        TraitSource(
            "turn_rad",
            "turn of their own directions of the stick",
            "rad",
            Normal(0.0, float(np.deg2rad(15.0)), -float(np.deg2rad(45.0)), float(np.deg2rad(45.0))),
            "chosen: SD 15°, 45° at most",
        ),
        TraitSource(
            "answer_variation",
            "coefficient of variation of answers to alignment queries",
            "",
            LogNormal(0.1, 0.4, 0.02, 0.4),
            "chosen",
        ),
    )


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
