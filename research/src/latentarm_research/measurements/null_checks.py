"""Null checks of the analysis of user studies: how often it finds what is not there, and what is.

A condition is compared with itself in many studies whose trials are drawn at random, of twelve people who
meet all conditions, or of forty who meet one each: a test should be significant in 5 % of them. With an
injected effect of dz = 0.8 within people, or d = 0.8 between them, it should be found as often as the power
analysis says. Orders, people's levels, and chance from trial to trial are drawn as a study has them. Nobody
drives.
"""

from dataclasses import replace
from typing import Final

import numpy as np
from statsmodels.stats.power import TTestIndPower, TTestPower

from latentarm_research.measurements.catalogue import NullChecks
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.studies.claims import Claim, Hypothesis
from latentarm_research.studies.statistics import LEVEL
from latentarm_research.user_studies.analysis.claims import claims_tested, sides_of
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.definition import Definition, Factor
from latentarm_research.user_studies.designs import design_of
from latentarm_research.user_studies.record import Trial

PEOPLE: Final = {"within": 12, "between": 40}
EFFECT: Final = 0.8  # in SDs of people's differences within them, of people between

PERSON_SD, ORDER_EFFECT, TRIAL_SD, CONDITION_SD = 4.0, -0.1, 1.0, 1.0
"""Of the drawn trials, in units of the chance from trial to trial: how people differ, what each place in the
order adds, and how much the difference between two conditions varies from person to person."""

TOLERANCE: Final = 0.02  # how far the share of false findings may be from 5 %, with enough studies


Check = tuple[str, float, float]
"""A test, the share of studies in which it was significant, and the expected share."""


def measure(options: NullChecks, work: Work) -> Outcome:
    """All rates; those that are off break a limit."""
    rows, broken = [], list[str]()
    for test, found, expected in checks(options.studies, work.seed):
        # Two standard errors of a share of so many studies.
        tolerance = 2.0 * float(np.sqrt(expected * (1.0 - expected) / options.studies))
        if expected == LEVEL:
            tolerance = max(TOLERANCE, tolerance)
        figures = {"significant": found, "expected": expected, "tolerance": tolerance}
        in_percent = {f"{name}_percent": 100.0 * one for name, one in figures.items()}
        rows += line("null-checks", test, options.studies, in_percent)
        broken += [f"{test}: {found:.1%} instead of {expected:.1%}"] * (abs(found - expected) > tolerance)
    return Outcome(rows, broken, "Trials are drawn; nobody drives.")


def drawn(definition: Definition, rng: np.random.Generator, effects: dict[str, float]) -> list[Trial]:
    """Trials of one study."""
    names = [condition.name for condition in definition.conditions]
    met = design_of(definition).orders(definition, PEOPLE[definition.design], rng)
    trials: list[Trial] = []
    for person, order in enumerate(met):
        level = rng.normal(20.0, PERSON_SD)
        own = {name: rng.normal(0.0, CONDITION_SD / np.sqrt(2.0)) for name in names}
        for place, name in enumerate(order):
            usual = level + effects.get(name, 0.0) + own[name] + ORDER_EFFECT * place
            for task in definition.tasks:
                for number in range(task.trials):
                    value = usual + rng.normal(0.0, TRIAL_SD)
                    trials.append(Trial(person, name, task.name, place, number, {"time_s": float(value)}))
    return trials


def effect_of(definition: Definition) -> float:
    """The difference between two conditions that is `EFFECT` in people's means."""
    trials = sum(task.trials for task in definition.tasks)
    within = CONDITION_SD**2 + 2.0 * TRIAL_SD**2 / trials
    if definition.design == "between":
        return EFFECT * float(np.sqrt(PERSON_SD**2 + within / 2.0))
    count = len(definition.conditions)
    # The mean square of the difference of two places in an order of so many, each pair as often.
    places = count * (count + 1) / 6.0
    return EFFECT * float(np.sqrt(within + ORDER_EFFECT**2 * places))


def rates(definition: Definition, claim: Claim, effect: float, studies: int, seed: int) -> dict[str, float]:
    """Share of the studies in which each test of a claim is significant."""
    design = design_of(definition)
    found: dict[str, list[float]] = {"t": [], "randomisation": []}
    for study in range(studies):
        trials = drawn(definition, np.random.default_rng([seed, study]), dict.fromkeys(claim.subject, effect))
        tested = claims_tested(definition, sides_of(definition, trials))
        p = next(one.p for one in tested if one.claim == claim)
        found["t"].append(1.0 if p is None else p)
        exact = design.randomisation_p(design.sides(trials, claim), design.table(trials, claim))
        found["randomisation"].append(1.0 if exact is None else exact)
    return {test: float(np.mean(np.array(p) < LEVEL)) for test, p in found.items()}


def anova_rate(definition: Definition, factors: tuple[Factor, Factor], studies: int, seed: int) -> float:
    """Share of all effects in studies without any that the analysis of variance finds significant."""
    tasks = [task.name for task in definition.tasks]
    p = [
        effect.p
        for study in range(studies)
        for effect in design_of(definition).effects(
            drawn(definition, np.random.default_rng([seed, study]), {}), factors, "time_s", tasks
        )
    ]
    return float(np.mean(np.array(p) < LEVEL))


def t_checks(definition: Definition, claim: Claim, power: float, studies: int, seed: int) -> list[Check]:
    """Tests of a claim without effect, and with one that should be found with a certain power."""
    kind, size = ("paired t", "dz") if definition.design == "within" else ("Welch's t", "d")
    itself = rates(definition, claim, 0.0, studies, seed)
    injected = rates(definition, claim, -effect_of(definition), studies, seed + 1)
    return [
        (f"{kind}, a condition against itself", itself["t"], LEVEL),
        (f"randomisation test {definition.design} people, the same", itself["randomisation"], LEVEL),
        (f"{kind}, {size} = {EFFECT}", injected["t"], power),
    ]


def checks(studies: int, seed: int) -> list[Check]:
    """All null checks."""
    harmonic, eating = load_definition("harmonic"), load_definition("eating")
    claim = Claim("time_s", ("cVAE",), ("High Assist",), "less")
    control, assistance = eating.factors
    factors = (control, assistance)
    compared = tuple(one for one in harmonic.conditions if one.name in {*claim.subject, *claim.against})
    apart = replace(
        harmonic,
        name="harmonic_apart",
        design="between",
        conditions=compared,
        hypotheses=(Hypothesis("H1", "cVAE is quicker.", (claim,)),),
        printed=(),
    )
    unpaired = replace(eating, design="between")
    within = float(TTestPower().power(EFFECT, PEOPLE["within"], LEVEL))
    between = float(TTestIndPower().power(EFFECT, PEOPLE["between"] / 2, LEVEL))
    return [
        *t_checks(harmonic, claim, within, studies, seed),
        ("repeated-measures F, no effects", anova_rate(eating, factors, studies, seed + 2), LEVEL),
        *t_checks(apart, claim, between, studies, seed),
        ("F between people, no effects", anova_rate(unpaired, factors, studies, seed + 2), LEVEL),
    ]
