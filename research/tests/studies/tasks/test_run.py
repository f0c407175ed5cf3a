"""The study of tasks with things: a tiny one from end to end in physics, and what it makes of runs."""

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import final

import pytest

from figure_faults import faults
from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm.models.saving import load_decoder
from latentarm.tasks.catalogue import SCENE_TASKS, make_scene_task
from latentarm.tasks.eating.marshmallows import Marshmallows
from latentarm.tasks.scene_task import SceneTask
from latentarm_research.studies.page import PDF
from latentarm_research.studies.results_folder import CONFIG
from latentarm_research.studies.study import ALWAYS_MADE, Request, again, run_study
from latentarm_research.studies.tasks.cell import show, training_set
from latentarm_research.studies.tasks.figures import success_figure
from latentarm_research.studies.tasks.kept import MODELS
from latentarm_research.studies.tasks.preset import (
    DEMONSTRATOR,
    ORIENTED,
    PRESETS,
    SWITCHING,
    Condition,
    Preset,
)
from latentarm_research.studies.tasks.rows import rows_of, runs_as_json
from latentarm_research.studies.tasks.runs import Driver, Run, kept_in, time_ratios
from latentarm_research.studies.tasks.study import STUDY
from latentarm_research.studies.tasks.tables import failure_table, measure_table, success_table, time_table
from made_drives import drive_of

TINY = Preset(
    "tiny",
    runs=1,
    demonstrations=2,
    models=("pca",),
    seeds=1,
    epochs=1,
    hidden=(8,),
    people=("greedy",),
)
ASKED = Request(Path("nowhere"), TINY, ("marshmallows",), jobs=1, quiet=True)
LEARNED = [Condition(TINY.context, "pca", way_back) for way_back in (False, True)]
DRIVEN = [Condition(SWITCHING), Condition(ORIENTED), *LEARNED]

KEPT = ("runs", MODELS)


@final
class Brief(SceneTask):
    """Only the way to above a marshmallow, in little time."""

    name = "marshmallows"
    robot = property(lambda self: self._whole.robot)
    choices = property(lambda self: self._whole.choices)
    obstacles = property(lambda self: self._whole.obstacles)
    time_limit_s = 4.0

    def __init__(self):
        self._whole = Marshmallows()

    def begin(self, choice, rng):
        begun = self._whole.begin(choice, rng)
        return replace(begun, steps=begun.steps[:1])


@pytest.fixture(autouse=True, scope="module")
def _brief():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("latentarm_research.studies.tasks.cell.task_of", lambda name, stream: Brief())
        # Two demonstrations show nothing that a network could learn.
        patch.setattr("latentarm.models.model.with_way_back", lambda trained, *_: trained)
        yield


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    out = tmp_path_factory.mktemp("tasks") / "run"
    return run_study(STUDY, replace(ASKED, out=out)), out


def test_every_condition_has_its_runs_of_the_same_scene(done):
    report, out = done
    runs = json.loads((out / "runs.json").read_text())
    assert [Condition(run["condition"], run["model"], run["way_back"], run["person"]) for run in runs] == [
        Condition(DEMONSTRATOR),
        *(one.by(person) for one in DRIVEN for person in TINY.people),
    ]
    assert {(run["number"], run["choice"], tuple(run["steps"])) for run in runs} == {
        (0, "left marshmallow", ("above",))
    }
    assert runs[0]["success"]
    assert all(run["time_s"] > 0 for run in runs)
    assert {row.study for row in report.rows} == {"tasks"}


def test_beside_a_model_stand_the_modes_that_a_person_can_switch_to(done):
    _, out = done
    decoder = load_decoder(out / MODELS / kept_in("marshmallows", LEARNED[0]))
    alone, switching, beside = (
        Driver(condition, (decoder,) if condition.model else ()).controller(Brief().robot, 0)
        for condition in (LEARNED[0], Condition(SWITCHING), replace(LEARNED[0], beside=True))
    )
    assert beside.modes == (*alone.modes, *switching.modes)


