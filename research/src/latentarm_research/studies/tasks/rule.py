"""The rule by which the default decoder is chosen from the study's runs (docs/decisions/0041)."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from statistics import median
from typing import Final, final

from scipy.stats import fisher_exact

from latentarm.tasks.catalogue import SCENE_TASKS
from latentarm_research.studies.tables import listed, markdown_table
from latentarm_research.studies.tasks.preset import SWITCHING, Condition
from latentarm_research.studies.tasks.rows import ByTask
from latentarm_research.studies.tasks.runs import Run, time_ratios

PRACTISED: Final = ("planning", "greedy", "unsteady")
"""People who know what the stick does: a decoder may make no task worse for them than mode switching is."""

PEOPLE: Final = (*PRACTISED, "learning", "reading")  # people whose runs count
LEAST: Final = 4  # runs that each person needs at each task with each candidate and by mode switching
TIED: Final = 0.02  # candidates that have this share fewer successes than the best have as many

CHANCE: Final = 0.05
"""Fewer successes than by mode switching are no chance where Fisher's exact p is below this."""

SWITCHED: Final = Condition(SWITCHING)


@final
@dataclass(frozen=True)
class Standing:
    """How a candidate did."""

    name: str  # its label
    succeeded: int  # runs that did, over all people and tasks
    of: int  # how many there were; the same for all candidates
    # median time relative to mode switching by the same person at the same task, over runs that both
    # finished, to two decimals; None where there is none
    time_ratio: float | None
    fit_s: float  # how long it trained for all tasks, s
    worse_at: tuple[str, ...]  # tasks at which practised people succeeded less often than by mode switching


@final
@dataclass(frozen=True)
class DefaultVerdict:
    """What the rule says."""

    sentence: str  # in words
    chosen: str | None = None  # label of the default decoder; None where it is not decided
    standings: tuple[Standing, ...] = ()  # of all candidates; none where there are too few runs

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        return asdict(self)

    def table(self) -> str:
        """The candidates for the page; empty without any."""
        lines = [
            [
                one.name,
                f"{one.succeeded} of {one.of}",
                None if one.time_ratio is None else f"{one.time_ratio:.2f}",
                f"{one.fit_s:.0f}",
                listed(one.worse_at) or None,
            ]
            for one in self.standings
        ]
        head = ["candidate, simulated", "succeeded", "time / mode switching", "training (s)", "worse at"]
        return markdown_table(head, lines) if lines else ""


def decide(
    by_task: ByTask,
    fit_s: Mapping[Condition, float],  # the candidates, and how long each trained for all tasks, s
    tasks: Sequence[str] = (*SCENE_TASKS,),
) -> DefaultVerdict:
    """Apply the rule."""
    cells = [(task, what.by(person)) for task in tasks for what in (SWITCHED, *fit_s) for person in PEOPLE]
    counts = {cell: len(by_task.get(cell[0], {}).get(cell[1], ())) for cell in cells}
    task, what = fewest = min(cells, key=lambda cell: counts[cell])
    if not fit_s or counts[fewest] < LEAST:
        where = f"{task}, {what.person}, {what.label}"
        return DefaultVerdict(f"not decided: {counts[fewest]} runs per cell ({where}), {LEAST} needed")
    standings = tuple(_standing(by_task, what, tasks, fit_s[what], counts[fewest]) for what in fit_s)
    left = [one for one in standings if not one.worse_at]
    if not left:
        return DefaultVerdict(
            "not decided: every candidate makes a task worse than mode switching", None, standings
        )
    most = max(one.succeeded for one in left)
    tied = [one for one in left if one.succeeded >= (1.0 - TIED) * most]
    best = min(tied, key=lambda one: (one.time_ratio is None, one.time_ratio, one.fit_s))
    return DefaultVerdict(
        f"{best.name} ({len(tied)} of {len(standings)} candidates tied)", best.name, standings
    )


def _standing(by_task: ByTask, what: Condition, tasks: Sequence[str], fit_s: float, runs: int) -> Standing:
    """How a candidate did, from the first runs, of which all have as many."""

    def first(task: str, condition: Condition) -> list[Run]:
        return [run for run in by_task[task][condition] if run.number < runs]

    mine = {(task, person): first(task, what.by(person)) for task in tasks for person in PEOPLE}
    ratios = [
        ratio
        for (task, person), of in mine.items()
        for ratio in time_ratios(of, by_task[task][SWITCHED.by(person)])
    ]
    worse = tuple(
        task
        for task in tasks
        if _fewer(
            [run for person in PRACTISED for run in by_task[task][what.by(person)]],
            [run for person in PRACTISED for run in by_task[task][SWITCHED.by(person)]],
        )
    )
    succeeded = [run.success for of in mine.values() for run in of]
    ratio = round(median(ratios), 2) if ratios else None
    return Standing(what.label, sum(succeeded), len(succeeded), ratio, fit_s, worse)


def _fewer(mine: Sequence[Run], switched: Sequence[Run]) -> bool:
    """Whether fewer runs succeed than by mode switching, beyond chance."""
    done, other = (sum(run.success for run in of) for of in (mine, switched))
    table = [[done, len(mine) - done], [other, len(switched) - other]]
    p = float(fisher_exact(table)[1])  # pyright: ignore[reportArgumentType]
    return done / len(mine) < other / len(switched) and p < CHANCE
