import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.types import Row
from latentarm_research.studies.claim_tables import claim_table
from latentarm_research.studies.properties.cell import PropertiesCell, PropertiesResult
from latentarm_research.studies.properties.paper import with_paper
from latentarm_research.studies.properties.preset import PRESETS
from latentarm_research.studies.properties.study import STUDY
from latentarm_research.studies.properties.tables import (
    paper_table,
)
from latentarm_research.studies.study import Request
from latentarm_research.tasks.planar.catalogue import MOTIONS

from .test_figures import Turning

ERROR = "median_error_percent_of_pca"


def row(model, mean, measure=ERROR, task="sine", sd=0.5):
    return Row("properties", measure, "%", mean, sd, 10, task=task, model=model)


def lines(table):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]


def test_ours_stands_beside_the_papers_as_it_prints_it():
    rows = with_paper([row("ae", 90.0), row("cae", 1.234), row("scl", 2.0)])
    head, _, figures = lines(paper_table(rows, "sine"))
    assert head == ["mean ± SD", "AE", "cAE", "SCL"]
    assert figures == [
        "median error, of PCA's (%)",
        "90.00 ± 0.50 (paper: 98 ± 0.6)",
        "1.23 ± 0.50 (paper: 1.37 ± 1.2)",
        "2.00 ± 0.50",
    ]


def test_a_length_of_the_paper_is_marked():
    rows = with_paper([row("cae", 0.02, "controllability_m", sd=None)])
    assert lines(paper_table(rows, "sine"))[2][1] == "0.0200 (paper: 0.05 ± 0.01 †)"


SMALL = replace(PRESETS["smoke"], name="small")
"""A preset whose hypotheses are judged."""


def results_of(seeds=3, tasks=tuple(MOTIONS)):
    rng = np.random.default_rng(0)
    results = []
    for task in tasks:
        for model, mean in {"pca": 100.0, "vae": 80.0, "cvae": 4.0, "scl": 3.0}.items():
            figures = {ERROR: mean + rng.random(seeds), "r2": rng.uniform(0.95, 1.0, seeds)}
            results.append(
                PropertiesResult(
                    PropertiesCell(task, model, SMALL, 0),
                    figures,
                    Turning(MOTIONS[task]().latent_dim, MOTIONS[task]().robot.dof),
                )
            )
    return results


def page_of(results, tasks, preset=SMALL):
    request = Request(Path("out"), preset, tasks, seed=3)
    return STUDY.report(request, results)


@pytest.fixture(scope="module")
def report():
    return page_of(results_of(), tuple(MOTIONS))


def test_the_page_has_every_part(report):
    page = report.page
    assert "latentarm reproduce properties --preset small --seed 3" in page
    assert "**simulated**" in page
    assert re.findall(r"^## (.*)", page, flags=re.MULTILINE) == [
        "In short",
        "The paper's cells",
        "Sine",
        "Rotate",
        "Circle",
        "Reach",
        "How to read the tables",
        "Tests of the hypotheses",
    ]
    assert re.search(
        r"^\| H1 \| only latent action models .* \| sine \| held \| all \d+ claims hold \|$", page, re.M
    )
    assert re.search(r"^\| H2 \| conditioned models ", page, re.M)
    assert page.index("(beside_paper.png)") < page.index("## Sine") < page.index("(sine.png)")
    assert page.count("(sine.png)") == 1
    assert claim_table(report.tests) in page
    assert len(lines(claim_table(report.tests))) == 2 + len(report.tests)
    assert set(report.figures) == set(STUDY.figures)


def test_every_table_of_the_page_has_as_many_cells_in_every_line(report):
    for table in re.findall(r"(?:^\|.*\n)+", report.page, flags=re.MULTILINE):
        assert len({len(line) for line in lines(table)}) == 1


def test_one_seed_of_one_task_leaves_out_what_was_not_done():
    page = page_of(results_of(seeds=1, tasks=("circle",)), ("circle",)).page
    assert "--task circle --seed 3" in page
    assert "## Sine" not in page
    assert "nan" not in page
    assert "could not be tested" in page


def test_a_smoke_run_says_so_and_judges_nothing(report):
    page = page_of(results_of(tasks=("circle",)), ("circle",), PRESETS["smoke"]).page
    assert page.splitlines()[0] == f"{report.page.splitlines()[0]} (preset smoke)"
    verdict = re.compile(r"\| H\d|claims|Holm")
    assert verdict.search(report.page)
    assert not verdict.search(page)
