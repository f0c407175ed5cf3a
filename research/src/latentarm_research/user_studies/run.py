"""A run of a study with simulated people: their trials, and the analysis of these."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Final, TypeVar, final

from latentarm.core.errors import UserError
from latentarm.core.parallel.grid import check_processes, run_grid
from latentarm.core.untrusted.console import VisibleConsole
from latentarm.runs.checks import check_seed
from latentarm_research.people.population import draw_people
from latentarm_research.people.traits import Traits
from latentarm_research.studies.streams import generator
from latentarm_research.user_studies.analysis.analysis import Analysis, analyse
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs.catalogue import design_of
from latentarm_research.user_studies.folder_name import folder_name
from latentarm_research.user_studies.record import Trial
from latentarm_research.user_studies.session import SessionCell, go_through
from latentarm_research.user_studies.sizes import Sizes, Stream
from latentarm_research.user_studies.trace import Trace
from latentarm_research.user_studies.training import Trained, TrainingCell, train

FEWEST_PEOPLE: Final = 2

Cell = TypeVar("Cell")
Result = TypeVar("Result")


@final
@dataclass(frozen=True)
class Request:
    """What a run was asked for.

    Attributes:
        definition: of the study.
        sizes: of the run.
        people: how many simulated people go through it.
        out: a new folder, or that of an earlier run that asked for the same, which is replaced.
        seed: of everything random.
        jobs: processes side by side; -1 is one per core.
        backend: where they run, a name in `latentarm.core.parallel.backends.BACKENDS`.
        quiet: say nothing while working.
        bars: show how far the grids are.

    Raises:
        UserError: people, seed, jobs or backend are out of range.
    """

    definition: Definition
    sizes: Sizes
    people: int
    out: Path
    seed: int = 0
    jobs: int = -1
    backend: str = "joblib"
    quiet: bool = False
    bars: bool = False

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_processes(self.jobs, self.backend)
        if self.people < FEWEST_PEOPLE:
            raise UserError(
                f"A study needs {FEWEST_PEOPLE} people or more, not {self.people}: see --simulated."
            )

    @property
    def about(self) -> dict[str, object]:
        """What the figures depend on."""
        return {
            "study": folder_name(self.definition),
            "definition": self.definition.digest,
            "people": self.people,
            "people_are": "simulated",
            "sizes": self.sizes.as_json(),
            "seed": self.seed,
        }


@final
@dataclass(frozen=True, eq=False)
class Ran:
    """What came of a run.

    Attributes:
        definition: of the study.
        sizes: of the run.
        people: who went through it.
        trials: of all people.
        traces: of all trials, for figures.
        trained: models by task; empty where no condition has any.
        analysis: of the trials.
        grid_s: how long the grids took, s.
    """

    definition: Definition
    sizes: Sizes
    people: tuple[Traits, ...]
    trials: tuple[Trial, ...]
    traces: tuple[Trace, ...]
    trained: Mapping[str, Trained]
    analysis: Analysis
    grid_s: float


def send_people(request: Request) -> Ran:
    """Let simulated people go through a study, and analyse their trials. Writes nothing.

    Raises:
        UserError: a cell cannot be driven as asked, or the backend is not available.
    """
    definition = request.definition
    people = draw_people(request.people, request.seed)
    began = perf_counter()
    trained = {
        one.task: one
        for one in _run(
            request, "Demonstrations and models", train, _training_cells(request, people), _task_label
        )
    }
    cells = _session_cells(request, people, trained)
    sessions = _run(request, "Sessions of simulated people", go_through, cells, _session_label)
    grid_s = perf_counter() - began
    trials = tuple(trial for session in sessions for trial in session.trials)
    traces = tuple(trace for session in sessions for trace in session.traces)
    analysis = analyse(definition, trials, not_judged=request.sizes.not_judged)
    return Ran(definition, request.sizes, people, trials, traces, trained, analysis, grid_s)


def _training_cells(request: Request, people: tuple[Traits, ...]) -> list[TrainingCell]:
    definition = request.definition
    if not any(condition.model for condition in definition.conditions):
        return []
    return [
        TrainingCell(definition, task, people, request.sizes, request.seed)
        for task in definition.tasks
        if not task.trained_with
    ]


def _session_cells(
    request: Request, people: tuple[Traits, ...], trained: Mapping[str, Trained]
) -> list[SessionCell]:
    definition = request.definition
    rng = generator(request.seed, definition.name, Stream.ORDER)
    taken = design_of(definition).orders(definition, request.people, rng)
    return [
        SessionCell(
            definition,
            definition.condition(name),
            task,
            one,
            place,
            trained.get(task.trained_with or task.name),
            request.sizes,
            request.seed,
        )
        for one, order in zip(people, taken, strict=True)
        for place, name in enumerate(order)
        for task in definition.tasks
    ]


def _run(
    request: Request,
    what: str,
    function: Callable[[Cell], Result],
    cells: Sequence[Cell],
    label: Callable[[Cell], str],
) -> list[Result]:
    if not cells:
        return []
    VisibleConsole(stderr=True, quiet=request.quiet).print(f"{what}: {len(cells)} cells.")
    return run_grid(
        function, cells, jobs=request.jobs, backend=request.backend, label=label, bars=request.bars
    )


def _task_label(cell: TrainingCell) -> str:
    return f"models of {cell.task.label}"


def _session_label(cell: SessionCell) -> str:
    return f"simulated person {cell.traits.number + 1}, {cell.condition.name}, {cell.task.label}"
