"""`latentarm reproduce alignment`: learning what simulated people mean by their stick (8.3), as a page."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter
from typing import Final

from latentarm.metrics.results import write_results
from latentarm.parallel.grid import check_processes, run_grid
from latentarm.runs.checks import check_seed
from latentarm.runs.results_folder import ResultsFolder, write_json
from latentarm.studies.alignment.cell import Cell, CellResult, measure_cell
from latentarm.studies.alignment.curves import CurveCell, CurveResult, measure_curve
from latentarm.studies.alignment.decoder import DecoderCell, LearnedDecoder, learn_decoder
from latentarm.studies.alignment.documents import by_run, time_alignment, timings
from latentarm.studies.alignment.drives import DrivesResult, drive_cells, measure_drives
from latentarm.studies.alignment.drives_comparison import compare_drives, drives_rows
from latentarm.studies.alignment.drives_learning import TASK, DriveCell
from latentarm.studies.alignment.figures.draw import FIGURES, draw_figures
from latentarm.studies.alignment.hypotheses import compare_conditions
from latentarm.studies.alignment.measured import Measured
from latentarm.studies.alignment.page import write_page
from latentarm.studies.alignment.preset import Preset
from latentarm.studies.alignment.rows import STUDY, rows_of
from latentarm.studies.alignment.targets import PAPER_MODEL, targets
from latentarm.studies.tasks import check_tasks
from latentarm.tasks.pouring.tasks import POURING_TASKS
from latentarm.types import Row
from latentarm.untrusted.console import VisibleConsole

MODELS: Final = (PAPER_MODEL, "scl", "isometric")
"""The paper's decoder, the state-conditioned linear one, and ours."""

TASKS: Final = (*POURING_TASKS, TASK)
"""The paper's tasks, and the demo's table, where goals are driven to."""

MADE: Final = (
    "results.json",
    "results.md",
    "runs.json",
    "hypotheses.json",
    "targets.json",
    "timings.json",
    *(f"{name}.png" for name in FIGURES),
)
"""Every file of the folder, beside what was asked for."""

AnyCell = Cell | CurveCell | DriveCell
AnyResult = CellResult | CurveResult | DrivesResult


@dataclass(frozen=True)
class AlignmentConfig:
    """What `latentarm reproduce alignment` was asked for.

    Attributes:
        out: a new folder, or that of an earlier run of this study, which is replaced.
        preset: sizes of the study.
        tasks: names in `TASKS`.
        seed: of everything random.
        jobs: processes side by side; -1 is one per core.
        backend: where they run, a name in `latentarm.parallel.backends.BACKENDS`.
        quiet: say nothing while working.
        bars: show how far the grids are.

    Raises:
        UserError: there are no tasks, one is unknown or named twice, or seed, jobs or backend are out of
            range.
    """

    out: Path
    preset: Preset
    tasks: tuple[str, ...] = TASKS
    seed: int = 0
    jobs: int = -1
    backend: str = "joblib"
    quiet: bool = False
    bars: bool = False

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_processes(self.jobs, self.backend)
        check_tasks(self.tasks, TASKS)

    @property
    def pouring_tasks(self) -> tuple[str, ...]:
        """Those of the paper."""
        return tuple(task for task in self.tasks if task in POURING_TASKS)


