import re

import numpy as np
import pytest

from latentarm.errors import UserError
from latentarm.metrics.summary import Subject, summarise
from latentarm.studies.properties.cell import Cell, CellResult
from latentarm.studies.properties.hypotheses import compare_models
from latentarm.studies.properties.page import TASKS, write_page
from latentarm.studies.properties.paper import with_paper
from latentarm.studies.properties.preset import PRESETS
from latentarm.studies.properties.tables import (
    OURS,
    as_good_as_paper,
    comparison_table,
    noise_table,
    paper_table,
)
from latentarm.tasks.planar.catalogue import MOTIONS
from latentarm.types import Row

ERROR = "error_percent_of_pca"


def row(model, mean, measure=ERROR, task="sine", condition=None, sd=0.5):
    return Row("properties", measure, "%", mean, sd, 10, task=task, model=model, condition=condition)


def lines(table):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]


def test_ours_stands_beside_the_papers_as_it_prints_it():
    rows = with_paper([row("ae", 90.0), row("cae", 1.234), row("scl", 2.0)])
    head, _, figures = lines(paper_table(rows, "sine"))
    assert head == ["mean ± SD", "AE", "cAE", "SCL"]
    assert figures == [
        "error, of PCA's (%)",
        "90.00 ± 0.50 (paper: 98 ± 0.6)",
        "1.23 ± 0.50 (paper: 1.37 ± 1.2)",
        "2.00 ± 0.50",
    ]


def test_a_length_of_the_paper_is_marked():
    rows = with_paper([row("cae", 0.02, "controllability_m", sd=None)])
    assert lines(paper_table(rows, "sine"))[2][1] == "0.0200 (paper: 0.05 ± 0.01 †)"


@pytest.mark.parametrize(
    ("measure", "ours", "text"),
    [
        (ERROR, 1.0, "yes"),
        (ERROR, 2.0, "yes"),
        (ERROR, 3.0, "no (cAE 2.00)"),
        ("r2", 7.0, "yes"),
        ("r2", 3.0, "no (AE 7.00)"),
        ("path_length", 3.0, "–"),
        (ERROR, None, "–"),
    ],
)
def test_our_model_is_held_against_the_papers_best(measure, ours, text):
    rows = [
        row("ae", 7.0, measure),
        row("cae", 2.0, measure),
        row("scl", 0.0, measure),
        row(OURS, ours, measure),
    ]
    head, _, figures = lines(paper_table(rows, "sine"))
    assert head[-1].endswith("at least as good as the paper's best")
    assert figures[-1] == text
    counted = text != "–"
    assert as_good_as_paper(rows, "sine") == (int(text == "yes"), int(counted))


def test_the_sweep_has_a_line_for_each_noise():
    rows = [
        row(model, mean + noise, condition=f"noise {noise:g} rad")
        for noise in (0.0, 0.1)
        for model, mean in {"ae": 90.0, "cae": 2.0}.items()
    ]
    rows += [row("ae", 1.0), row("cae", 3.0, "drift", condition="noise 0.1 rad")]
    assert lines(noise_table(rows, "sine"))[2:] == [
        ["error, of PCA's (%)", "noise 0 rad", "90.00 ± 0.50", "2.00 ± 0.50"],
        ["error, of PCA's (%)", "noise 0.1 rad", "90.10 ± 0.50", "2.10 ± 0.50"],
        ["drift, of motion (%)", "noise 0.1 rad", "–", "3.00 ± 0.50"],
    ]


def results_of(seeds=3, noises=(0.0, 0.1), tasks=tuple(MOTIONS)):
    rng = np.random.default_rng(0)
    results = []
    for task in tasks:
        for noise in noises:
            for model, mean in {"pca": 100.0, "vae": 80.0, "cvae": 4.0, "scl": 3.0}.items():
                figures = {ERROR: mean + rng.random(seeds), "r2": rng.uniform(0.95, 1.0, seeds)}
                results.append(
                    CellResult(
                        Cell(task, model, noise, PRESETS["smoke"], 0), figures, decoder=None, fit_s=0.0
                    )
                )
    return results


def written(out, results, tasks):
    rows = [
        summarise(Subject("properties", result.cell.task, result.cell.model, condition), measure, values)
        for result in results
        for condition in (None, f"noise {result.cell.noise_rad:g} rad")
        for measure, values in result.figures.items()
    ]
    tests = compare_models(results)
    write_page(out, results, with_paper(rows), tests, PRESETS["smoke"], tasks, 3)
    return (out / "results.md").read_text(), tests


def test_the_page_has_every_part(tmp_path):
    for name in ("sine_effects.png", "overview.png"):
        (tmp_path / name).touch()
    page, tests = written(tmp_path, results_of(), tuple(MOTIONS))
    assert "latentarm reproduce properties --preset smoke --seed 3" in page
    assert "**simulated**" in page
    assert re.findall(r"^## (.*)", page, flags=re.MULTILINE) == [
        "In short",
        "Sine",
        "Rotate",
        "Circle",
        "Reach",
        "How to read the tables",
        "Noise on the states",
        "Tests of the hypotheses",
    ]
    assert "**H1**" in page
    assert "**H2**" in page
    assert "\n- sine: supported\n" in page
    assert page.index("(overview.png)") < page.index("## Sine") < page.index("(sine_effects.png)")
    assert page.count("(sine_effects.png)") == 1
    assert comparison_table(tests) in page
    assert len(lines(comparison_table(tests))) == 2 + len(tests)


def test_every_table_of_the_page_has_as_many_cells_in_every_line(tmp_path):
    page, _ = written(tmp_path, results_of(), tuple(MOTIONS))
    for table in re.findall(r"(?:^\|.*\n)+", page, flags=re.MULTILINE):
        assert len({len(line) for line in lines(table)}) == 1


def test_a_part_of_the_study_names_its_tasks_and_leaves_out_what_was_not_done(tmp_path):
    page, _ = written(tmp_path, results_of(noises=(0.0,), tasks=("circle",)), ("circle",))
    assert "--task circle --seed 3" in page
    assert "## Sine" not in page
    assert "## Noise" not in page


def test_one_seed_makes_a_page_too(tmp_path):
    page, _ = written(tmp_path, results_of(seeds=1), tuple(MOTIONS))
    assert "nan" not in page
    assert "could not be tested" in page


def test_every_task_is_described():
    assert list(TASKS) == list(MOTIONS)


def test_a_page_that_cannot_be_written_is_the_users_to_mend(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(UserError, match="cannot be written"):
        write_page(tmp_path / "file", [], [], [], PRESETS["smoke"], (), 0)
