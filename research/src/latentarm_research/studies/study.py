"""Studies: their definition, a request for one, and the runner."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from math import inf
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final, Generic, Protocol, TypeVar

from threadpoolctl import threadpool_limits

from latentarm.core.errors import UserError
from latentarm.core.figure_style import save_figure
from latentarm.core.files import write_text
from latentarm.core.parallel import check_jobs, run_grid
from latentarm.core.types import Row
from latentarm.core.untrusted.console import VisibleConsole
from latentarm.evaluation.results import as_document
from latentarm.runs.checks import check_seed
from latentarm.runs.results_folder import write_json
from latentarm_research.studies.backends import BACKENDS, check_backend
from latentarm_research.studies.page import HTML, PDF, SMOKE, html_page, print_page
from latentarm_research.studies.results_folder import ResultsFolder

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType

REPORTED: Final = ("results.json", "hypotheses.json", "results.md", HTML, PDF)
"""Files that every report is written to; `PDF` only where a browser prints it."""

ALWAYS_MADE: Final = (*REPORTED, "timings.json")  # files that every study writes
Cell = TypeVar("Cell")
Result = TypeVar("Result")


class Sizes(Protocol):
    """What every preset has."""

    @property
    def name(self) -> str:
        """What it is called on the command line."""
        ...


class HypothesisTest(Protocol):
    """A test of a hypothesis."""

    def as_json(self) -> dict[str, object]:
        """Plain mapping, ready for ``json.dumps``."""
        ...


Preset = TypeVar("Preset", bound=Sizes)
Measured = TypeVar("Measured")


@dataclass(frozen=True)
class Request(Generic[Preset]):
    """What a study was asked for. Raises a `UserError` where seed, jobs or backend are out of range."""

    out: Path  # a new folder, or that of an earlier run of this study, which is replaced
    preset: Preset  # sizes of the study
    tasks: tuple[str, ...] = ()  # which of the study's tasks; all of them where empty
    seed: int = 0  # of everything random
    jobs: int = -1  # processes side by side; -1 is one per core
    backend: str = "joblib"  # where they run, a name in `latentarm_research.studies.backends.BACKENDS`
    quiet: bool = False  # say nothing while working
    bars: bool = False  # show how far the grids are

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_jobs(self.jobs)
        check_backend(self.backend)


@dataclass(frozen=True)
class Keep(Generic[Cell, Result]):
    """How the results of cells are kept in a study's folder, so that it goes on where it was stopped."""

    path: Callable[[Path, Cell], Path]  # the file of a cell in the study's folder
    read: Callable[[Path, Cell], Result]  # what a file holds. Raises a `UserError` where it is damaged
    write: Callable[[Path, Cell, Result], None]  # writes it, whole or not at all

    def find(self, out: Path, cell: Cell) -> Result | None:
        """The kept result of a cell, or None before it has run."""
        path = self.path(out, cell)
        return self.read(path, cell) if path.exists() else None


class Grid:
    """Runs grids of cells as a request says, and keeps how long that took."""

    def __init__(self, request: Request[Any]) -> None:
        self._request = request
        self._console = VisibleConsole(stderr=True, quiet=request.quiet)
        self.took_s = 0.0

    def say(self, sentence: str) -> None:
        """Report progress on standard error."""
        self._console.print(sentence)

    def run(
        self,
        what: str,  # the grid in a few words
        function: Callable[[Cell], Result],  # measures one cell
        cells: Sequence[Cell],  # all of them, the longest first
        label: Callable[[Cell], str],  # what a cell is called when it fails or warns
        # where results are kept; those that are there are not measured again
        keep: Keep[Cell, Result] | None = None,
    ) -> list[Result]:
        """Measure cells side by side; see `latentarm.core.parallel.run_grid`.

        Linear algebra and torch have one thread each, since more of them add up in another order: figures are
        the same to the last bit in whatever process a cell is measured.
        """
        out = self._request.out
        found = [None if keep is None else keep.find(out, cell) for cell in cells]
        missing = [cell for cell, one in zip(cells, found, strict=True) if one is None]
        there = f", {len(cells) - len(missing)} of them kept from before" if len(missing) < len(cells) else ""
        self.say(f"{what}: {len(cells)} cells{there}.")
        began = perf_counter()
        measured = iter(
            run_grid(
                partial(_with_one_thread, function),
                missing,
                jobs=self._request.jobs,
                backend=BACKENDS[self._request.backend],
                label=label,
                bars=self._request.bars,
                keep=None if keep is None else lambda cell, one: keep.write(keep.path(out, cell), cell, one),
            )
        )
        self.took_s += perf_counter() - began
        return [next(measured) if one is None else one for one in found]


def _with_one_thread(function: Callable[[Cell], Result], cell: Cell) -> Result:
    with threadpool_limits(limits=1):
        return function(cell)


