"""Targets for a model for real arms, relative to the cAE."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from latentarm.metrics.looks import look_of
from latentarm.studies.compare.preset import REFERENCE
from latentarm.studies.compare.rows import condition
from latentarm.types import Row

Means = Mapping[str, float]
"""Measure -> mean of one model, on one dataset under one noise."""


@dataclass(frozen=True)
class Target:
    """One target of a model.

    Attributes:
        name: what is asked, in words.
        measures: what it is asked of.
        met: of our means and the reference's.
        scale: by which figures are multiplied to be shown.
        unit: in which they are shown.
        relative: whether it depends on the reference's figure, which is then shown too.
    """

    name: str
    measures: tuple[str, ...]
    met: Callable[[Means, Means], bool]
    scale: float = 1.0
    unit: str = ""
    relative: bool = False


@dataclass(frozen=True)
class Verdict:
    """The result of one target.

    Attributes:
        target: its name.
        dataset: where.
        noise_rad: under which noise, rad.
        met: whether it was met.
        said: the figures.
    """

    target: str
    dataset: str
    noise_rad: float
    met: bool
    said: str


def _most(measure: str, limit: float) -> Callable[[Means, Means], bool]:
    return lambda ours, _: ours[measure] <= limit


TARGETS: Final = (
    Target(
        f"error ≤ 1.05 × {look_of(REFERENCE).label}'s",
        ("error_percent_of_pca",),
        lambda ours, other: ours["error_percent_of_pca"] <= 1.05 * other["error_percent_of_pca"],
        unit=" %",
        relative=True,
    ),
    Target(
        f"noise-free error ≤ {look_of(REFERENCE).label}'s",
        ("noise_free_error_percent_of_pca",),
        lambda ours, other: (
            ours["noise_free_error_percent_of_pca"] <= other["noise_free_error_percent_of_pca"]
        ),
        unit=" %",
        relative=True,
    ),
    Target("drift 0", ("drift",), _most("drift", 1e-9), scale=100.0, unit=" %"),
    Target("reversal ≤ 5 %", ("reversal",), _most("reversal", 0.05), scale=100.0, unit=" %"),
    Target(
        "local R² ≥ 0.97 on both axes",
        ("r2_local_axis_0", "r2_local_axis_1"),
        lambda ours, _: min(ours["r2_local_axis_0"], ours["r2_local_axis_1"]) >= 0.97,
    ),
    Target("greedy reach ≤ 10 mm", ("controllability_m",), _most("controllability_m", 0.010), 1e3, " mm"),
    Target(
        f"planned reach ≤ {look_of(REFERENCE).label}'s",
        ("planned_reach_m",),
        lambda ours, other: ours["planned_reach_m"] <= other["planned_reach_m"],
        scale=1e3,
        unit=" mm",
        relative=True,
    ),
)


def verdicts(
    rows: Sequence[Row], ours: str, datasets: Sequence[str], noises_rad: Sequence[float]
) -> list[Verdict]:
    """Every target on every dataset under every noise; means are compared.

    Args:
        rows: see `rows_of`.
        ours: the model that is judged.
        datasets: names.
        noises_rad: rad.

    Returns:
        Target by target; empty if `ours` or the reference was not compared.
    """
    found: list[Verdict] = []
    for target in TARGETS:
        for dataset in datasets:
            for noise_rad in noises_rad:
                mine, other = (_means(rows, dataset, noise_rad, model) for model in (ours, REFERENCE))
                if set(target.measures) <= mine.keys() & other.keys():
                    said = _said(target, mine)
                    if target.relative:
                        said += f" ({look_of(REFERENCE).label} {_said(target, other)})"
                    found.append(Verdict(target.name, dataset, noise_rad, target.met(mine, other), said))
    return found


def _means(rows: Sequence[Row], dataset: str, noise_rad: float, model: str) -> Means:
    return {
        row.measure: row.mean
        for row in rows
        if (row.task, row.model, row.condition) == (dataset, model, condition(noise_rad))
        and row.mean is not None
    }


def _said(target: Target, means: Means) -> str:
    return ", ".join(f"{target.scale * means[measure]:.3g}{target.unit}" for measure in target.measures)
