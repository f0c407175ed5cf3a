"""H1 of section 8.1 on recorded demonstrations: do models that see the context reconstruct actions better?

The paper tests it on simulated tasks that were made so that the context decides. Here each model that sees
the context is compared with the same one that does not, on the same folds, once through the encoder
networks and once with the nearest inputs: a test for each pair, dataset, noise and way of encoding, paired
over folds, of the means over seeds. One family per way of encoding.

Targets for a model for real arms compare means, some with other models'. Errors are of the nearest input.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.claims import Claim, Tested, corrected_by_family
from latentarm_research.studies.compare.cell import FoldResult
from latentarm_research.studies.compare.preset import BASELINE, REFERENCE
from latentarm_research.studies.compare.tables import condition
from latentarm_research.studies.statistics import paired
from latentarm_research.studies.targets import Target

PAIRS: Final = (("cae", "ae"), ("cvae", "vae"))  # a model that sees the context, and the same without

ENCODINGS: Final = {
    "error_percent_of_pca": "encoder network",
    "search_error_percent_of_pca": "nearest input",
}
"""Measure -> family of tests."""

HYPOTHESIS: Final = "H1"


def compared(results: Sequence[FoldResult]) -> list[Tested]:
    """Every test, after Holm's correction within its family."""
    places = dict.fromkeys((one.place.dataset, one.place.noise_rad) for one in results)
    found: list[Tested] = []
    for (measure, family), (sees, does_not), place in product(ENCODINGS.items(), PAIRS, places):
        values, reference = (_over_folds(results, *place, model, measure) for model in (sees, does_not))
        if len(values) == len(reference) > 0:
            claim = Claim(measure, (sees,), (does_not,), "less", (place[0],))
            one = Tested(hypothesis=HYPOTHESIS, claim=claim, family=family, where=condition(place[1]))
            found.append(one.of(values, reference, paired(values, reference, "less")))
    return corrected_by_family(found)


def _over_folds(
    results: Sequence[FoldResult], dataset: str, noise_rad: float, model: str, measure: str
) -> FloatArray:
    """Means over seeds, (folds,), in the order of the folds."""
    cells = [
        one
        for one in results
        if (one.place.dataset, one.place.noise_rad, one.place.model) == (dataset, noise_rad, model)
    ]
    return np.array(
        [one.figures[measure].mean() for one in sorted(cells, key=lambda one: one.place.fold)], dtype=float
    )


def h1_sentences(tests: Sequence[Tested]) -> list[str]:
    """The direction of the difference, one sentence for each way of encoding."""
    sentences: list[str] = []
    for family in dict.fromkeys(one.family for one in tests):
        here = [one for one in tests if one.family == family]
        lower = sum((one.mean or 0.0) < (one.mean_against or 0.0) for one in here)
        holds = sum(one.says == "held" for one in here)
        sentences.append(
            f"With the {family}, the model that sees the context has the lower mean error in {lower} of"
            f" {len(here)} comparisons, significantly in {holds}, and the other in {len(here) - lower}; H1 is"
            f" {'supported' if holds == len(here) else 'not supported throughout'}."
        )
    return sentences


Means = Mapping[str, float]  # measure, or `FIT_S`, -> mean of one model, on one dataset under one noise

FIT_S: Final = "fit_s"
"""Processor time of a fit among the means, s. It is no measure: it depends on the machine."""

FitTimes = Mapping[tuple[str, float, str], float]  # dataset, noise and model -> processor time of a fit, s


@dataclass(frozen=True)
class ModelTarget:
    """One target of a model."""

    name: str  # what is asked, in words
    measures: tuple[str, ...]  # what it is asked of
    met: Callable[[Means, Means], bool]  # of our means and the other model's
    # the model that it is relative to, whose figure is then shown too; None for none. A model is not judged
    # by itself
    other: str | None = None
    scale: float = 1.0  # by which figures are multiplied to be shown
    unit: str = ""  # in which they are shown


def _at_most(name: str, measure: str, limit: float, scale: float = 1.0, unit: str = "") -> ModelTarget:
    return ModelTarget(name, (measure,), lambda ours, _: ours[measure] <= limit, scale=scale, unit=unit)


def _no_more_than(
    other: str, what: str, measure: str, scale: float = 1.0, unit: str = "", share: float = 1.0
) -> ModelTarget:
    """At most the other model's figure, or a share of it."""
    asked = "" if share == 1.0 else f"{share:g} × "
    return ModelTarget(
        f"{what} ≤ {asked}{look_of(other).label}'s",
        (measure,),
        lambda ours, its: ours[measure] <= share * its[measure],
        other=other,
        scale=scale,
        unit=unit,
    )


ERROR: Final = "search_error_percent_of_pca"
CLEAN_ERROR: Final = "search_noise_free_error_percent_of_pca"

TARGETS: Final = (
    _no_more_than(BASELINE, "error", ERROR, unit=" %"),
    _no_more_than(BASELINE, "noise-free error", CLEAN_ERROR, unit=" %"),
    _no_more_than(REFERENCE, "error", ERROR, unit=" %"),
    _no_more_than(REFERENCE, "noise-free error", CLEAN_ERROR, unit=" %"),
    _at_most("drift 0", "drift", 1e-9, 100.0, " %"),
    _at_most("reversal ≤ 5 %", "reversal", 0.05, 100.0, " %"),
    ModelTarget(
        "local R² ≥ 0.97 on both axes",
        ("r2_local_axis_0", "r2_local_axis_1"),
        lambda ours, _: min(ours["r2_local_axis_0"], ours["r2_local_axis_1"]) >= 0.97,
    ),
    _at_most("joints' turn per stick's ≤ 1.5", "motion_turn", 1.5),
    _no_more_than(REFERENCE, "greedy reach", "controllability_m", 1e3, " mm"),
    _at_most("planned reach ≤ 0.2 mm", "planned_reach_m", 2e-4, 1e3, " mm"),
    _no_more_than(BASELINE, "training time", FIT_S, unit=" s", share=0.5),
)


def verdicts(
    rows: Sequence[Row],  # see `rows_of`
    ours: str,
    datasets: Sequence[str],
    noises_rad: Sequence[float],  # rad
    fit_times: FitTimes,
) -> list[Target]:
    """Every target on every dataset under every noise; means are compared.

    Returns:
        Target by target, without those that are relative to a model that was not compared, or to itself.
    """
    found: list[Target] = []
    for target in TARGETS:
        if target.other == ours:
            continue
        for dataset in datasets:
            for noise_rad in noises_rad:
                mine, other = (
                    _means(rows, fit_times, dataset, noise_rad, model) for model in (ours, target.other)
                )
                known = mine.keys() if target.other is None else mine.keys() & other.keys()
                if set(target.measures) <= known:
                    said = _figures(target, mine)
                    if target.other is not None:
                        said += f" ({look_of(target.other).label} {_figures(target, other)})"
                    where = (f"{dataset}, {noise_rad:g} rad",)
                    found.append(Target(target.name, target.met(mine, other), said, where))
    return found


def _means(
    rows: Sequence[Row], fit_times: FitTimes, dataset: str, noise_rad: float, model: str | None
) -> Means:
    means = {
        row.measure: row.mean
        for row in rows
        if (row.task, row.model, row.condition) == (dataset, model, condition(noise_rad))
        and row.mean is not None
    }
    took = fit_times.get((dataset, noise_rad, model or ""))
    return means if took is None else {**means, FIT_S: took}


def _figures(target: ModelTarget, means: Means) -> str:
    return ", ".join(f"{target.scale * means[measure]:.3g}{target.unit}" for measure in target.measures)
