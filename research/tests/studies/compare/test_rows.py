"""Means and SDs of made-up cells, worked by hand."""

import numpy as np
import pytest

from latentarm.core.types import Row
from latentarm_research.studies.compare.cell import FoldResult, Place
from latentarm_research.studies.compare.tables import (
    in_millimetres,
    page_table,
    rows_of,
    rows_of_fewer,
    seeds_of,
)


def cell(fold: int, values: list[float], demonstrations: int = 4, measure: str = "reversal") -> FoldResult:
    place = Place("pour", 0.01, "cae", fold, demonstrations)
    return FoldResult(place, {measure: np.array(values)}, None)  # type: ignore[arg-type]


RESULTS = [cell(0, [0.1, 0.3]), cell(1, [0.5, 0.9])]


def test_seeds_are_averaged_over_folds_first() -> None:
    over_seeds, over_folds = rows_of(RESULTS)
    assert over_seeds.condition == "noise 0.01 rad"
    assert (over_seeds.mean, over_seeds.n) == (pytest.approx(0.45), 2)
    assert over_seeds.sd == pytest.approx(np.std([0.3, 0.6], ddof=1))
    assert over_folds.condition == "noise 0.01 rad, over folds"
    assert over_folds.mean == pytest.approx(0.45)
    assert over_folds.sd == pytest.approx(np.std([0.2, 0.7], ddof=1))


def test_a_fold_without_a_figure_does_not_take_the_others_away() -> None:
    over_seeds, _ = rows_of([cell(0, [np.nan, 0.2]), cell(1, [0.4, 0.4])])
    assert over_seeds.mean == pytest.approx((0.4 + 0.3) / 2)


def test_fewer_demonstrations_have_rows_of_their_own_fewest_first() -> None:
    rows = rows_of_fewer([*RESULTS, cell(0, [0.9, 0.9], 1), cell(1, [0.7, 0.7], 1)], {"pour": 4})
    assert [row.condition for row in rows] == [
        "noise 0.01 rad, 1 demonstration",
        "noise 0.01 rad, 4 demonstrations",
    ]
    assert rows[0].mean == pytest.approx(0.8)


def test_folds_that_leave_one_more_are_no_rows_of_their_own() -> None:
    rows = rows_of_fewer([cell(0, [0.2], 4), cell(1, [0.4], 5)], {"pour": 4})
    assert [row.mean for row in rows] == [pytest.approx(0.3)]


def test_every_seed_is_kept() -> None:
    kept = seeds_of([cell(0, [0.1, np.nan])])
    assert kept[0]["values"] == [0.1, None]


def test_the_table_shows_both_spreads_and_lengths_in_millimetres() -> None:
    table = page_table(
        rows_of(
            [cell(0, [0.012], measure="controllability_m"), cell(1, [0.008], measure="controllability_m")]
        ),
        "pour",
        0.01,
        ["controllability_m"],
    )
    assert "reaches goals to (mm)" in table
    assert "10.0 [2.8]" in table
    seconds = Row("compare", "time_s", "s", 1.0, None, 1)
    assert in_millimetres(seconds) is seconds
