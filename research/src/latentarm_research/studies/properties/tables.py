"""Ours next to the paper's, and how each cell of its table compares: within one SD of the paper's, or beyond.

Beyond it, the side decides between the method's favour and a miss. The paper's claim is that models that see
the context do better than models that do not. So its favour is a better figure where the decoder sees the
context, and a worse one where it does not.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final

from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.measures import measure_of
from latentarm.evaluation.table import ABSENT, format_figure, measure_name
from latentarm.models.catalogue import KINDS
from latentarm_research.studies.properties.paper import (
    LENGTHS,
    OF_MEANS,
    PAPER,
)
from latentarm_research.studies.tables import markdown_table

HALF_A_DIGIT: Final = 0.005
"""Rounding error of a figure that is printed with two decimals and without SD."""


class PaperVerdict(StrEnum):
    """How a cell compares with the paper's."""

    WITHIN = "within one SD"
    IN_FAVOUR = "in the method's favour"
    MISSED = "missed"


@dataclass(frozen=True)
class PaperCell:
    """One cell of the paper's table."""

    row: Row  # ours, with the paper's mean and SD
    verdict: PaperVerdict  # how they compare


def judge(
    mean: float,
    paper: float,
    sd: float,  # the paper's SD, or how exactly it is printed where it has none
    better: str,
    sees_context: bool,
) -> PaperVerdict:
    """Compare one figure with the paper's: within `sd` of it on either side, or else which side it is on."""
    upward = (better == "higher") == sees_context
    ahead = mean - paper if upward else paper - mean
    if abs(ahead) <= sd:
        return PaperVerdict.WITHIN
    return PaperVerdict.IN_FAVOUR if ahead > 0 else PaperVerdict.MISSED


def paper_cells(rows: Iterable[Row], *, means: bool = False) -> list[PaperCell]:
    """The paper's cells among the rows of the paper's setting.

    What is a figure of the paper's by definition (PCA's loss in percent of its own, the VAE's length in
    percent of its own) is no cell. With ``means`` means over pairs are judged where the study has medians.
    """
    ours = {(row.task, row.model, row.measure): row for row in rows}
    cells: list[PaperCell] = []
    for (task, model, measure), (paper, sd) in PAPER.items():
        row = ours.get((task, model, OF_MEANS.get(measure, measure) if means else measure))
        known = measure_of(measure)
        if row is None or row.mean is None or known is None or known.better is None:
            continue
        if measure.endswith(f"_of_{model}"):
            continue
        tolerance = HALF_A_DIGIT if sd is None else sd
        verdict = judge(row.mean, paper, tolerance, known.better, KINDS[model].sees_context)
        cells.append(PaperCell(replace(row, paper_mean=paper, paper_sd=sd), verdict))
    return cells


def count(cells: Sequence[PaperCell]) -> tuple[int, int, int]:
    """How many cells have each verdict, in the order of `PaperVerdict`."""
    within, in_favour, missed = (sum(cell.verdict is one for cell in cells) for one in PaperVerdict)
    return within, in_favour, missed


def cells_table(cells: Sequence[PaperCell]) -> str:
    """Every cell: the paper's, ours, and how they compare."""
    return markdown_table(
        ["task", "measure", "model", "the paper", "ours", "verdict"],
        [
            [
                cell.row.task or ABSENT,
                measure_name(cell.row),
                look_of(cell.row.model or "").label,
                _printed(cell.row),
                format_figure(cell.row.mean, cell.row.sd),
                str(cell.verdict),
            ]
            for cell in cells
        ],
    )


def _printed(row: Row) -> str:
    """The paper's figure, with its SD if it prints one."""
    return f"{row.paper_mean:.3g}" + ("" if row.paper_sd is None else f" ± {row.paper_sd:.2g}")


UNIT_NOT_STATED: Final = "†"  # marks a length of the paper, whose unit it does not state


def paper_table(rows: Iterable[Row], task: str) -> str:
    """One task: measures down, models across, each figure with the paper's where it has one."""
    cells = {(row.measure, row.model or ""): row for row in rows if row.task == task}
    models = list(dict.fromkeys(model for _, model in cells))
    lines = [
        [
            next(measure_name(row) for row in cells.values() if row.measure == measure),
            *(_beside_paper(cells.get((measure, model))) for model in models),
        ]
        for measure in dict.fromkeys(measure for measure, _ in cells)
    ]
    return markdown_table(["mean ± SD", *(look_of(model).label for model in models)], lines)


def _beside_paper(row: Row | None) -> str:
    """A figure and, in brackets, the paper's to as many digits as it prints."""
    if row is None:
        return ABSENT
    figure = format_figure(row.mean, row.sd)
    length = LENGTHS.get((row.task or "", row.model or "", row.measure))
    mean, sd = length or (row.paper_mean, row.paper_sd)
    if mean is None:
        return figure
    spread = "" if sd is None else f" ± {sd:.2g}"
    return f"{figure} (paper: {mean:.3g}{spread}{f' {UNIT_NOT_STATED}' if length else ''})"