def test_the_folder_holds_what_was_made_and_the_page_reads_by_itself(done):
    _, out = done
    assert {path.name for path in out.iterdir()} == {
        CONFIG,
        *(set(ALWAYS_MADE) - {PDF}),
        "runs.json",
        "verdict.json",
        "success.png",
        *KEPT,
    }
    page = (out / "results.md").read_text()
    assert "**simulated**" in page
    assert "--preset tiny --task marshmallows --seed 0" in page
    for words in (
        "scripted demonstrator | – | 1 of 1",
        "| simulated | greedy |",
        "position by the stick, orientation learned",
        "PCA + way back, joints objects_in_tool",
        "mode switching",
        "success.png",
        "**not decided: 0 runs per cell",
        "No way back** was better than none",
    ):
        assert words in page


def test_the_models_that_were_driven_with_are_kept(done):
    _, out = done
    kept = out / MODELS / kept_in("marshmallows", LEARNED[0])
    assert load_decoder(kept).kind == "pca"
    assert read_object(kept / CONFIG)["preset"]["name"] == TINY.name


def never(cell):
    raise AssertionError(f"{cell} was measured again")


@pytest.fixture
def stopped(done, tmp_path, monkeypatch):
    """A study that was stopped after its last cell, of which only drives are measured again."""
    out = tmp_path / "run"
    shutil.copytree(done[1], out)
    (out / "results.json").unlink()
    for name in ("show", "train"):
        monkeypatch.setattr(f"latentarm_research.studies.tasks.study.{name}", never)
    return out


def test_a_study_that_was_stopped_goes_on_and_finds_the_same(done, stopped):
    kept = stopped / "runs" / "marshmallows" / "greedy" / DRIVEN[0].folder / "0.json"
    before = kept.read_text()
    kept.unlink()
    run_study(STUDY, replace(ASKED, out=stopped))
    for name in ("runs.json", "results.json", "results.md"):
        assert (stopped / name).read_text() == (done[1] / name).read_text()
    assert kept.read_text() == before


def test_more_people_and_runs_are_added(stopped, monkeypatch):
    measured = []

    def drive(cell):
        measured.append((cell.person, cell.number))
        return ran(cell.number, 1)

    monkeypatch.setattr("latentarm_research.studies.tasks.study.drive", drive)
    monkeypatch.setattr("latentarm_research.studies.tasks.study.show", show)
    more = replace(TINY, people=("unsteady", "greedy"), runs=2)
    for _ in range(2):
        run_study(STUDY, replace(ASKED, out=stopped, preset=more))
        added = [("unsteady", 0)] * 4 + [("unsteady", 1), ("greedy", 1)] * 4
        assert measured == added, "the second time nothing is missing"


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"seed": 1}, "seed 0 there, 1 now"),
        ({"preset": replace(TINY, epochs=2)}, "preset .* there, .* now"),
    ],
)
def test_a_study_does_not_go_on_from_another(stopped, changes, said):
    with pytest.raises(UserError, match=f"{said}.*--out"):
        run_study(STUDY, replace(ASKED, out=stopped, **changes))


def test_a_study_does_not_go_on_with_other_code(stopped, monkeypatch):
    monkeypatch.setattr("latentarm_research.studies.tasks.study.source_digest", lambda modules: "other")
    with pytest.raises(UserError, match=r'code ".*" there, "other" now.*--out'):
        run_study(STUDY, replace(ASKED, out=stopped))


@pytest.mark.parametrize(
    ("name", "changed", "said"),
    [
        ("runs/marshmallows/greedy/end_effector/0.json", {"done": "1"}, "'done' must be a whole number"),
        (
            "runs/marshmallows/greedy/end_effector/0.json",
            {"number": 3},
            "is no run 0 of this study: remove it",
        ),
        ("runs/marshmallows/demonstrations/0.json", {"sha256": "0"}, "does not have the SHA-256"),
        ("runs/marshmallows/demonstrations/0.json", {"text": 3}, "'text' must be a text"),
    ],
)
def test_a_damaged_cell_is_named(stopped, name, changed, said):
    path = stopped / name
    path.write_text(json.dumps(json.loads(path.read_text()) | changed))
    with pytest.raises(UserError, match=said):
        run_study(STUDY, replace(ASKED, out=stopped))


