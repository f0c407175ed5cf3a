import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from latentarm_research.studies.shared_autonomy.cell import METHODS, TASKS
from latentarm_research.studies.shared_autonomy.hypotheses import HYPOTHESES
from latentarm_research.studies.shared_autonomy.preset import PRESETS
from latentarm_research.studies.shared_autonomy.study import STUDY
from latentarm_research.studies.shared_autonomy.tables import EXTRA_TIME, Figure, Tables, figures, rows_of
from latentarm_research.studies.study import Request

from .test_figures import results_of


def lines(table):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]


OUT = Path("out")


@cache
def measured(preset_name, tasks):
    """Results that several tests look at, and none changes."""
    return results_of(OUT, PRESETS[preset_name], tasks)


@cache
def report_of(preset_name, tasks):
    return STUDY.report(Request(OUT, PRESETS[preset_name], tasks, seed=3), measured(preset_name, tasks))


@pytest.mark.parametrize("tasks", [tuple(TASKS), ("panda_two_cups",)])
def test_the_page_has_every_part(tasks):
    report = report_of("paper", tasks)
    page = report.page
    only = f" --task {tasks[0]}" if len(tasks) == 1 else ""
    assert f"latentarm reproduce shared-autonomy --preset paper{only} --seed 3" in page
    assert "**simulated**" in page
    assert re.findall(r"^## (.*)", page, flags=re.MULTILINE) == [
        "In short",
        *(["Planar, 5 joints"] if "planar_two_cups" in tasks else []),
        "Panda, 7 joints",
        "How to read the tables",
        "Tests of the hypotheses",
    ]
    for hypothesis in ("H1", "H2", "H3"):
        text = next(one.text for one in HYPOTHESES if one.name == hypothesis)
        assert page.count(f"\n| {hypothesis} | {text} |") == 2 * len(tasks)  # once for each model
    assert f"All {len(report.tests)} tests" in page
    assert page.count("<details>") == page.count("</details>") == 2 * len(tasks) + 1
    assert page.index("(panda_two_cups.png)") < page.index("## In short") < page.index("(learners.png)")
    assert set(report.figures) == set(STUDY.figures)


def figure(condition, measure, values, model="cae", task="panda_two_cups"):
    return Figure(task, model, condition, measure, values)


def test_people_stand_below_each_other_and_methods_side_by_side():
    values = np.array([[1.0], [2.0], [3.0]])
    found = [figure(f"{method}, beta 75", "final_state_error", values) for method in METHODS]
    preset = replace(PRESETS["smoke"], betas=(75.0, 3.0), learners={}, slopes=(), changes_s=())
    assert lines(Tables(found, preset).people("panda_two_cups", "cae", "final_state_error")) == [
        ["final state error", *METHODS],
        ["---", "---:", "---:", "---:"],
        ["beta 75", "2.0 ± 2.5", "2.0 ± 2.5", "2.0 ± 2.5"],  # 4.30 / root 3
        ["beta 3", "–", "–", "–"],
    ]


def test_the_paper_stands_beside_what_it_prints():
    found = figures(measured("paper", tuple(TASKS)))
    printed = {
        (row.task, row.model, row.measure, row.condition): row.paper_mean
        for row in rows_of(found)
        if row.paper_mean is not None
    }
    assert printed == {
        ("panda_two_cups", "cae", EXTRA_TIME, "beta 75"): 45.0,
        ("panda_two_cups", "cae", EXTRA_TIME, "beta 1000"): 30.0,
    }
    preset = replace(PRESETS["paper"], betas=(75.0, 3.0), learners={}, slopes=(), changes_s=())
    _, _, first, second = lines(Tables(found, preset).extra_time("panda_two_cups"))
    assert [cell.endswith("(paper: 45)") for cell in first].count(True) == 1
    assert not any("paper" in cell for cell in second)


def test_how_much_longer_without_help_is_taken_seed_by_seed():
    results = measured("paper", ("panda_two_cups",))
    found = {(one.condition, one.measure): one for one in figures(results) if one.model == "cae"}
    cell = next(result for result in results if (result.cell.model, result.cell.entropy) == ("cae", False))
    times = {
        one.method: one.figures["time_s"].mean(axis=1)
        for one in cell.outcomes
        if one.person.label == "beta 75"
    }
    extra = found["beta 75", EXTRA_TIME].values[:, 0]
    assert extra == pytest.approx(100.0 * (times["LA"] - times["LA+SA"]) / times["LA+SA"])


def test_the_terminal_shows_what_the_hypotheses_come_to():
    (table,) = report_of("paper", tuple(TASKS)).tables
    assert [column.header for column in table.columns][:1] == [""]
    assert {"says", "why"} <= {column.header for column in table.columns}
    assert report_of("smoke", tuple(TASKS)).tables == []


def test_a_smoke_run_says_so_and_judges_nothing():
    judged = report_of("paper", tuple(TASKS)).page
    page = report_of("smoke", tuple(TASKS)).page
    assert page.splitlines()[0] == "# Shared autonomy with latent actions (preset smoke)"
    verdict = re.compile(r"\| H\d|claims|Holm")
    assert verdict.search(judged)
    assert not verdict.search(page)
