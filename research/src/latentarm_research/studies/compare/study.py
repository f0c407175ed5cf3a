"""`latentarm compare`: every model on recorded demonstrations."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from latentarm.core.untrusted.console import VisibleConsole
from latentarm.demonstrations.split import FEW, MANY
from latentarm.evaluation.measures import label_of
from latentarm.models.estimators import MODELS
from latentarm.runs.checks import check_seed
from latentarm.runs.folder import fingerprint
from latentarm_research.studies.claim_tables import claim_table
from latentarm_research.studies.compare import tables
from latentarm_research.studies.compare.cell import FoldCell, FoldResult, measure_cell
from latentarm_research.studies.compare.datasets import Dataset, read_datasets
from latentarm_research.studies.compare.drives import (
    DriveResult,
    drive_cells,
    drive_label,
    measure_drive_cell,
    rows_of_drives,
)
from latentarm_research.studies.compare.figures import fewer_figure, pareto_figure, turning_figure
from latentarm_research.studies.compare.hypotheses import compared, h1_sentences
from latentarm_research.studies.compare.measures import TABLES, meaning_of
from latentarm_research.studies.compare.preset import CHOSEN_ON, PRESETS, Preset, check_each_once
from latentarm_research.studies.page import render_page
from latentarm_research.studies.study import Grid, Report, Request, Study

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class CompareResults:
    """Everything that was measured."""

    results: Sequence[FoldResult]  # of all cells
    whole: Sequence[FoldResult]  # of those that have all of a fold's demonstrations
    drives: Sequence[DriveResult]  # along held-out episodes


def compare_study(
    demonstrations: tuple[Path, ...],  # folders of native datasets, all of one robot
    preset: Preset,
    seed: int = 0,
) -> Study[Preset, CompareResults]:
    """The comparison on some datasets."""
    check_seed(seed)
    for name in (*preset.models, preset.ours):
        MODELS[name]  # fails here if it does not load
    check_each_once("datasets", [path.resolve().name for path in demonstrations])
    datasets = read_datasets(demonstrations, preset.folds, seed)
    return Study(
        name=tables.STUDY,
        command="compare",
        presets=PRESETS,
        tasks=tuple(one.name for one in datasets),
        simulated=("drives",),
        measure=partial(_measure, datasets),
        report=partial(_report, datasets, demonstrations),
        figures=("pareto", "turning", "fewer"),
        documents=("seeds.json", "drives.json"),
        depends_on=lambda request: {
            "datasets": {one.name: fingerprint(one.demonstrations) for one in datasets},
            "held_out": {one.name: [list(fold.held_out) for fold in one.folds] for one in datasets},
        },
        options=("ours",),
    )


def _measure(datasets: Sequence[Dataset], request: Request[Preset], grid: Grid) -> CompareResults:
    cells = _cells(datasets, request)
    results = grid.run("Models on folds", measure_cell, cells, _label)
    whole = [one for one, cell in zip(results, cells, strict=True) if cell.fold in cell.dataset.folds]
    to_drive = drive_cells(datasets, whole, request.preset, request.seed)
    drives = grid.run("Drives by a simulated operator", measure_drive_cell, to_drive, drive_label)
    return CompareResults(results, whole, drives)


def _cells(datasets: Sequence[Dataset], request: Request[Preset]) -> list[FoldCell]:
    """All models with all demonstrations, and some with fewer."""
    preset = request.preset
    return [
        FoldCell(dataset, noise_rad, model, fold, preset, request.seed)
        for dataset in datasets
        for noise_rad in preset.noises_rad
        for model in preset.models
        for fold in dataset.folds
    ] + [
        FoldCell(dataset, noise_rad, model, fold.with_only(count), preset, request.seed)
        for dataset in datasets
        for noise_rad in preset.noises_rad
        for model in preset.given_fewer
        for fold in dataset.folds
        for count in preset.demonstrations
        if count < dataset.left
    ]


def _label(cell: FoldCell) -> str:
    place = cell.place
    return (
        f"{place.dataset}, {place.model}, {tables.condition(place.noise_rad)}, fold {place.fold},"
        f" {place.demonstrations} demonstrations"
    )


def _report(
    datasets: Sequence[Dataset],
    demonstrations: Sequence[Path],
    request: Request[Preset],
    measured: CompareResults,
) -> Report:
    preset, names = request.preset, [one.name for one in datasets]
    results, drives = measured.results, measured.drives
    all_of = {one.name: one.left for one in datasets}
    main = tables.rows_of(measured.whole)
    fewer = tables.rows_of_fewer([one for one in results if one.place.model in preset.given_fewer], all_of)
    counts = sorted({min(one.place.demonstrations, all_of[one.place.dataset]) for one in results})
    driven = rows_of_drives(tables.STUDY, tables.condition(preset.noises_rad[0], "driven"), drives)
    tests = compared(measured.whole)
    figures: dict[str, Figure] = {
        "pareto": pareto_figure(main, names, preset.noises_rad),
        "turning": turning_figure(main, names, preset.noises_rad),
    }
    if preset.given_fewer:
        figures["fewer"] = fewer_figure(fewer, names, preset.noises_rad, counts)
    page = render_page(
        "compare/page.md",
        command=_command(demonstrations, request),
        preset=preset,
        sizes=[f"{one.name} ({len(one.demonstrations.episodes)} episodes)" for one in datasets],
        many=MANY,
        few=FEW,
        corner=tables.CORNER,
        seed=request.seed,
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
        fewer=preset.given_fewer,
        counts=counts,
        driven=list(dict.fromkeys(row.model or "" for row in driven)),
        driven_noise=tables.condition(preset.noises_rad[0]),
        drive_tables={name: tables.drive_table(driven, name) for name in names},
    )
    return Report(
        rows=[*main, *fewer, *driven],
        page=page,
        figures=figures,
        tests=tests,
        documents={
            "seeds.json": tables.seeds_of(results),
            "drives.json": [{**asdict(one), "figures": one.figures.as_json()} for one in drives],
        },
        tables=tables.terminal_tables(main, names, preset.noises_rad, VisibleConsole().width),
    )


def _command(demonstrations: Sequence[Path], request: Request[Preset]) -> str:
    """The command that repeats it."""
    preset, usual = request.preset, PRESETS[request.preset.name]
    words = ["latentarm compare --demonstrations", *map(str, demonstrations)]
    for flag, mine, its in (
        ("--preset", preset.name, "paper"),
        ("--models", preset.models, usual.models),
        ("--noise", preset.noises_rad, usual.noises_rad),
        ("--seeds", preset.seeds, usual.seeds),
        ("--folds", preset.folds, usual.folds),
        ("--reach-pairs", preset.reach_pairs, usual.reach_pairs),
        ("--ours", preset.ours, usual.ours),
        ("--seed", request.seed, 0),
    ):
        if mine != its:
            words += [flag, *(map(str, mine) if isinstance(mine, tuple) else [str(mine)])]
    return " ".join(words)