@dataclass(frozen=True)
class Report:
    """The results of a study."""

    rows: list[Row]  # for `results.json`
    page: str  # `results.md`, which HTML and PDF are made of
    figures: "Mapping[str, Figure]"  # PNGs by name, without suffix
    tests: Sequence[HypothesisTest] = ()  # of the hypotheses
    documents: Mapping[str, object] = field(default_factory=dict)  # further JSON files by name
    # the same for long lists of numbers, without line breaks
    records: Mapping[str, object] = field(default_factory=dict)
    tables: "Sequence[RenderableType]" = ()  # the study at a glance, for a terminal


@dataclass(frozen=True)
class Study(Generic[Preset, Measured]):
    """A study: what it measures and how it reports that."""

    name: str  # in rows and in the folder's `config.json`
    command: str  # the words after `latentarm` that run it
    presets: Mapping[str, Preset]  # sizes by name
    tasks: tuple[str, ...]  # names of all tasks; none where the request names what there is
    simulated: tuple[str, ...]  # what of it is simulated, for `config.json`
    measure: Callable[[Request[Preset], Grid], Measured]  # runs the study's grids
    # makes rows, page, figures and documents of what was measured
    report: Callable[[Request[Preset], Measured], Report]
    figures: tuple[str, ...]  # names of all figures that it may draw
    documents: tuple[str, ...] = ()  # names of all JSON files that it may write in addition to `ALWAYS_MADE`
    # what else the figures depend on, for `config.json`
    depends_on: Callable[[Request[Preset]], Mapping[str, object]] = lambda request: {}
    kept: tuple[str, ...] = ()  # folders of results of cells, see `Keep`
    options: tuple[str, ...] = ()  # names of the preset's fields that the command line may change
    # options that change no result of a kept cell: with the same `out` and other values of these, or other
    # tasks, a study goes on from what is kept
    grows: tuple[str, ...] = ()

    def about(self, request: Request[Preset]) -> dict[str, object]:
        """Everything that determines the figures; sizes without a limit are None."""
        entries = asdict(request.preset)  # pyright: ignore[reportArgumentType]
        sizes = {name: None if value == inf else value for name, value in entries.items()}
        return {
            "study": self.name,
            **{name: sizes.pop(name) for name in self.options},
            "preset": sizes,
            "tasks": list(request.tasks),
            "seed": request.seed,
            **dict.fromkeys(self.simulated, "simulated"),
            **self.depends_on(request),
        }


def run_study(study: Study[Preset, Measured], request: Request[Preset]) -> Report:
    """Measure every cell of a study and write figures, tables and tests to ``request.out``.

    ``results.json`` depends on preset, tasks and seed alone; how long it took stands in ``timings.json``.
    """
    request = _with_tasks(study, request)
    made = (*ALWAYS_MADE, *study.documents, *(f"{name}.png" for name in study.figures))
    about = study.about(request)
    grows = ("tasks", *study.grows) if study.kept else ()
    ResultsFolder(study.name, made, study.kept, grows).claim(request.out, about)
    grid = Grid(request)
    measured = study.measure(request, grid)
    grid.say("Drawing, testing the hypotheses, writing the page.")
    report = study.report(request, measured)
    if request.preset.name == SMOKE:
        report = replace(report, tests=())
    timings = {"backend": request.backend, "jobs": request.jobs, "grid_s": grid.took_s}
    write_json(request.out / "timings.json", timings)
    if why := write_report(request.out, report, about):
        grid.say(why)
    return report


def write_report(out: Path, report: Report, about: Mapping[str, object]) -> str:
    """Write figures, documents, and the page as Markdown, HTML and PDF; return why there is no PDF."""
    for name, figure in report.figures.items():
        save_figure(figure, out / f"{name}.png")
    write_text(out / "results.md", report.page)
    write_text(out / HTML, html_page(report.page, out))
    write_json(out / "hypotheses.json", [one.as_json() for one in report.tests])
    for name, document in report.documents.items():
        write_json(out / name, document)
    for name, record in report.records.items():
        write_text(out / name, json.dumps(record, separators=(",", ":"), allow_nan=False) + "\n")
    write_json(out / "results.json", as_document(report.rows, about))
    return print_page(out / HTML, out / PDF)


def again(study: Study[Preset, Any], request: Request[Preset]) -> str:
    """The command that repeats the study."""
    usual = study.presets.get(request.preset.name)
    words = [f" --task {task}" for task in request.tasks if request.tasks != study.tasks]
    for name in study.options:
        value = getattr(request.preset, name)
        if usual is not None and value != getattr(usual, name):
            words += [f" --{name} {one}" for one in (value if isinstance(value, tuple) else (value,))]
    return f"latentarm {study.command} --preset {request.preset.name}{''.join(words)} --seed {request.seed}"


def _with_tasks(study: Study[Preset, Any], request: Request[Preset]) -> Request[Preset]:
    """The request with all tasks where it names none."""
    if not study.tasks:
        return request
    if not request.tasks:
        return replace(request, tasks=study.tasks)
    names = ", ".join(study.tasks)
    for task in request.tasks:
        if task not in study.tasks:
            raise UserError(f"There is no task {task!r}: choose from {names}.")
    if len(set(request.tasks)) < len(request.tasks):
        raise UserError(f"Name no task twice: choose from {names}.")
    return request
