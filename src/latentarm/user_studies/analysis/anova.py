"""Repeated-measures analysis of variance of a 2 x 2 design, on people's means."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from latentarm.studies.statistics import spreads
from latentarm.user_studies.analysis.means import person_mean
from latentarm.user_studies.definition import Factor
from latentarm.user_studies.record import Trial


@final
@dataclass(frozen=True)
class Effect:
    """One line of the table.

    Attributes:
        name: of the factor, or both with ``x`` between.
        f: the statistic.
        dof: of the effect.
        dof_error: within subjects: n - 1 for a factor of two levels.
        p: of F.
        eta: partial eta squared.
    """

    name: str
    f: float
    dof: int
    dof_error: int
    p: float
    eta: float


def repeated_measures(
    trials: Sequence[Trial], factors: tuple[Factor, Factor], measure: str, tasks: Sequence[str]
) -> list[Effect]:
    """Both factors and their interaction.

    Args:
        trials: that count.
        factors: of a 2 x 2 design; each of its four cells has one condition.
        measure: which figure.
        tasks: whose trials.

    Returns:
        Empty for fewer than two people with all four conditions, or where a mean does not vary.
    """
    cells = [
        (first, second, condition)
        for first, (_, ones) in enumerate((factors[0].low, factors[0].high))
        for second, (_, others) in enumerate((factors[1].low, factors[1].high))
        for condition in ones
        if condition in others
    ]
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
    names = (factors[0].name, factors[1].name, f"{factors[0].name} x {factors[1].name}")
    effects: list[Effect] = []
    for name, (_, row) in zip(names, fitted.anova_table.iterrows(), strict=True):
        f, dof, error, p = (float(row[key]) for key in ("F Value", "Num DF", "Den DF", "Pr > F"))
        # An effect of exactly nothing comes out as the rounding of zero, of either sign, or as 0 / 0.
        if np.isfinite(f) and f >= 0.0:
            effects.append(Effect(name, f, int(dof), int(error), p, f * dof / (f * dof + error)))
    return effects
