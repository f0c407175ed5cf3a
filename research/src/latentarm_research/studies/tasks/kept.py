"""Finished cells in the study's folder, so that it goes on where it was stopped. Nothing is unpickled.

Each run is a JSON file, each demonstration that succeeded a safetensors file beside its own, and each kind of
model a folder. What is read is checked like any file of a stranger.
"""

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, Final

import numpy as np
from safetensors.numpy import save

from latentarm.core.errors import UserError
from latentarm.core.files import written_whole
from latentarm.core.types import Episode, FloatArray
from latentarm.models.reading import Section
from latentarm.models.saving import CONFIG_LIMIT, CONFIG_NAME, read_model, read_tensors, write_model
from latentarm.runs.results_folder import write_json
from latentarm_research.metrics.drives import Drive
from latentarm_research.studies.study import Keep
from latentarm_research.studies.tasks.cell import (
    DemonstratedRun,
    FittedModel,
    ModelCell,
    ShownCell,
    TaskRunCell,
)
from latentarm_research.studies.tasks.runs import Run, kept_in

RUNS: Final = "runs"  # the folder of demonstrations and drives
MODELS: Final = "models"  # the folder of the models
LIMIT: Final = 1 << 16  # bytes of a run's file


def _shown_path(out: Path, cell: ShownCell) -> Path:
    return out / RUNS / cell.task / cell.stream.name.lower() / f"{cell.number}.json"


def _write_shown(path: Path, cell: ShownCell, shown: DemonstratedRun) -> None:
    episode, about = shown.episode, dict[str, object]()
    if episode is not None:
        arrays = {"state": episode.state, "timestamp": episode.timestamp, **episode.extras}
        about = {"text": episode.task, **_write_arrays(path, arrays)}
    write_json(path, {**shown.run.as_json(), "objects": list(shown.objects), **about})


def _read_shown(path: Path, cell: ShownCell) -> DemonstratedRun:
    section = Section.of_file(path, LIMIT)
    run = _run(section, cell.number)
    objects = tuple(section.texts("objects"))
    return DemonstratedRun(cell, run, _episode(section, path) if run.success else None, objects)


def _episode(section: Section, path: Path) -> Episode:
    arrays = _read_arrays(section, path)
    if not {"state", "timestamp"} <= arrays.keys():
        raise UserError(f"{path} has no states of its demonstration: remove it, and it is run again.")
    state, timestamp = arrays.pop("state"), arrays.pop("timestamp")
    return Episode(state, timestamp, task=section.text("text"), extras=arrays)


def _drive_path(out: Path, cell: TaskRunCell) -> Path:
    return out / RUNS / cell.task / cell.person / cell.driver.condition.folder / f"{cell.number}.json"


def _write_drive(path: Path, cell: TaskRunCell, run: Run) -> None:
    write_json(path, run.as_json())


def _read_drive(path: Path, cell: TaskRunCell) -> Run:
    section = Section.of_file(path, LIMIT)
    return _run(section, cell.number, Drive(**_values(section, Drive)))


def _model_path(out: Path, cell: ModelCell) -> Path:
    return out / MODELS / kept_in(cell.task, cell.condition) / CONFIG_NAME


def _write_model(path: Path, cell: ModelCell, trained: FittedModel) -> None:
    write_model(path.parent, trained.model, {"preset": asdict(cell.preset), "fit_s": trained.fit_s})


def _read_model(path: Path, cell: ModelCell) -> FittedModel:
    fit_s = Section.of_file(path, CONFIG_LIMIT).number("fit_s")
    return FittedModel(cell.task, cell.condition, read_model(path.parent), fit_s)


def _write_arrays(path: Path, arrays: Mapping[str, FloatArray]) -> dict[str, object]:
    """Write arrays beside a JSON file, which is to hold what is returned."""
    plain = {name: np.ascontiguousarray(one, dtype=np.float64) for name, one in arrays.items()}
    content = save(plain)
    with written_whole(path.with_suffix(".safetensors")) as part:
        part.write_bytes(content)
    shapes = {name: list(one.shape) for name, one in plain.items()}
    return {"shapes": shapes, "sha256": hashlib.sha256(content).hexdigest()}


def _read_arrays(section: Section, path: Path) -> dict[str, FloatArray]:
    shapes = section.section("shapes")
    wanted = {name: tuple(shapes.integers(name, 0, longest=2)) for name in shapes.plain()}
    return read_tensors(path.with_suffix(".safetensors"), wanted, section.text("sha256"))


_READ: Final[Mapping[Any, Callable[[Section, str], Any]]] = {
    bool: Section.truth,
    int: lambda section, key: section.integer(key, 0),
    float: Section.number,
    str: Section.text,
    tuple[str, ...]: lambda section, key: tuple(section.texts(key)),
}


def _values(section: Section, record: type) -> dict[str, Any]:
    """The plain fields of a record as they stand in a file."""
    return {
        entry.name: _READ[entry.type](section, entry.name) for entry in fields(record) if entry.type in _READ
    }


def _run(section: Section, number: int, figures: Drive | None = None) -> Run:
    run = Run(**_values(section, Run), figures=figures)
    if run.number != number or run.done > len(run.steps):
        raise UserError(f"{section.where} is no run {number} of this study: remove it, and it is run again.")
    return run


KEEP_SHOWN: Final = Keep(_shown_path, _read_shown, _write_shown)
KEEP_MODELS: Final = Keep(_model_path, _read_model, _write_model)
KEEP_DRIVES: Final = Keep(_drive_path, _read_drive, _write_drive)
