"""From what cells measured to the study's rows, with what the paper prints in section 8.2.

It prints two figures: how much more time LA takes than LA+SA on the Franka Emika, a Panda. All its other
results are curves without printed numbers.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.measures import unit_of
from latentarm_research.studies.shared_autonomy.cell import WITH_HELP, WITHOUT_HELP, AutonomyResult
from latentarm_research.studies.shared_autonomy.intervals import Interval, interval

EXTRA_TIME: Final = "extra_time_percent"
"""The measure: how much more time LA takes to reach the goal than LA+SA."""

MODEL: Final = "cae"
"""The model of the paper's study; equation 16, with lambda_1 above 0, is the cVAE's."""

PAPER: Final = {
    ("panda_two_cups", MODEL, EXTRA_TIME, "beta 75"): 45.0,
    ("panda_two_cups", MODEL, EXTRA_TIME, "beta 1000"): 30.0,
}
"""By task, model, measure and condition, %."""


STUDY: Final = "shared_autonomy"

RECONSTRUCTION: Final = "noise_free_error_percent_of_pca"


class Figure(NamedTuple):
    """One figure of the study, before it is summed up."""

    task: str
    model: str
    condition: str  # what was varied: method and person, or variant
    measure: str  # what was measured
    values: FloatArray  # (S, P), of each drive with each seed's model; (S, 1) where it is the model's own

    @property
    def interval(self) -> Interval:
        """Mean and 95 % interval."""
        return interval(self.values)


def figures(results: Sequence[AutonomyResult]) -> list[Figure]:
    """Every figure: the study proper in its order, then the ablations."""
    ordered = sorted(results, key=lambda one: one.cell.variant is not None)
    return [figure for result in ordered for figure in _figures(result)]


def rows_of(found: Iterable[Figure]) -> list[Row]:
    """One row per figure, with the paper's if it prints one; mean and SD are over `Interval.over`."""
    rows: list[Row] = []
    for figure in found:
        over = figure.interval
        place = figure.task, figure.model, figure.measure, figure.condition
        rows.append(
            Row(
                study=STUDY,
                measure=figure.measure,
                unit=unit_of(figure.measure),
                mean=over.mean,
                sd=over.sd if over.n > 1 else None,
                n=over.n,
                task=figure.task,
                model=figure.model,
                condition=figure.condition,
                paper_mean=PAPER.get(place),
            )
        )
    return rows


def _figures(result: AutonomyResult) -> Iterator[Figure]:
    """Of one cell; those of an ablation name the variant and not the method."""
    cell = result.cell
    trained = cell.variant or ("without entropy" if cell.entropy is None else "with entropy")
    yield Figure(cell.task, cell.model, trained, RECONSTRUCTION, result.reconstruction[:, None])
    for outcome in result.outcomes:
        condition = f"{cell.variant or outcome.method}, {outcome.person.label}"
        for measure, values in outcome.figures.items():
            yield Figure(cell.task, cell.model, condition, measure, values)
    if cell.variant is None:
        yield from _extra_times(result)


def _extra_times(result: AutonomyResult) -> Iterator[Figure]:
    """How much more time LA takes than LA+SA with the same model, seed by seed, for each person, %."""
    times = {(one.method, one.person.label): one.figures["time_s"].mean(axis=1) for one in result.outcomes}
    for method, person in times:
        if method == WITHOUT_HELP and (WITH_HELP, person) in times:
            extra = 100.0 * (times[method, person] / times[WITH_HELP, person] - 1.0)
            yield Figure(result.cell.task, result.cell.model, person, EXTRA_TIME, extra[:, None])
