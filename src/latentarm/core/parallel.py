"""A grid of independent cells, measured side by side.

A cell carries everything that it depends on, its seeds too: its result does not depend on where it runs.
"""

import traceback
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Any, Generic, TypeVar, cast

from joblib import Parallel, delayed, effective_n_jobs, parallel_config
from joblib.parallel import get_active_backend
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    TextColumn,
    TimeElapsedColumn,
)

from latentarm.core.errors import UserError
from latentarm.core.untrusted.console import VisibleConsole

Cell = TypeVar("Cell")
Result = TypeVar("Result")

Backend = Callable[[int], AbstractContextManager[int]]
"""Makes one of joblib's backends the active one: from the processes wanted, -1 for one per core, to how many
there will be. It ends what it has started, and nothing else."""


@contextmanager
def processes(jobs: int) -> Generator[int]:
    """The `Backend` of processes on this machine."""
    with parallel_config("loky"):
        yield cast(int, effective_n_jobs(jobs))


class CellError(Exception):
    """A bug made a cell fail; names the cell and holds the traceback."""


@dataclass(frozen=True)
class _Measured(Generic[Result]):
    index: int
    result: Result
    warnings: tuple[tuple[type[Warning], str], ...]


def run_grid(
    function: Callable[[Cell], Result],
    cells: Sequence[Cell],
    *,
    jobs: int,
    backend: Backend = processes,
    label: Callable[[Cell], str],
    bars: bool,
    unit: str = "cells",
    keep: Callable[[Cell, Result], None] | None = None,
) -> list[Result]:
    """Measure every cell, each on one process.

    Results come in the order of the cells. Warnings of a cell come again here, after its name.

    Args:
        function: measures one cell; importable by name for other processes.
        cells: picklable.
        jobs: processes side by side, as far as a cluster has them; -1 is one per core.
        backend: where the processes are.
        label: names a cell in errors and warnings.
        bars: show progress on standard error.
        unit: word for a cell on the bar.
        keep: called with each cell and its result as soon as there is one, in any order; with Ray at the end.

    Raises:
        UserError: jobs is invalid, the backend is not available, one of joblib's processes was
            killed, or a cell raised one; the message names the cell.
        CellError: a cell raised anything else.
    """
    check_jobs(jobs)
    with backend(jobs) as workers, counting_bar(bars) as bar:
        # One cell at a time per process: a cell takes seconds, and the bar then advances with each.
        one_by_one: dict[str, Any] = {"batch_size": 1, "pre_dispatch": workers}
        active: Any = get_active_backend()[0]
        order = "generator_unordered" if active.supports_return_generator else "list"
        parallel = Parallel(n_jobs=workers, return_as=order, **one_by_one)
        found: dict[int, _Measured[Result]] = {}
        try:
            with warnings.catch_warnings():
                # A process that has grown, as one that trained a model has, makes way for a new one.
                warnings.filterwarnings("ignore", "A worker stopped while some jobs were given", UserWarning)
                measured = parallel(
                    delayed(_measure)(function, index, cell, label(cell))
                    for index, cell in enumerate(_watched(cells, workers, bar, unit))
                )
                for entry in cast(Iterable[_Measured[Result]], measured):
                    found[entry.index] = entry
                    if keep is not None:
                        keep(cells[entry.index], entry.result)
        except BrokenProcessPool as error:
            raise UserError(
                "A process of the grid was killed, most likely because memory ran out: try fewer with --jobs."
            ) from error
    results = [found[index] for index in range(len(cells))]
    for cell, entry in zip(cells, results, strict=True):
        for category, text in entry.warnings:
            warnings.warn(f"{label(cell)}: {text}", category, stacklevel=2)
    return [entry.result for entry in results]


def check_jobs(jobs: int) -> None:
    """Check the number of processes before any work is done; UserError where it is none."""
    if jobs != -1 and jobs < 1:
        raise UserError(f"The number of jobs is {jobs}: it must be at least 1, or -1 for one per core.")


def _measure(function: Callable[[Cell], Result], index: int, cell: Cell, name: str) -> _Measured[Result]:
    """Measure one cell in any process; errors hold only text, because others may not survive pickling."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UserWarning)
        warnings.simplefilter("always", RuntimeWarning)
        try:
            result = function(cell)
        except UserError as error:
            raise UserError(f"{name}: {error}") from error
        except Exception as error:
            raise CellError(f"{name} failed.\n{traceback.format_exc()}") from error
    return _Measured(index, result, tuple((warning.category, str(warning.message)) for warning in caught))


def _watched(cells: Sequence[Cell], workers: int, bar: Progress, unit: str) -> Iterator[Cell]:
    """Every backend asks for the next cell when a process is free, but not all say which cell is done."""
    task = bar.add_task(unit, total=len(cells))
    for begun, cell in enumerate(cells, start=1):
        bar.update(task, completed=max(0, begun - workers))
        yield cell


def counting_bar(shown: bool, *last: ProgressColumn) -> Progress:
    """A progress bar on standard error that goes away when it is done; it ends with the time, or as told."""
    first = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()
    console = VisibleConsole(stderr=True)
    return Progress(
        *first, *(last or (TimeElapsedColumn(),)), console=console, disable=not shown, transient=True
    )
