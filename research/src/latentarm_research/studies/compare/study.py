"""`latentarm compare`: every model on recorded demonstrations."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from latentarm.core.errors import UserError
from latentarm.core.types import Row
from latentarm.core.untrusted.console import VisibleConsole
from latentarm.demonstrations.split import FEW, MANY
from latentarm.evaluation.measures import label_of
from latentarm.models.estimators import MODELS
from latentarm.runs.checks import check_seed
from latentarm.runs.folder import fingerprint
from latentarm_research.studies.claim_tables import claim_table
from latentarm_research.studies.claims import Tested
from latentarm_research.studies.compare import tables
from latentarm_research.studies.compare.cell import FoldCell, FoldResult, measure_cell
from latentarm_research.studies.compare.datasets import Dataset, read_datasets
from latentarm_research.studies.compare.drives import (
    BESIDE,
    DriveResult,
    drive_cells,
    drive_label,
    measure_drive_cell,
    rows_of_drives,
)
from latentarm_research.studies.compare.figures import FILLS, fewer_figure, pareto_figure, turning_figure
from latentarm_research.studies.compare.hypotheses import compared, h1_sentences
from latentarm_research.studies.compare.measures import TABLES, meaning_of
from latentarm_research.studies.compare.preset import (
    CHOSEN_ON,
    OURS,
    PRESETS,
    REFERENCE,
    Preset,
)
from latentarm_research.studies.page import render_page
from latentarm_research.studies.study import Grid, Report, Request, Study

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Asked:
    """What is compared."""

    demonstrations: tuple[Path, ...]  # folders of native datasets, all of one robot
    preset: Preset  # models, noises, folds and all sizes
    ours: str  # the model that is driven
    seed: int  # of everything random
    datasets: tuple[Dataset, ...] = ()  # that the folders hold, with their folds


@dataclass(frozen=True, eq=False)
class CompareResults:
    """Results of one cell."""

    results: Sequence[FoldResult]  # of all cells
    whole: Sequence[FoldResult]  # of those that have all of a fold's demonstrations
    drives: Sequence[DriveResult]  # along held-out episodes


def compare_study(
    demonstrations: tuple[Path, ...], preset: Preset, ours: str = OURS, seed: int = 0
) -> Study[Preset, CompareResults]:
    """The comparison on some datasets."""
    asked = Asked(demonstrations, preset, ours, seed)
    _check(asked)
    asked = replace(asked, datasets=tuple(read_datasets(demonstrations, preset.folds, seed)))
    return Study(
        name=tables.STUDY,
        command="compare",
        presets=PRESETS,
        tasks=tuple(one.name for one in asked.datasets),
        simulated=("drives",),
        measure=partial(_measure, asked),
        report=partial(_report, asked),
        figures=("pareto", "turning", "fewer"),
        documents=("seeds.json", "drives.json"),
        depends_on=lambda request: {
            "datasets": {one.name: fingerprint(one.demonstrations) for one in asked.datasets},
            "held_out": {one.name: [list(fold.held_out) for fold in one.folds] for one in asked.datasets},
            "ours": asked.ours,
        },
    )


def _check(asked: Asked) -> None:
    """Check names and noises."""
    check_seed(asked.seed)
    for name in (*asked.preset.models, asked.ours):
        if name not in MODELS:
            raise UserError(f"There is no model {name!r}: choose from {', '.join(MODELS)}.")
        MODELS[name]  # fails here if it does not load
    for noise_rad in asked.preset.noises_rad:
        if not (math.isfinite(noise_rad) and noise_rad >= 0):
            raise UserError(f"The noise is {noise_rad:g} rad; it must be a finite number, zero or more.")
    if not 1 <= len(asked.preset.noises_rad) <= len(FILLS):
        raise UserError(f"Name at least one noise, and at most {len(FILLS)}.")
    names = [path.resolve().name for path in asked.demonstrations]
    for what, given in (
        ("datasets", names),
        ("models", asked.preset.models),
        ("noises", asked.preset.noises_rad),
    ):
        if not given or len(set(given)) < len(given):
            raise UserError(f"Name at least one of the {what}, and none twice.")


def _measure(asked: Asked, request: Request[Preset], grid: Grid) -> CompareResults:
    preset, cells = asked.preset, _cells(asked)
    results = grid.run("Models on folds", measure_cell, cells, _label)
    whole = [one for one, cell in zip(results, cells, strict=True) if cell.fold in cell.dataset.folds]
    to_drive = drive_cells(
        asked.datasets,
        whole,
        asked.ours,
        preset.noises_rad[0],
        preset.drives,
        preset.drive_limit_s,
        asked.seed,
    )
    drives = grid.run("Drives by a simulated operator", measure_drive_cell, to_drive, drive_label)
    return CompareResults(results, whole, drives)


def _cells(asked: Asked) -> list[FoldCell]:
    """All models with all demonstrations, and some with fewer."""
    preset = asked.preset
    return [
        FoldCell(dataset, noise_rad, model, fold, preset, asked.seed)
        for dataset in asked.datasets
        for noise_rad in preset.noises_rad
        for model in preset.models
        for fold in dataset.folds
    ] + [
        FoldCell(dataset, noise_rad, model, fold.with_only(count), preset, asked.seed)
        for dataset in asked.datasets
        for noise_rad in preset.noises_rad
        for model in _given_fewer(asked)
        for fold in dataset.folds
        for count in preset.demonstrations
        if count < dataset.left
    ]


def _given_fewer(asked: Asked) -> list[str]:
    wanted = dict.fromkeys((asked.ours, REFERENCE, BESIDE))
    return [name for name in wanted if name in asked.preset.models]


def _label(cell: FoldCell) -> str:
    place = cell.place
    return (
        f"{place.dataset}, {place.model}, {tables.condition(place.noise_rad)}, fold {place.fold},"
        f" {place.demonstrations} demonstrations"
    )


def _report(asked: Asked, request: Request[Preset], measured: CompareResults) -> Report:
    preset, names = asked.preset, [one.name for one in asked.datasets]
    results, drives, fewer_models = measured.results, measured.drives, _given_fewer(asked)
    all_of = {one.name: one.left for one in asked.datasets}
    main = tables.rows_of(measured.whole)
    fewer = tables.rows_of_fewer([one for one in results if one.place.model in fewer_models], all_of)
    counts = sorted({min(one.place.demonstrations, all_of[one.place.dataset]) for one in results})
    driven = rows_of_drives(tables.STUDY, tables.condition(preset.noises_rad[0], "driven"), drives)
    tests = compared(measured.whole)
    figures: dict[str, Figure] = {
        "pareto": pareto_figure(main, names, preset.noises_rad),
        "turning": turning_figure(main, names, preset.noises_rad),
    }
    if fewer_models:
        figures["fewer"] = fewer_figure(fewer, names, preset.noises_rad, counts)
    return Report(
        rows=[*main, *fewer, *driven],
        page=_page(asked, main, tests, driven, counts),
        figures=figures,
        tests=tests,
        documents={
            "seeds.json": tables.seeds_of(results),
            "drives.json": [{**asdict(one), "figures": one.figures.as_json()} for one in drives],
        },
        tables=tables.terminal_tables(main, names, preset.noises_rad, VisibleConsole().width),
    )


def _page(
    asked: Asked,
    main: Sequence[Row],
    tests: Sequence[Tested],
    driven: Sequence[Row],
    counts: Sequence[int],
) -> str:
    preset, names = asked.preset, [one.name for one in asked.datasets]
    return render_page(
        "compare/page.md",
        command=_command(asked),
        preset=preset,
        sizes=[f"{one.name} ({len(one.demonstrations.episodes)} episodes)" for one in asked.datasets],
        many=MANY,
        few=FEW,
        corner=tables.CORNER,
        seed=asked.seed,
        chosen_on=[name for name in names if name.endswith(CHOSEN_ON)],
        meanings={
            heading: {label_of(name): meaning_of(name) for name in measures}
            for heading, measures in TABLES.items()
        },
        sections={
            f"{name}, {tables.condition(noise_rad)}": {
                heading: tables.page_table(main, name, noise_rad, measures)
                for heading, measures in TABLES.items()
            }
            for name in names
            for noise_rad in preset.noises_rad
        },
        h1=h1_sentences(tests),
        h1_table=claim_table(tests) if tests else "",
        fewer=_given_fewer(asked),
        counts=counts,
        driven=list(dict.fromkeys(row.model or "" for row in driven)),
        driven_noise=tables.condition(preset.noises_rad[0]),
        drive_tables={name: tables.drive_table(driven, name) for name in names},
    )


def _command(asked: Asked) -> str:
    """The command that repeats it."""
    preset, usual = asked.preset, PRESETS[asked.preset.name]
    words = ["latentarm compare --demonstrations", *(str(path) for path in asked.demonstrations)]
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
        ("--ours", asked.ours, OURS),
        ("--seed", asked.seed, 0),
    ):
        if mine != its:
            words += [flag, str(mine)]
    return " ".join(words)
