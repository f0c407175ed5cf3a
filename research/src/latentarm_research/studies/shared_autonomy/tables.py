"""From what cells measured to the study's rows and tables, means of clusters of drives, with the paper's.

Drives with one trained model are one cluster. Section 8.2 prints two figures: how much more time LA takes
than LA+SA on the Franka Emika, a Panda. All its other results are curves without printed numbers.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple, final

from scipy import stats

from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.measures import unit_of
from latentarm.evaluation.table import ABSENT, format_figure
from latentarm_research.studies.shared_autonomy.cell import METHODS, WITH_HELP, WITHOUT_HELP, AutonomyResult
from latentarm_research.studies.shared_autonomy.preset import Preset
from latentarm_research.studies.statistics import CONFIDENCE, bootstrap_interval
from latentarm_research.studies.tables import grid_table, heading

FEWEST_SEEDS: Final = 3
"""From this many on, seeds are the units; with fewer there is no spread to estimate, so drives are."""


@dataclass(frozen=True)
class Interval:
    """A mean and what it could well be."""

    mean: float  # over the units
    sd: float  # over the units; 0 for one unit
    n: int  # units
    over: Literal["seeds", "drives"]  # what they are

    @property
    def half_width(self) -> float:
        """Of the interval for the mean by Student's t, ``t sd / sqrt(n)``; 0 for one unit."""
        return student(self.n) * self.sd / self.n**0.5

    @property
    def low(self) -> float:
        """Lower end of the interval."""
        return self.mean - self.half_width

    @property
    def high(self) -> float:
        """Upper end of the interval."""
        return self.mean + self.half_width


def interval(
    values: FloatArray,  # (S, P), of S seeds' P drives; (S, 1) for figures of the seeds themselves
) -> Interval:
    """Mean and interval over the seeds' means, or over all drives of fewer than `FEWEST_SEEDS` seeds."""
    seeds = len(values) >= FEWEST_SEEDS or values.shape[1] == 1
    units = values.mean(axis=1) if seeds else values.reshape(-1)
    return Interval(
        mean=float(units.mean()),
        sd=float(units.std(ddof=1)) if len(units) > 1 else 0.0,
        n=len(units),
        over="seeds" if seeds else "drives",
    )


def student(n: int) -> float:
    """How many standard errors an interval over n units reaches to each side."""
    return float(stats.t.ppf((1.0 + CONFIDENCE) / 2.0, n - 1)) if n > 1 else 0.0


def band(courses: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The mean of S seeds over time, (S, T), and the ends of its 95 % bootstrap interval, each (T,).

    The mean alone for fewer than three.
    """
    mean = courses.mean(axis=0)
    return (mean, *bootstrap_interval(courses)) if len(courses) >= FEWEST_SEEDS else (mean, mean, mean)


EXTRA_TIME: Final = "extra_time_percent"
"""The measure: how much more time LA takes to reach the goal than LA+SA."""

MODEL: Final = "cae"  # the model of the paper's study; equation 16, with lambda_1 above 0, is the cVAE's

PAPER: Final = {
    ("panda_two_cups", MODEL, EXTRA_TIME, "beta 75"): 45.0,
    ("panda_two_cups", MODEL, EXTRA_TIME, "beta 1000"): 30.0,
}
"""By task, model, measure and condition, %."""


STUDY: Final = "shared_autonomy"


class Figure(NamedTuple):
    """One figure of the study, before it is summed up."""

    task: str
    model: str
    condition: str  # method and person
    measure: str  # what was measured
    values: FloatArray  # (S, P), of each drive with each seed's model; (S, 1) of the seeds themselves

    @property
    def interval(self) -> Interval:
        """Mean and 95 % interval."""
        return interval(self.values)


def figures(results: Sequence[AutonomyResult]) -> list[Figure]:
    """Every figure, in the order of the results."""
    return [figure for result in results for figure in _figures(result)]


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
    cell = result.cell
    for outcome in result.outcomes:
        condition = f"{outcome.method}, {outcome.person.label}"
        for measure, values in outcome.figures.items():
            yield Figure(cell.task, cell.model, condition, measure, values)
    yield from _extra_times(result)


def _extra_times(result: AutonomyResult) -> Iterator[Figure]:
    """How much more time LA takes than LA+SA with the same model, seed by seed, for each person, %."""
    times = {(one.method, one.person.label): one.figures["time_s"].mean(axis=1) for one in result.outcomes}
    for method, person in times:
        if method == WITHOUT_HELP and (WITH_HELP, person) in times:
            extra = 100.0 * (times[method, person] / times[WITH_HELP, person] - 1.0)
            yield Figure(result.cell.task, result.cell.model, person, EXTRA_TIME, extra[:, None])


@final
class Tables:
    """The tables of the page, in Markdown: means with their intervals."""

    def __init__(self, found: Sequence[Figure], preset: Preset) -> None:
        self._found = {(one.task, one.model, one.condition, one.measure): one for one in found}
        self._people = {person.label: person.label for person in preset.people}
        self._models = list(dict.fromkeys(one.model for one in found))

    def people(self, task: str, model: str, measure: str) -> str:
        """One measure with one model: people down, methods across."""

        def text(person: str, method: str) -> str:
            return self._figure(task, model, f"{method}, {person}", measure)

        return grid_table(heading(measure), self._people, {name: name for name in METHODS}, text)

    def extra_time(self, task: str) -> str:
        """How much more time LA takes than LA+SA, with the paper's figures."""

        def text(person: str, model: str) -> str:
            printed = PAPER.get((task, model, EXTRA_TIME, person))
            beside = "" if printed is None else f" (paper: {printed:g})"
            return self._figure(task, model, person, EXTRA_TIME) + beside

        models = {look_of(model).label: model for model in self._models}
        return grid_table(heading(EXTRA_TIME), self._people, models, text)

    def _figure(self, task: str, model: str, condition: str, measure: str) -> str:
        one = self._found.get((task, model, condition, measure))
        return ABSENT if one is None else format_figure(one.interval.mean, one.interval.half_width)
