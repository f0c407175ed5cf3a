"""The study of tasks with things: a tiny one from end to end in physics, and what it makes of runs."""

import json
from dataclasses import replace
from typing import final

import pytest

from figure_faults import faults
from latentarm.errors import UserError
from latentarm.metrics.drives import Drive
from latentarm.metrics.task_drives import TaskDrive
from latentarm.models.saving import load_decoder
from latentarm.runs.results_folder import CONFIG
from latentarm.studies.study import ALWAYS_MADE, MODELS, Request, run_study
from latentarm.studies.tasks.cell import training_set
from latentarm.studies.tasks.figures import steps_figure
from latentarm.studies.tasks.preset import Preset
from latentarm.studies.tasks.rows import rows_of, runs_as_json
from latentarm.studies.tasks.runs import DEMONSTRATOR, SWITCHING, Condition, Run, kept_in, through
from latentarm.studies.tasks.study import STUDY
from latentarm.studies.tasks.tables import failure_table, measure_table
from latentarm.tasks.catalogue import SCENE_TASKS, make_scene_task
from latentarm.tasks.eating.marshmallows import Marshmallows
from latentarm.tasks.scene_task import SceneTask
from latentarm.untrusted.documents import read_object

TINY = Preset(
    "tiny", runs=1, demonstrations=2, models=("homogeneous",), seeds=1, epochs=1, hidden=(8,), block=2
)


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


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    out = tmp_path_factory.mktemp("tasks") / "run"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("latentarm.studies.tasks.cell.task_of", lambda name, stream: Brief())
        return run_study(STUDY, Request(out, TINY, ("marshmallows",), jobs=1, quiet=True)), out


def test_every_condition_has_its_runs_of_the_same_scene(done):
    report, out = done
    runs = json.loads((out / "runs.json").read_text())
    assert [(run["model"], run["condition"]) for run in runs] == [
        (None, DEMONSTRATOR),
        (None, SWITCHING),
        ("homogeneous", "joints objects"),
    ]
    assert {(run["number"], run["choice"], tuple(run["steps"])) for run in runs} == {
        (0, "left marshmallow", ("above",))
    }
    assert runs[0]["success"]
    assert all(run["time_s"] > 0 for run in runs)
    assert {row.study for row in report.rows} == {"tasks"}


def test_the_folder_holds_what_was_made_and_the_page_reads_by_itself(done):
    _, out = done
    assert {path.name for path in out.iterdir()} == {CONFIG, *ALWAYS_MADE, "runs.json", "steps.png", MODELS}
    page = (out / "results.md").read_text()
    assert "**simulated**" in page
    assert "--preset tiny --task marshmallows --seed 0" in page
    for words in (
        "scripted demonstrator | 1 of 1",
        "homogeneous, joints objects",
        "mode switching",
        "steps.png",
    ):
        assert words in page


def test_the_models_that_were_driven_with_are_kept(done):
    _, out = done
    kept = out / MODELS / kept_in("marshmallows", Condition("joints objects", "homogeneous"))
    assert load_decoder(kept).kind == "homogeneous"
    assert read_object(kept / CONFIG)["preset"]["name"] == TINY.name


def test_models_need_demonstrations():
    with pytest.raises(UserError, match="0 demonstrations of the task marshmallows succeeded"):
        training_set("marshmallows", [])


def test_only_tasks_of_the_catalogue_are_made():
    assert {name: make_scene_task(name).name for name in SCENE_TASKS} == {name: name for name in SCENE_TASKS}
    with pytest.raises(UserError, match="not one of marshmallows"):
        make_scene_task("soup")


def figures(success, steps_done):
    return TaskDrive(Drive(success, 1.0, 1.0, 1.0, 1.0, 3, 1.0), steps_done, 0, float("nan"), 1.0, 1.0, 0, 0)


def ran(number, done, why="done", steps=("above", "stabbed"), drive=True):
    success = done == len(steps) and why == "done"
    measured = figures(success=success, steps_done=done / len(steps)) if drive else None
    ended_in = "" if done == len(steps) else f"the {steps[done]} one"
    return Run(number, "left", steps, done, success, ended_in, why, 9.0, measured)


SHOWN, SWITCHED, LATENT = Condition(DEMONSTRATOR), Condition(SWITCHING), Condition("joints", "cvae")
RUNS = {
    SHOWN: [ran(0, 2, drive=False), ran(1, 2, drive=False)],
    SWITCHED: [ran(0, 2), ran(1, 2, "dropped the left one")],
    LATENT: [ran(0, 0, "no nearer for 20 s"), ran(1, 1, "out of time")],
}


def test_the_share_that_gets_through_a_step_never_grows():
    assert through(RUNS[LATENT]) == [1.0, 0.5, 0.0]
    assert through([ran(0, 1, steps=("above",)), ran(1, 1)]) == [1.0, 1.0, 0.5], "a short run is through"


def test_tables_say_how_many_succeed_and_where_and_why_the_others_end():
    rows = rows_of({"dessert": RUNS})
    table = measure_table(rows, RUNS, "dessert")
    assert "| mode switching | 1 of 2 |" in table
    assert "spilled" not in table, "there were no grains"
    ends = failure_table(RUNS).splitlines()
    assert ends[2:] == [
        "| 1. above | no nearer for 20 s | – | – | 1 |",
        "| 2. stabbed | out of time | – | – | 1 |",
        "| after the last | dropped the left one | – | 1 | – |",
    ]
    assert failure_table({SHOWN: RUNS[SHOWN]}) == ""


def test_every_run_is_kept_and_what_has_no_value_is_null():
    kept = runs_as_json({"dessert": RUNS})
    json.dumps(kept, allow_nan=False)
    assert len(kept) == 6
    assert kept[2]["preference_alignment"] is None
    assert kept[4] | {"model": "cvae", "condition": "joints", "ended_in": "the above one"} == kept[4]


@pytest.mark.parametrize("tasks", [1, 4])
def test_the_figure_has_a_panel_per_task_and_a_line_per_condition(tasks):
    figure = steps_figure({f"task {index}": RUNS for index in range(tasks)})
    assert faults(figure) == []
    shown = [axes for axes in figure.axes if axes.get_visible()]
    assert len(shown) == tasks
    assert all(len(axes.lines) == len(RUNS) for axes in shown)
