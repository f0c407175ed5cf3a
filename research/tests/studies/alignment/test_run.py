import json
from dataclasses import replace
from pathlib import Path

import pytest

from latentarm.evaluation.measures import MEASURES
from latentarm_research.studies.alignment.preset import (
    CONDITIONS,
    IDEAL,
    PRESETS,
    Curves,
    Preset,
)
from latentarm_research.studies.alignment.study import STUDY
from latentarm_research.studies.page import PDF
from latentarm_research.studies.results_folder import CONFIG
from latentarm_research.studies.study import ALWAYS_MADE, Request, run_study

TINY = Preset(
    "tiny",
    episodes=3,
    test_episodes=2,
    epochs=1,
    hidden=(8,),
    noises=(0.0, 0.5),
    answers=4,
    ideal_answers=30,
    unlabelled=20,
    test_motions=20,
    runs=2,
    steps=2,
    ideal_runs=1,
    ideal_steps=2,
    surroundings=40,
    curves=Curves(noises=(0.0,), answers=(1, 4), candidates=8),
)


def tiny(out: Path, **changes) -> Request:
    return replace(Request(out, TINY, ("plane",), jobs=1, quiet=True), **changes)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A run on this process alone: its rows and its folder."""
    out = tmp_path_factory.mktemp("alone") / "run"
    return run_study(STUDY, tiny(out)).rows, out


def test_every_condition_and_noise_has_its_row(done):
    rows, out = done
    assert json.loads((out / "results.json").read_text())["rows"] == [row.as_json() for row in rows]
    assert {row.study for row in rows} == {"alignment"}
    assert {row.task for row in rows} == {"plane"}
    assert {row.measure for row in rows} <= set(MEASURES)
    of = {(row.model, row.condition, row.measure): row for row in rows}
    assert of["cae", "the encoder's own choice", "relative_alignment_error"].n == 1
    for noise in ("0", "0.5"):
        for name in CONDITIONS:
            row = of["cae", f"{name}, noise {noise}", "relative_alignment_error"]
            assert row.n == (1 if name in ("No Align", IDEAL) else TINY.runs)
            assert row.mean > 0
    assert of["cae", "Tool Space, chosen, 4 answers, noise 0", "relative_alignment_error"].n == TINY.runs
    assert of["cae", "All Priors, at random, 4 answers, noise 0", "relative_alignment_error"].mean > 0


def test_noise_changes_nothing_for_who_asks_nothing(done):
    rows, _ = done
    assert len({row.mean for row in rows if (row.condition or "")[:8] == "No Align"}) == 1


def test_the_folder_holds_what_was_made_and_the_page_reads_by_itself(done):
    _, out = done
    assert {path.name for path in out.iterdir()} == {
        CONFIG,
        *(set(ALWAYS_MADE) - {PDF}),
        *STUDY.documents,
        *(f"{name}.png" for name in STUDY.figures),
    }
    page = (out / "results.md").read_text()
    assert "**simulated**" in page
    assert "--preset tiny --task plane --seed 0" in page
    for words in ("H1", "H2", "H3", *CONDITIONS):
        assert words in page
    for name in STUDY.figures:
        assert f"]({name}.png)" in page
    runs = json.loads((out / "runs.json").read_text())
    assert all(len(one["values"]) in (1, 2) for one in runs)


def test_the_paper_preset_has_the_papers_numbers():
    paper = PRESETS["paper"]
    assert (paper.answers, paper.ideal_answers, paper.unlabelled, paper.runs) == (10, 1000, 1000, 10)
    assert paper.noises == (0.0, 0.1, 0.5)
    assert STUDY.tasks == ("plane", "pour", "reach_and_pour")