@pytest.mark.parametrize(("people", "runs"), [(("nobody",), None), (("greedy", "greedy"), None), ((), 0)])
def test_who_drives_and_how_often_is_checked(people, runs):
    with pytest.raises(UserError, match=r"choose from greedy|none twice|at least 1"):
        PRESETS["paper"].asked(people, runs)


def test_the_command_names_what_it_was_asked_for():
    asked = Request(Path("out"), PRESETS["small"].asked(("greedy",), 4), ("pour", "dessert"))
    words = "--preset small --task pour --task dessert --people greedy --runs 4 --seed 0"
    assert again(STUDY, asked) == f"latentarm reproduce tasks {words}"


def test_models_need_demonstrations():
    with pytest.raises(UserError, match="0 demonstrations of the task marshmallows succeeded"):
        training_set("marshmallows", [])


def test_only_tasks_of_the_catalogue_are_made():
    assert {name: make_scene_task(name).name for name in SCENE_TASKS} == {name: name for name in SCENE_TASKS}
    with pytest.raises(UserError, match="not one of marshmallows"):
        make_scene_task("soup")


def ran(number, done, why="done", steps=("above", "stabbed"), drive=True):
    success = done == len(steps) and why == "done"
    measured = drive_of(success, steps_done=done / len(steps)) if drive else None
    ended_in = "" if done == len(steps) else f"the {steps[done]} one"
    return Run(number, "left", steps, done, success, ended_in, why, 9.0, measured)


SHOWN, SWITCHED = Condition(DEMONSTRATOR), Condition(SWITCHING, person="greedy")
LATENT = Condition("joints", "cvae", person="greedy")
RUNS = {
    SHOWN: [ran(0, 2, drive=False), ran(1, 2, drive=False)],
    SWITCHED: [ran(0, 2), ran(1, 2, "dropped the left one")],
    LATENT: [ran(0, 0, "no nearer for 20 s"), ran(1, 1, "out of time")],
}


def test_times_are_compared_where_both_succeed():
    fast = [replace(ran(number, done), time_s=3.0) for number, done in ((0, 2), (1, 2), (2, 1))]
    assert time_ratios(fast, RUNS[SWITCHED]) == [pytest.approx(1 / 3)]
    runs = {**RUNS, LATENT: fast, LATENT.by("unsteady"): fast}
    assert time_table(runs).splitlines()[2:] == [
        "| mode switching | 9 | – |",
        "| cVAE, joints | 3 (0.33) | 3 |",
    ]
    assert "| cVAE, joints | 2 of 3 | 2 of 3 |" in success_table(runs)


def test_tables_say_how_many_succeed_and_where_and_why_the_others_end():
    rows = rows_of({"dessert": RUNS})
    table = measure_table(rows, RUNS, "dessert")
    assert "| mode switching | greedy | 1 of 2 |" in table
    assert "spilled" not in table, "there were no grains"
    ends = failure_table(RUNS).splitlines()
    assert ends[2:] == [
        "| greedy | 1. above | no nearer for 20 s | – | – | 1 |",
        "| greedy | 2. stabbed | out of time | – | – | 1 |",
        "| greedy | after the last | dropped the left one | – | 1 | – |",
    ]
    assert failure_table({SHOWN: RUNS[SHOWN]}) == ""


def test_every_run_is_kept_and_what_has_no_value_is_null():
    kept = runs_as_json({"dessert": RUNS})
    json.dumps(kept, allow_nan=False)
    assert len(kept) == 6
    assert kept[2]["preference_alignment"] is None
    assert kept[4] | {"model": "cvae", "condition": "joints", "ended_in": "the above one"} == kept[4]


@pytest.mark.parametrize("people", [("greedy",), ("planning", "greedy", "learning")])
def test_the_figure_has_a_panel_per_person(people):
    runs = {one.by(person): RUNS[one] for one in (SWITCHED, LATENT) for person in people}
    figure = success_figure({f"task {index}": {SHOWN: RUNS[SHOWN], **runs} for index in range(4)})
    assert faults(figure) == []
    shown = [axes for axes in figure.axes if axes.get_visible()]
    assert len(shown) == len(people)
    assert [list(line.get_ydata()) for line in shown[0].lines] == [[50.0] * 4, [0.0] * 4]
