"""`latentarm compare`: every model on recorded demonstrations, as a page with tables and figures."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter
from typing import Final

from latentarm.errors import UserError
from latentarm.metrics.results import write_results
from latentarm.models.catalogue import MODELS
from latentarm.parallel.grid import check_processes, run_grid
from latentarm.runs.checks import check_seed
from latentarm.runs.folder import fingerprint
from latentarm.runs.results_folder import ResultsFolder, write_json
from latentarm.studies.compare.cell import Cell, CellResult, measure_cell
from latentarm.studies.compare.datasets import Dataset, read_datasets
from latentarm.studies.compare.drives import (
    BESIDE,
    DriveResult,
    drive_cells,
    drive_label,
    measure_drive_cell,
    rows_of_drives,
)
from latentarm.studies.compare.figures.fewer import fewer_figure
from latentarm.studies.compare.figures.pareto import FILLS, pareto_figure
from latentarm.studies.compare.measures import without_planning
from latentarm.studies.compare.page import Content, write_page
from latentarm.studies.compare.preset import OURS, PRESETS, REFERENCE, Preset
from latentarm.studies.compare.rows import STUDY, condition, rows_of, rows_of_fewer, seeds_of
from latentarm.studies.compare.targets import verdicts
from latentarm.style import save_figure
from latentarm.types import Row
from latentarm.untrusted.console import VisibleConsole

MADE: Final = (
    "results.json",
    "results.md",
    "seeds.json",
    "drives.json",
    "timings.json",
    "pareto.png",
    "fewer.png",
)
"""Every file of the folder, beside what was asked for."""


@dataclass(frozen=True)
class CompareConfig:
    """What `latentarm compare` was asked for; its ``--help`` says the same of each field.

    Attributes:
        demonstrations: folders of native datasets, all of one robot.
        out: a new folder, or that of an earlier comparison, which is replaced.
        preset: models, noises, folds and all sizes.
        ours: the model that is held against the targets.
        seed: of everything random.
        jobs: processes side by side; -1 is one per core.
        backend: where they run, a name in `latentarm.parallel.backends.BACKENDS`.
        quiet: say nothing while working.
        bars: show how far the grid is.

    Raises:
        UserError: a name is unknown or given twice, a noise is no noise, or a number is out of range.
    """

    demonstrations: tuple[Path, ...]
    out: Path
    preset: Preset
    ours: str = OURS
    seed: int = 0
    jobs: int = -1
    backend: str = "joblib"
    quiet: bool = False
    bars: bool = False

    def __post_init__(self) -> None:
        check_seed(self.seed)
        check_processes(self.jobs, self.backend)
        for name in (*self.preset.models, self.ours):
            if name not in MODELS:
                raise UserError(f"There is no model {name!r}: choose from {', '.join(MODELS)}.")
            MODELS[name]  # refused now if it does not load
        for noise_rad in self.preset.noises_rad:
            if not (math.isfinite(noise_rad) and noise_rad >= 0):
                raise UserError(f"The noise is {noise_rad:g} rad; it must be a finite number, zero or more.")
        if not 1 <= len(self.preset.noises_rad) <= len(FILLS):
            raise UserError(f"Name at least one noise, and at most {len(FILLS)}.")
        names = [path.resolve().name for path in self.demonstrations]
        for what, given in (
            ("datasets", names),
            ("models", self.preset.models),
            ("noises", self.preset.noises_rad),
        ):
            if not given or len(set(given)) < len(given):
                raise UserError(f"Name at least one of the {what}, and none twice.")


def run_compare(config: CompareConfig) -> list[Row]:
    """Measure every model on every fold, drive, and write tables and figures to ``config.out``.

    ``results.json`` depends on the datasets, the preset and the seed alone; how long it took stands in
    ``timings.json``.

    Returns:
        Rows over seeds and over folds, those with fewer demonstrations, and those of the drives.

    Raises:
        UserError: a dataset cannot be read, is of another robot or of none, or has fewer episodes than
            folds; the folder holds something else; or a cell cannot be measured as asked.
    """
    datasets = read_datasets(config.demonstrations, config.preset.folds, config.seed)
    about = _about(config, datasets)
    ResultsFolder(STUDY, MADE).claim(config.out, about)
    console, preset = VisibleConsole(stderr=True, quiet=config.quiet), config.preset
    cells = _cells(config, datasets)
    console.print(
        f"1/3  {len(preset.models)} models on {', '.join(one.name for one in datasets)},"
        f" noise of {', '.join(f'{noise_rad:g}' for noise_rad in preset.noises_rad)} rad,"
        f" {preset.folds} folds: {len(cells)} cells, seeds in each: {preset.seeds}."
    )
    began = perf_counter()
    results = run_grid(
        measure_cell, cells, jobs=config.jobs, backend=config.backend, label=_label, bars=config.bars
    )
    whole = [one for one, cell in zip(results, cells, strict=True) if cell.fold in cell.dataset.folds]
    to_drive = drive_cells(
        datasets, whole, config.ours, preset.noises_rad[0], preset.drives, preset.drive_limit_s, config.seed
    )
    console.print(f"2/3  A simulated operator drives {len(to_drive)} times.")
    drives = run_grid(
        measure_drive_cell,
        to_drive,
        jobs=config.jobs,
        backend=config.backend,
        label=drive_label,
        bars=config.bars,
    )
    took_s = perf_counter() - began
    console.print("3/3  Drawing, writing the page.")
    rows = _write(config, datasets, results, whole, drives, about)
    _write_timings(config, results, drives, took_s)
    return rows


def _cells(config: CompareConfig, datasets: Sequence[Dataset]) -> list[Cell]:
    """All models with all demonstrations, and some with fewer."""
    preset = config.preset
    return [
        Cell(dataset, noise_rad, model, fold, preset, config.seed)
        for dataset in datasets
        for noise_rad in preset.noises_rad
        for model in preset.models
        for fold in dataset.folds
    ] + [
        Cell(dataset, noise_rad, model, fold.with_only(count), without_planning(preset), config.seed)
        for dataset in datasets
        for noise_rad in preset.noises_rad
        for model in _given_fewer(config)
        for fold in dataset.folds
        for count in preset.demonstrations
        if count < dataset.left
    ]


def _given_fewer(config: CompareConfig) -> list[str]:
    wanted = dict.fromkeys((config.ours, REFERENCE, BESIDE))
    return [name for name in wanted if name in config.preset.models]


def _label(cell: Cell) -> str:
    place = cell.place
    return (
        f"{place.dataset}, {place.model}, {condition(place.noise_rad)}, fold {place.fold},"
        f" {place.demonstrations} demonstrations"
    )


def _write(
    config: CompareConfig,
    datasets: Sequence[Dataset],
    results: Sequence[CellResult],
    whole: Sequence[CellResult],
    drives: Sequence[DriveResult],
    about: dict[str, object],
) -> list[Row]:
    out, preset, names = config.out, config.preset, [one.name for one in datasets]
    fewer_models = _given_fewer(config)
    all_of = {one.name: one.left for one in datasets}
    fewer = rows_of_fewer([one for one in results if one.place.model in fewer_models], all_of)
    counts = sorted({min(one.place.demonstrations, all_of[one.place.dataset]) for one in results})
    main = rows_of(whole)
    driven = rows_of_drives(STUDY, condition(preset.noises_rad[0], "driven"), drives)
    save_figure(pareto_figure(main, names, preset.noises_rad), out / "pareto.png")
    if fewer_models:
        save_figure(fewer_figure(fewer, names, preset.noises_rad, counts), out / "fewer.png")
    content = Content(
        command=_command(config),
        preset=preset,
        datasets=names,
        episodes=[len(one.demonstrations.episodes) for one in datasets],
        ours=config.ours,
        rows=main,
        fewer=fewer_models,
        counts=counts,
        verdicts=verdicts(main, config.ours, names, preset.noises_rad),
        drives=driven,
        seed=config.seed,
    )
    write_page(out, content)
    write_json(out / "seeds.json", seeds_of(results))
    write_json(out / "drives.json", [asdict(one) for one in drives])
    rows = [*main, *fewer, *driven]
    write_results(out / "results.json", rows, about)
    return rows


def _write_timings(
    config: CompareConfig, results: Sequence[CellResult], drives: Sequence[DriveResult], took_s: float
) -> None:
    write_json(
        config.out / "timings.json",
        {
            "backend": config.backend,
            "jobs": config.jobs,
            "grid_s": took_s,
            "cells": [
                {
                    **asdict(one.place),
                    "fit_s": one.fit_s,
                    "measure_s": one.measure_s,
                    "plan_one_decoder_s": one.plan_s,
                }
                for one in results
            ],
            "drives": [
                {
                    "dataset": one.dataset,
                    "controller": one.controller,
                    "episode": one.episode,
                    "simulated_s": one.figures.time_s,
                    "took_s": one.took_s,
                }
                for one in drives
            ],
        },
    )


def _command(config: CompareConfig) -> str:
    """The words that do it again."""
    preset, usual = config.preset, PRESETS[config.preset.name]
    words = ["latentarm compare --demonstrations", *(str(path) for path in config.demonstrations)]
    if preset.name != "paper":
        words += ["--preset", preset.name]
    for flag, mine, its in (
        ("--models", preset.models, usual.models),
        ("--noise", preset.noises_rad, usual.noises_rad),
    ):
        if mine != its:
            words += [flag, *(str(one) for one in mine)]
    for flag, mine, its in (
        ("--seeds", preset.seeds, usual.seeds),
        ("--folds", preset.folds, usual.folds),
        ("--reach-pairs", preset.reach_pairs, usual.reach_pairs),
        ("--ours", config.ours, OURS),
        ("--seed", config.seed, 0),
    ):
        if mine != its:
            words += [flag, str(mine)]
    return " ".join(words)


def _about(config: CompareConfig, datasets: Sequence[Dataset]) -> dict[str, object]:
    """What the figures depend on."""
    return {
        "study": STUDY,
        "preset": asdict(config.preset),
        "datasets": {one.name: fingerprint(one.demonstrations) for one in datasets},
        "held_out": {one.name: [list(fold.held_out) for fold in one.folds] for one in datasets},
        "ours": config.ours,
        "seed": config.seed,
        "drives": "simulated",
    }
