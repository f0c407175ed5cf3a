import json
from dataclasses import replace
from pathlib import Path

import pytest

from latentarm.core.errors import UserError
from latentarm.evaluation.measures import MEASURES
from latentarm_research.studies.page import PDF
from latentarm_research.studies.results_folder import CONFIG
from latentarm_research.studies.shared_autonomy.cell import METHODS, TASKS, measure_cell
from latentarm_research.studies.shared_autonomy.preset import PRESETS, Ablation, Entropy, Preset, variants
from latentarm_research.studies.shared_autonomy.study import MODELS, STUDY, cells_of
from latentarm_research.studies.study import ALWAYS_MADE, Request, run_study

TINY = Preset(
    "tiny",
    demonstrations=4,
    test_demonstrations=1,
    seeds=3,
    drives=2,
    epochs=1,
    hidden=(8,),
    betas=(0.0, 75.0),
    learners={"slow": 10.0},
    slopes=(),
    changes_s=(1.0,),
    entropy=Entropy(weight=2.0, sharpness=8.0),
    ablation=Ablation(
        seeds=1, drives=2, weights=(0.0, 2.0), sharpness=(), contexts=("demonstrated",), without_no_goal=False
    ),
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
    assert {"final_state_error", "final_tool_error", "time_s", "arrival_rate", "success_rate"} <= measures
    assert measures <= set(MEASURES)
    for model in MODELS:
        for method in METHODS:
            for person in TINY.people:
                for measure in measures:
                    row = of[model, f"{method}, {person.label}", measure]
                    assert row.n == TINY.seeds
                    assert row.mean is not None
        for trained in ("without entropy", "with entropy"):
            assert of[model, trained, "noise_free_error_percent_of_pca"].mean > 0


def test_without_help_nothing_is_certified(done):
    rows, _ = done
    shares = [row for row in rows if row.measure.startswith("certified_share")]
    assert all(row.mean == 0.0 for row in shares if (row.condition or "").startswith("LA, "))


def test_every_variant_of_the_entropy_has_its_rows(done):
    rows, _ = done
    known = {(row.condition, row.measure) for row in rows if row.model == "cae"}
    every = replace(TINY.ablation, sharpness=(4.0,), without_no_goal=True)
    assert list(variants(every, TINY.entropy)) == [
        "lambda_2 0",
        "lambda_2 2",
        "kappa 4",
        "equation 15 to the letter",
        "progress of the joints alone",
        "contexts demonstrated",
    ]
    names = variants(TINY.ablation, TINY.entropy)
    assert names["lambda_2 0"] is None
    assert names["lambda_2 2"] == TINY.entropy
    for name in names:
        assert (name, "noise_free_error_percent_of_pca") in known
        assert {(f"{name}, {person.label}", "final_state_error") for person in TINY.varied_people} <= known


def test_what_is_varied_by_nothing_is_the_study_itself(tmp_path):
    """One of the three seeds, and its first drives: the same model, starts and chances."""
    whole = cells_of(tiny(tmp_path))
    proper = next(cell for cell in whole if (cell.model, cell.entropy) == ("cae", TINY.entropy))
    varied = next(cell for cell in whole if cell.variant == "lambda_2 2")
    latest = TINY.latest_change.label
    one, other = (
        next(outcome for outcome in measure_cell(cell).outcomes if outcome.person.label == latest)
        for cell in (replace(proper, drives=4), varied)
    )
    few = one.figures["final_state_error"][: TINY.ablation.seeds, : TINY.ablation.drives]
    assert other.figures["final_state_error"] == pytest.approx(few, rel=1e-3)


def test_rows_stand_in_one_order_wherever_they_were_measured(done):
    rows, _ = done
    proper = [row.model for row in rows if row.condition in ("without entropy", "with entropy")]
    assert proper == [model for model in MODELS for _ in range(2)]


def test_the_folder_holds_what_is_promised(done):
    _, out = done
    made = {path.name for path in out.iterdir()}
    assert made == {
        CONFIG,
        *(set(ALWAYS_MADE) - {PDF}),
        *STUDY.documents,
        *(f"{name}.png" for name in STUDY.figures if name not in TASKS or name == TASK),
    }
    config = json.loads((out / CONFIG).read_text())
    assert config["preset"]["name"] == "tiny"
    assert config["preset"]["learners"] == {"slow": 10.0}
    seeds = json.loads((out / "seeds.json").read_text())
    rows = json.loads((out / "results.json").read_text())["rows"]
    assert [entry["mean"] for entry in seeds] == [row["mean"] for row in rows]
    assert {entry["over"] for entry in seeds} == {"seeds", "drives"}


def test_sizes_that_make_no_sense_name_the_cell(tmp_path):
    with pytest.raises(UserError, match=r"planar_two_cups, cvae, without entropy: .*demonstration"):
        run_study(STUDY, tiny(tmp_path, preset=replace(TINY, demonstrations=0)))


def test_presets_have_their_own_names_and_the_paper_s_has_everyone():
    assert {name: preset.name for name, preset in PRESETS.items()} == {name: name for name in PRESETS}
    labels = [person.label for person in PRESETS["paper"].people]
    assert len(set(labels)) == len(labels)
    assert {"beta 75", "beta 1000", "slow learner", "fast learner", "change after 8 s"} <= set(labels)
    assert max(person.changes_at_s for person in PRESETS["paper"].people) == 8.0
