"""From figures per seed or per drive to the rows that every command prints."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from latentarm.types import Row

UNITS: dict[str, str] = {
    "error": "rad^2/s^2",
    "noise_free_error": "rad^2/s^2",
    "error_percent_of_pca": "%",
    "noise_free_error_percent_of_pca": "%",
    "controllability_m": "m",
    "controllability_percent_of_pca": "%",
    "controllability_state_error": "rad",
    "planned_reach_m": "m",
    "start_distance_m": "m",
    "r2": "1",
    "r2_local": "1",
    "disentanglement_deg": "deg",
    "drift": "1",
    "reversal": "1",
    "motion_turn": "1",
    "motion_turn_p95": "1",
    "tool_turn": "1",
    "tool_turn_p95": "1",
    "success_rate": "1",
    "time_s": "s",
    "input_magnitude": "s",
    "mode_switches": "1",
    "path_length": "m",
    "path_over_straight": "1",
    "undone_share": "1",
    "demonstrated_undone_share": "1",
    "progress": "1",
    "final_distance": "m",
    "relative_alignment_error": "1",
    "answers": "1",
    "final_state_error": "1",
    "final_tool_error": "1",
    "arrival_rate": "1",
    "extra_time_percent": "%",
    "final_belief": "1",
    "goal_entropy": "nat",
    "goal_open_share": "1",
    "certified_share_eq_14": "1",
    "certified_share_eq_13": "1",
    "certified_share_known_help": "1",
}
"""Unit of every measure of this package; "1" is a plain number or ratio."""

HEADLINE: tuple[str, ...] = (
    "error_percent_of_pca",
    "noise_free_error_percent_of_pca",
    "controllability_m",
    "r2",
    "r2_local",
    "disentanglement_deg",
    "drift",
    "reversal",
)
"""The measures by which models are compared at a glance; the others are details of these."""


@dataclass(frozen=True)
class Subject:
    """What a row is about.

    Attributes:
        study: the command or simulation that took the figures.
        task: what was done, or None.
        model: the model's name, or None.
        condition: what was varied, or None.
    """

    study: str
    task: str | None = None
    model: str | None = None
    condition: str | None = None


def unit_of(measure: str) -> str:
    """Unit of a measure, of a single latent axis (``r2_axis_0``) too."""
    return UNITS[measure.rpartition("_axis_")[0] or measure]


def headline(rows: Iterable[Row]) -> list[Row]:
    """Only the rows of the `HEADLINE` measures, for a figure or a short table."""
    return [row for row in rows if row.measure in HEADLINE]


def summarise(subject: Subject, measure: str, values: ArrayLike) -> Row:
    """Mean and sample SD over runs.

    Args:
        subject: what the row is about.
        measure: a name that `unit_of` knows.
        values: (n,), one figure per run; runs without one (NaN) are left out and not counted.

    Returns:
        A row with SD absent for a single run, and mean absent where no run has a figure.
    """
    known = np.asarray(values, dtype=np.float64).reshape(-1)
    known = known[np.isfinite(known)]
    return Row(
        study=subject.study,
        measure=measure,
        unit=unit_of(measure),
        mean=float(known.mean()) if len(known) else None,
        sd=float(known.std(ddof=1)) if len(known) > 1 else None,
        n=len(known),
        task=subject.task,
        model=subject.model,
        condition=subject.condition,
    )
