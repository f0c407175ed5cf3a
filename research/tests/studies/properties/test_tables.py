"""How the cells of the paper's table compare."""

from dataclasses import replace

import pytest

from latentarm.core.types import Row
from latentarm_research.studies.properties.paper import OF_MEANS, PAPER
from latentarm_research.studies.properties.tables import (
    PaperVerdict,
    cells_table,
    count,
    judge,
    paper_cells,
)

FAVOUR, WITHIN, MISSED = PaperVerdict.IN_FAVOUR, PaperVerdict.WITHIN, PaperVerdict.MISSED


@pytest.mark.parametrize(
    ("mean", "better", "sees_context", "verdict"),
    [
        # Within one SD counts alike on either side.
        (8.0, "lower", True, WITHIN),
        (10.0, "lower", True, WITHIN),
        (12.0, "lower", True, WITHIN),
        # A model that sees the context: less loss is in the method's favour.
        (7.9, "lower", True, FAVOUR),
        (12.1, "lower", True, MISSED),
        # One that does not: more loss is, since the claim is that it fails.
        (12.1, "lower", False, FAVOUR),
        (7.9, "lower", False, MISSED),
        # Of angles and R^2 more is better.
        (12.1, "higher", True, FAVOUR),
        (7.9, "higher", True, MISSED),
        (7.9, "higher", False, FAVOUR),
        (12.1, "higher", False, MISSED),
    ],
)
def test_one_sd_counts_on_either_side_and_beyond_it_the_side_decides(mean, better, sees_context, verdict):
    assert judge(mean, 10.0, 2.0, better, sees_context) is verdict


def rows_of_the_paper():
    """Rows that repeat what the paper prints."""
    return [
        Row("properties", measure, "%", paper, 0.1, 10, task=task, model=model)
        for (task, model, measure), (paper, _) in PAPER.items()
    ]


def test_the_papers_own_figures_are_all_within_one_sd_and_its_yardsticks_are_no_cells():
    cells = paper_cells(rows_of_the_paper())
    assert count(cells) == (27, 0, 0)
    assert {(cell.row.model, cell.row.measure) for cell in cells if cell.row.model == "pca"} == {
        ("pca", "r2")
    }
    assert not any(cell.row.measure.endswith("_of_vae") and cell.row.model == "vae" for cell in cells)


def test_a_model_without_context_that_does_well_is_a_miss_and_the_table_says_so():
    rows = [
        replace(row, mean=34.0) if (row.task, row.model) == ("sine", "ae") else row
        for row in rows_of_the_paper()
    ]
    cells = paper_cells(rows)
    assert count(cells) == (25, 0, 2)  # its loss and its distance
    missed = [line for line in cells_table(cells).splitlines() if line.endswith("| missed |")]
    assert len(missed) == 2
    assert all(line.startswith("| sine |") and "| AE |" in line for line in missed)


def test_means_are_judged_where_asked_for():
    medians = rows_of_the_paper()
    of_means = [replace(row, measure=OF_MEANS[row.measure]) for row in medians if row.measure in OF_MEANS]
    assert len(paper_cells(of_means)) == 0
    assert len(paper_cells(of_means, means=True)) == 16
