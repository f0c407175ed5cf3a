import json
from dataclasses import replace
from pathlib import Path

import pytest

from latentarm.core.errors import UserError
from latentarm.evaluation.measures import MEASURES
from latentarm_research.studies.page import PDF
from latentarm_research.studies.results_folder import CONFIG
from latentarm_research.studies.shared_autonomy.cell import METHODS, TASKS
from latentarm_research.studies.shared_autonomy.preset import PRESETS, Preset
from latentarm_research.studies.shared_autonomy.study import MODELS, STUDY
from latentarm_research.studies.study import ALWAYS_MADE, Request, run_study

TINY = Preset(
    "tiny",
    demonstrations=4,
    seeds=3,
    drives=2,
    epochs=1,
    hidden=(8,),
    betas=(0.0, 75.0),
    learners={"slow": 10.0},
    slopes=(),
    changes_s=(1.0,),
    entropy_weight=2.0,
)
TASK = "planar_two_cups"


def tiny(out: Path, **changes) -> Request:
    return replace(Request(out, TINY, (TASK,), jobs=1, quiet=True), **changes)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A run on this process alone: its rows and its folder."""
    out = tmp_path_factory.mktemp("alone") / "run"
    return run_study(STUDY, tiny(out)).rows, out


def test_every_method_and_person_has_every_measure(done):
    rows, out = done
    assert json.loads((out / "results.json").read_text())["rows"] == [row.as_json() for row in rows]
    assert {row.study for row in rows} == {"shared_autonomy"}
    assert {row.task for row in rows} == {TASK}
    assert {row.model for row in rows} == set(MODELS)
    of = {(row.model, row.condition, row.measure): row for row in rows}
    measures = {row.measure for row in rows if row.condition == "LA, beta 75"}
    assert {"final_state_error", "time_s", "arrival_rate", "certified_share_eq_14"} <= measures
    assert measures <= set(MEASURES)
    for model in MODELS:
        for method in METHODS:
            for person in TINY.people:
                for measure in measures:
                    row = of[model, f"{method}, {person.label}", measure]
                    assert row.n == TINY.seeds
                    assert row.mean is not None


def test_without_help_nothing_is_certified(done):
    rows, _ = done
    shares = [row for row in rows if row.measure.startswith("certified_share")]
    assert all(row.mean == 0.0 for row in shares if (row.condition or "").startswith("LA, "))


def test_rows_stand_in_one_order_wherever_they_were_measured(done):
    rows, _ = done
    assert list(dict.fromkeys(row.model for row in rows)) == list(MODELS)


def test_the_folder_holds_what_is_promised(done):
    _, out = done
    made = {path.name for path in out.iterdir()}
    assert made == {
        CONFIG,
        *(set(ALWAYS_MADE) - {PDF}),
        *STUDY.documents,
        *(f"{name}.png" for name in STUDY.figures if name not in TASKS),
    }
    config = json.loads((out / CONFIG).read_text())
    assert config["preset"]["name"] == "tiny"
    assert config["preset"]["learners"] == {"slow": 10.0}
    seeds = json.loads((out / "seeds.json").read_text())
    rows = json.loads((out / "results.json").read_text())["rows"]
    assert [entry["mean"] for entry in seeds] == [row["mean"] for row in rows]
    assert {entry["over"] for entry in seeds} == {"seeds"}


def test_sizes_that_make_no_sense_name_the_cell(tmp_path):
    with pytest.raises(UserError, match=r"planar_two_cups, cvae, without entropy: .*demonstration"):
        run_study(STUDY, tiny(tmp_path, preset=replace(TINY, demonstrations=0)))


def test_presets_have_their_own_names_and_the_paper_s_has_everyone():
    assert {name: preset.name for name, preset in PRESETS.items()} == {name: name for name in PRESETS}
    labels = [person.label for person in PRESETS["paper"].people]
    assert len(set(labels)) == len(labels)
    assert {"beta 75", "beta 1000", "slow learner", "fast learner", "change after 8 s"} <= set(labels)
    assert max(person.changes_at_s for person in PRESETS["paper"].people) == 8.0
