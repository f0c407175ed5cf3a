import json
from dataclasses import replace
from pathlib import Path

import pytest

from latentarm.core.errors import UserError
from latentarm_research.studies.properties.preset import PRESETS, Preset
from latentarm_research.studies.properties.study import STUDY
from latentarm_research.studies.results_folder import CONFIG
from latentarm_research.studies.study import ALWAYS_MADE, Request, run_study

TINY = Preset(
    "tiny",
    models=("pca", "vae", "cvae", "isometric"),
    episodes=4,
    test_episodes=2,
    seeds=2,
    epochs=1,
    hidden=(8,),
    reach_pairs=3,
    reach_goals=2,
    states=5,
    grid=5,
)
TASK = "reach"


def tiny(out: Path, **changes) -> Request:
    return replace(Request(out, TINY, (TASK,), jobs=1, quiet=True), **changes)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A run on this process alone: its rows and its folder."""
    out = tmp_path_factory.mktemp("alone") / "run"
    return run_study(STUDY, tiny(out)).rows, out


def test_every_model_has_its_figures(done):
    rows, out = done
    assert json.loads((out / "results.json").read_text())["rows"] == [row.as_json() for row in rows]
    assert {row.model for row in rows} == set(TINY.models)
    measured = {row.measure for row in rows}
    assert {"median_error_percent_of_pca", "r2", "drift", "reversal", "final_distance"} <= measured
    assert all(row.study == "properties" and row.task == TASK for row in rows)


def test_the_paper_stands_beside_what_it_prints(done):
    rows, _ = done
    assert any(row.paper_mean is not None for row in rows)


def test_the_folder_holds_what_is_promised(done):
    _, out = done
    made = {path.name for path in out.iterdir()}
    assert {"reach.png", "results.md", "results.json", "timings.json", CONFIG} <= made
    assert made <= {CONFIG, *ALWAYS_MADE, *STUDY.documents, *(f"{name}.png" for name in STUDY.figures)}
    assert json.loads((out / CONFIG).read_text())["preset"]["name"] == "tiny"
    values = json.loads((out / "seeds.json").read_text())
    assert {len(entry["values"]) for entry in values} == {TINY.seeds}


def test_sizes_that_make_no_sense_name_the_cell(tmp_path):
    with pytest.raises(UserError, match=r"reach, pca: .*demonstration"):
        run_study(STUDY, tiny(tmp_path, preset=replace(TINY, episodes=0)))


def test_presets_have_the_paper_s_setting_and_their_own_names():
    assert {name: preset.name for name, preset in PRESETS.items()} == {name: name for name in PRESETS}
