"""Fit the SIMULATED people to half of the persons of a public study, and predict the other half.

The study is AutonomyFitts (Pan et al., HRI 2025): 24 people move a Franka's tool by a Falcon from target to
target on rings, 0.118 or 0.236 m apart and 0.01 or 0.02 m wide. Only trials without autonomy count. Nothing
of it is shipped here: fetch mpan31415/AutonomyFitts from GitHub. A fit takes hours.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from functools import cache
from typing import Any, Final

import numpy as np
from scipy.stats import norm

from latentarm.core.types import FloatArray
from latentarm_research.measurements.catalogue import People
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.measurements.ring_movements import (
    CORRECTIONS,
    ERROR,
    PERSON,
    RING,
    RINGS,
    SEED,
    TIME,
    TRIAL,
    Figures,
    logged,
    simulated,
)

NAMES: Final = ("push_variation", "decision_s", "full_m_s", "learning", "own_speed_width")
"""What is fitted, in turn; then the first three once more."""

FACTORS: Final = (0.7, 1.4)  # steps of the fit


class Prediction:
    """Of single movements, by others: log-normal times and errors, and corrections up to 6, in each cell.

    With `lines`, the logarithms follow lines over the index of difficulty instead, as in Fitts's law.
    """

    def __init__(self, rows: FloatArray, lines: bool = False) -> None:
        logs, counts, cells, _ = _taken_apart(rows)
        each = [cells == one for one in range(8)]
        self._middle = np.array([logs[one].mean(axis=0) for one in each])
        self._width = np.array([logs[one].std(axis=0, ddof=1) for one in each])
        if lines:
            bits = np.log2(2.0 * RINGS[:, 0] * np.sin(4.0 * np.pi / 9.0) / RINGS[:, 1] + 1.0)
            line = np.polyfit(bits[cells % 4], logs, 1)
            self._middle = np.tile(np.outer(bits, line[0]) + line[1], (2, 1))
            self._width = np.tile((logs - self._middle[cells]).std(axis=0, ddof=2), (8, 1))
        shares = np.array([np.bincount(counts[one], minlength=7) + 0.5 for one in each])
        self._shares = shares / shares.sum(axis=1, keepdims=True)
        self._persons = _taken_apart(rows)[3]

    def scores(self, rows: FloatArray) -> FloatArray:
        """Log densities (N, 3) of the logarithms of time and error, and of corrections, nats."""
        logs, counts, cells, _ = _taken_apart(rows)
        normal = norm.logpdf(logs, self._middle[cells], self._width[cells])
        return np.column_stack([normal, np.log(self._shares[cells, counts])])

    def figures(self, rows: FloatArray) -> dict[str, Any]:
        """How well a movement is predicted, in time, error and corrections: nats, and intervals' coverage.

        Of persons, how many mean logarithms of time the intervals over persons cover.
        """
        logs, counts, cells, persons = _taken_apart(rows)
        found: dict[str, Any] = {"nats": self.scores(rows).mean(axis=0).tolist()}
        share, below = (
            norm.cdf(logs, self._middle[cells], self._width[cells]),
            np.cumsum(self._shares, axis=1),
        )
        for size in (0.5, 0.9):
            low, high = 0.5 - size / 2.0, 0.5 + size / 2.0
            least, most = (below < low).sum(axis=1)[cells], (below < high).sum(axis=1)[cells]
            inside = np.column_stack([(share >= low) & (share <= high), (counts >= least) & (counts <= most)])
            found[f"covered_{size}"] = inside.mean(axis=0).tolist()
            ends = norm.ppf([low, high], self._persons.mean(), self._persons.std(ddof=1))
            found[f"persons_{size}"] = int(((persons >= ends[0]) & (persons <= ends[1])).sum())
        return found


def _taken_apart(rows: FloatArray) -> tuple[Any, ...]:
    """Logarithms of time and error, corrections up to 6, cells; and persons' mean logarithms of time."""
    logs, counts = np.log(rows[:, [TIME, ERROR]]), np.minimum(rows[:, CORRECTIONS], 6).astype(int)
    persons = np.array([logs[rows[:, PERSON] == one, 0].mean() for one in np.unique(rows[:, PERSON])])
    return logs, counts, (rows[:, RING] + 4 * (rows[:, TRIAL] > 12)).astype(int), persons


def climbed(figures: Figures, names: Sequence[str], score: Callable[[Figures], float]) -> Figures:
    """Figures that score better: each in turn is multiplied for as long as that helps."""
    best = score(figures)
    for name in names:
        begun = best
        for factor in FACTORS:
            improves = best == begun
            while improves:
                tried = replace(figures, **{name: round(getattr(figures, name) * factor, 4)})
                scored = score(tried)
                improves = scored > best
                if improves:
                    figures, best = tried, scored
    return figures


def measure(options: People, work: Work) -> Outcome:
    """How well held-out persons are predicted: by a line, by other persons, by simulated people."""
    rows = logged(options.clone)
    chosen = np.random.default_rng(SEED).permutation(24)[:12]
    fitted, held_out = (rows[np.isin(rows[:, PERSON], chosen) == one] for one in (True, False))
    trials = [
        sorted({(int(one[TRIAL]), int(one[RING])) for one in rows[rows[:, PERSON] == person]})
        for person in range(24)
    ]

    @cache
    def score(figures: Figures) -> float:
        by = Prediction(simulated(figures, options.people, trials))
        return float(by.scores(fitted).sum(axis=1).mean())

    # How fast the device is at full deflection says nothing of people: it is fitted for those of before too.
    before = climbed(Figures(0.35), ["full_m_s"], score)
    after = climbed(before, (*NAMES, *NAMES[:3]), score)
    by = {
        "a line over difficulty": Prediction(fitted, lines=True),
        "the persons fitted to": Prediction(fitted),
        "simulated people as they are": Prediction(simulated(before, 4 * options.people, trials)),
        "simulated people, fitted": Prediction(simulated(after, 4 * options.people, trials)),
    }
    found = {name: one.figures(held_out) for name, one in by.items()}
    document = {
        "fitted_persons": sorted(int(one) + 1 for one in chosen),
        "movements": [len(fitted), len(held_out)],
        "before": asdict(before),
        "after": asdict(after),
        "held_out": found,
    }
    table = [
        row
        for name, figures in found.items()
        for row in line("people", name, len(held_out), _columns(figures))
    ]
    return Outcome(table, documents={"people.json": document})


def _columns(figures: Mapping[str, Any]) -> dict[str, float]:
    """Nats and the coverage of 90 % intervals, in time, error and corrections."""
    names = ("time", "error", "corrections")
    nats = {f"{name}_nats": one for name, one in zip(names, figures["nats"], strict=True)}
    covered = {
        f"{name}_in_90_percent": 100.0 * one for name, one in zip(names, figures["covered_0.9"], strict=True)
    }
    return nats | covered
