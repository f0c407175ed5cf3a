import io

import pytest
from rich.console import Console

from latentarm.core.types import Row
from latentarm.evaluation.table import format_figure, markdown_table, rich_tables

MODELS = ["pca", "ae", "vae", "cae", "cvae", "cae_zero", "scl"]


def rows_of(models):
    measures = [("error_percent_of_pca", "%", 28.13, 1.24), ("controllability_m", "m", 0.00912, 0.0004)]
    return [
        Row("evaluate", measure, unit, mean, sd, 5, model=model)
        for model in models
        for measure, unit, mean, sd in measures
    ]


def printed(rows, width):
    stream = io.StringIO()
    Console(file=stream, width=width, force_terminal=False).print(rich_tables(rows, "Held-out", width))
    return stream.getvalue()


@pytest.mark.parametrize(
    ("mean", "sd", "text"),
    [
        (28.134, 1.24, "28.1 ± 1.2"),
        (0.00912, 0.0004, "0.00912 ± 0.00040"),
        (0.875, None, "0.875"),
        (0.0, 0.0, "0"),
        (1.0, 0.0, "1.00"),
        (150.26, 12.31, "150 ± 12"),
        (99.97, 0.00001, "99.97 ± 0.00"),
        (None, None, "–"),
        (3e-9, None, "3e-09"),
        (3.5e-18, None, "0"),
    ],
)
def test_figures_are_rounded_to_what_their_spread_bears(mean, sd, text):
    assert format_figure(mean, sd) == text


@pytest.mark.parametrize("width", [80, 100])
def test_every_model_and_figure_is_on_a_page_of_any_usual_width(width):
    page = printed(rows_of(MODELS), width)
    assert max(map(len, page.splitlines())) <= width
    assert page.count("28.1 ± 1.2") == len(MODELS)
    assert page.count("0.00912 ± 0.00040") == len(MODELS)
    for label in ("PCA", "cVAE", "cAE, zero"):
        assert label in page
    assert "…" not in page


def test_a_spread_goes_under_its_mean_where_that_saves_a_second_table() -> None:
    page = printed(rows_of(MODELS[:4]), 80)
    assert page.count("mean ± SD") == 1
    assert "28.1 ± 1.2" not in page
    assert page.count("28.1") == page.count("± 1.2") == 4


def test_markdown_has_a_row_per_measure_and_a_column_per_model():
    lines = markdown_table(rows_of(["cae", "scl"])).splitlines()
    assert lines[0] == "| mean ± SD | cAE | SCL |"
    assert lines[1] == "|---|---:|---:|"
    assert lines[2] == "| error, of PCA's (%) | 28.1 ± 1.2 | 28.1 ± 1.2 |"
    assert len(lines) == 4


def test_a_measure_that_one_model_lacks_is_left_open():
    rows = [*rows_of(["cae"]), Row("evaluate", "drift", "1", 0.61, 0.02, 5, model="scl")]
    assert markdown_table(rows).splitlines()[-1] == "| drift, of motion | – | 0.610 ± 0.020 |"


def test_a_bar_in_a_name_cannot_break_the_table():
    table = markdown_table([Row("s", "drift", "1", 1.0, None, 1, model="a|b")])
    assert table.splitlines()[0] == "| mean ± SD | a\\|b |"


def test_figures_of_two_tasks_do_not_hide_each_other():
    means = {"pour": 0.1, "pick": 0.2}
    rows = [Row("compare", "drift", "1", mean, None, 5, task=task) for task, mean in means.items()]
    table = markdown_table(rows).splitlines()
    assert table[0] == "| mean ± SD | pour: compare | pick: compare |"
    assert table[2] == "| drift, of motion | 0.100 | 0.200 |"


def test_no_rows_are_an_empty_table():
    assert printed([], 80).strip() == ""
    assert markdown_table([]) == "| mean ± SD |\n|---|\n"


def test_the_rounding_of_equal_figures_is_no_spread() -> None:
    assert format_figure(0.9634, 1.2e-16) == format_figure(0.9634, None)
