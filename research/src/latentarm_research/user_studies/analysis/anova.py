"""Analysis of variance of a 2 x 2 design on people's means, within and between people."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from latentarm_research.studies.statistics import spreads
from latentarm_research.user_studies.analysis.means import person_mean
from latentarm_research.user_studies.definition import Factor
from latentarm_research.user_studies.record import Trial


@final
@dataclass(frozen=True)
class Effect:
    """One line of the table."""

    name: str  # of the factor, or both with `x` between
    f: float  # the statistic
    dof: int  # of the effect
    dof_error: int  # n - 1 within n people for a factor of two levels, n - 4 between
    p: float  # of F
    eta: float  # partial eta squared


def repeated_measures(
    trials: Sequence[Trial], factors: tuple[Factor, Factor], measure: str, tasks: Sequence[str]
) -> list[Effect]:
    """Both factors and their interaction; empty without two people with all conditions, or without spread."""
    cells = _cells(factors)
    people = sorted({trial.person for trial in trials})
    by_person = {person: [trial for trial in trials if trial.person == person] for person in people}
    table = np.array(
        [
            [person_mean(by_person[person], person, measure, (condition,), tasks) for *_, condition in cells]
            for person in people
        ]
    ).reshape(-1, len(cells))
    table = table[np.isfinite(table).all(axis=1)]
    return _analysed(table, cells, factors) if len(table) > 1 and spreads(table.ravel()) else []


def between_people(
    trials: Sequence[Trial], factors: tuple[Factor, Factor], measure: str, tasks: Sequence[str]
) -> list[Effect]:
    """Both factors and their interaction, where each person meets one of the four conditions.

    Each effect is adjusted for the others (sums of squares of type III), which matters where the four groups
    differ in size. Empty where a cell has nobody, where nobody is left to tell chance by, or nobody varies.
    """
    from scipy.special import fdtrc

    rows: list[tuple[float, float, float]] = []
    for first, second, condition in _cells(factors):
        people = sorted({trial.person for trial in trials if trial.condition == condition})
        means = [person_mean(trials, person, measure, (condition,), tasks) for person in people]
        rows += [(first - 0.5, second - 0.5, mean) for mean in means if np.isfinite(mean)]
    table = np.array(rows).reshape(-1, 3)
    error = len(table) - 4
    if error < 1 or len({row[:2] for row in rows}) < 4 or not spreads(table[:, 2]):
        return []
    one, other, value = table.T
    design = np.column_stack([np.ones(len(value)), one, other, one * other])
    squares = [
        float(np.square(value - kept @ np.linalg.lstsq(kept, value, rcond=None)[0]).sum())
        for kept in (design, *(np.delete(design, column, axis=1) for column in (1, 2, 3)))
    ]
    found: list[Effect] = []
    for name, without in zip(_names(factors), squares[1:], strict=True):
        if squares[0] > 0.0:
            f = max(without - squares[0], 0.0) / (squares[0] / error)
            found.append(Effect(name, f, 1, error, float(fdtrc(1, error, f)), f / (f + error)))
    return found


def _cells(factors: tuple[Factor, Factor]) -> list[tuple[int, int, str]]:
    """Level of either factor, 0 or 1, and the condition that has both."""
    return [
        (first, second, condition)
        for first, (_, ones) in enumerate((factors[0].low, factors[0].high))
        for second, (_, others) in enumerate((factors[1].low, factors[1].high))
        for condition in ones
        if condition in others
    ]


def _names(factors: tuple[Factor, Factor]) -> tuple[str, str, str]:
    return factors[0].name, factors[1].name, f"{factors[0].name} x {factors[1].name}"


def _analysed(
    table: np.ndarray[Any, np.dtype[np.float64]],
    cells: Sequence[tuple[int, int, str]],
    factors: tuple[Factor, Factor],
) -> list[Effect]:
    import pandas as pd
    from statsmodels.stats.anova import AnovaRM

    frame = pd.DataFrame(
        [
            {"person": person, "first": first, "second": second, "value": table[person, column]}
            for person in range(len(table))
            for column, (first, second, _) in enumerate(cells)
        ]
    )
    fitted: Any = AnovaRM(frame, "value", "person", within=["first", "second"]).fit()
    effects: list[Effect] = []
    for name, (_, row) in zip(_names(factors), fitted.anova_table.iterrows(), strict=True):
        f, dof, error, p = (float(row[key]) for key in ("F Value", "Num DF", "Den DF", "Pr > F"))
        # An effect of exactly nothing comes out as the rounding of zero, of either sign, or as 0 / 0.
        if np.isfinite(f) and f >= 0.0:
            effects.append(Effect(name, f, int(dof), int(error), p, f * dof / (f * dof + error)))
    return effects