def run_alignment(config: AlignmentConfig) -> list[Row]:
    """Measure every cell of the study and write figures, tables and tests to ``config.out``.

    ``results.json`` depends on preset, tasks and seed alone; how long it took stands in ``timings.json``.

    Returns:
        The relative error of every condition, task, decoder and noise, of every point of the curves and of
        the drives' alignments, and how the drives went; mean and SD are over runs, or over drives.

    Raises:
        UserError: the folder holds something else or cannot be written, the backend is not to be had, or a
            cell cannot be measured as asked; then it says which.
    """
    ResultsFolder(STUDY, MADE).claim(config.out, _about(config))
    console = VisibleConsole(stderr=True, quiet=config.quiet)
    began = perf_counter()
    wanted = [
        DecoderCell(task, model, config.preset, config.seed)
        for model in reversed(MODELS)  # the longest first
        for task in config.pouring_tasks
    ]
    console.print(f"1/3  Decoders: {len(wanted)} cells.")
    decoders = run_grid(
        learn_decoder,
        wanted,
        jobs=config.jobs,
        backend=config.backend,
        label=_decoder_label,
        bars=config.bars,
    )
    cells = _cells(config, decoders)
    console.print(f"2/3  Alignments, learning curves and drives: {len(cells)} cells.")
    found = run_grid(measure, cells, jobs=config.jobs, backend=config.backend, label=_label, bars=config.bars)
    measured = Measured(
        decoders,
        results=sorted((one for one in found if isinstance(one, CellResult)), key=_place),
        curves=[one for one in found if isinstance(one, CurveResult)],
        drives=[one for one in found if isinstance(one, DrivesResult)],
    )
    took_s = perf_counter() - began
    console.print("3/3  Drawing, testing the hypotheses, writing the page.")
    rows = [*rows_of(measured.results, measured.curves), *drives_rows(measured.drives)]
    _write(config, measured, rows, took_s)
    return rows


def measure(cell: AnyCell) -> AnyResult:
    """Measure one cell of the second grid.

    Raises:
        UserError: it cannot be measured as asked.
    """
    if isinstance(cell, Cell):
        return measure_cell(cell)
    return measure_curve(cell) if isinstance(cell, CurveCell) else measure_drives(cell)


def _cells(config: AlignmentConfig, decoders: Sequence[LearnedDecoder]) -> list[AnyCell]:
    """The second grid, its longest cells first."""
    preset = config.preset
    curves = [
        CurveCell(learned, noise)
        for noise in preset.curves.noises
        for learned in decoders
        if learned.cell.model in preset.curves.models
    ]
    drives = drive_cells(preset, config.seed) if TASK in config.tasks else []
    table = [Cell(learned, noise) for learned in decoders for noise in preset.noises]
    return [*curves, *drives, *table]


def _place(result: CellResult) -> tuple[int, int, float]:
    """Where a cell stands in tables."""
    return TASKS.index(result.cell.task), MODELS.index(result.cell.model), result.cell.noise


def _decoder_label(cell: DecoderCell) -> str:
    return f"{cell.task}, {cell.model}, decoder"


def _label(cell: AnyCell) -> str:
    if isinstance(cell, DriveCell):
        return f"{TASK}, {cell.model}, drives"
    what = ", curve" if isinstance(cell, CurveCell) else ""
    return f"{cell.learned.cell.task}, {cell.learned.cell.model}, noise {cell.noise:g}{what}"


def _write(config: AlignmentConfig, measured: Measured, rows: Sequence[Row], took_s: float) -> None:
    out = config.out
    tests, drive_tests = compare_conditions(measured.results), compare_drives(measured.drives)
    reached = targets(measured.results, measured.curves)
    draw_figures(measured.results, measured.curves, measured.drives, out)
    write_page(out, measured, tests, drive_tests, reached, config.preset, _command(config))
    write_json(out / "hypotheses.json", [one.as_json() for one in (*tests, *drive_tests)])
    write_json(out / "targets.json", [one.as_json() for one in reached])
    write_json(out / "runs.json", by_run(measured))
    write_json(
        out / "timings.json",
        {
            "backend": config.backend,
            "jobs": config.jobs,
            "grids_s": took_s,
            # While nothing else runs.
            "one_alignment": [
                time_alignment(learned) for learned in measured.decoders if learned.cell.model == PAPER_MODEL
            ],
            **timings(measured),
        },
    )
    write_results(out / "results.json", rows, _about(config))


def _command(config: AlignmentConfig) -> str:
    """What does the same again."""
    task = "" if config.tasks == TASKS else f" --task {config.tasks[0]}"
    return f"latentarm reproduce alignment --preset {config.preset.name}{task} --seed {config.seed}"


def _about(config: AlignmentConfig) -> dict[str, object]:
    """What the figures depend on."""
    return {
        "study": STUDY,
        "preset": asdict(config.preset),
        "tasks": list(config.tasks),
        "seed": config.seed,
        "arms": "simulated",
        "people": "simulated",
    }
