"""Record, train and drive over the page's socket, without a browser."""

import shutil
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.types import Command, Goal, Pose, Provenance, StepRecord
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder
from latentarm.runs.folder import read_run
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.jobs.chosen import Chosen, check_alike, read_chosen
from latentarm.web.jobs.training import FEWEST, TrainingJob, TrainingPlan, train_as_planned
from latentarm.web.protocol.notice import NoticeError
from latentarm.web.protocol.page_messages import parse_message
from latentarm.web.server.loaded_run import RunList

from .conftest import said, wait_for

JOINTS = tuple(f"joint{number}" for number in range(1, 8))


def journal_of(path, seconds, *, alike=False, task_name="", **header):
    """Episodes in which a Panda moves for so long, each its own way unless all are alike."""
    about = {"robot": "panda", "rate_hz": 100.0, "provenance": Provenance(task_name=task_name), **header}
    recorder = Recorder(path)
    rng = np.random.default_rng(0)
    start = np.array([0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.8])
    for span_s in seconds:
        velocity = np.full(7, 0.1) if alike else rng.normal(scale=0.1, size=7)
        recorder.begin_episode(EpisodeHeader(joint_names=JOINTS, task="wave", **about))
        for tick in range(round(100 * span_s) + 1):
            nothing = np.zeros(7)
            recorder.record(
                StepRecord(
                    time_s=tick / 100,
                    state=start + velocity * tick / 100,
                    input=np.zeros(2),
                    latent=np.zeros(2),
                    action_human=nothing,
                    action_assist=nothing,
                    alpha=0.0,
                    belief=np.zeros(0),
                    mode=0,
                    command=Command(velocity=velocity, duration_s=0.01, stop=None, limited_by=()),
                    bound_rad=np.nan,
                )
            )
        recorder.end_episode()
    recorder.close()
    return path


def planned(folder, seconds=(2.0, 2.0, 2.0), name="waving", model="pca", episodes=None):
    journal = folder / "journal.sqlite"
    if not journal.exists():
        journal_of(journal, seconds)
    numbers = episodes or tuple(range(1, len(seconds) + 1))
    return TrainingPlan(chosen_of(journal, *numbers), name, model, 2, folder)


def chosen_of(journal, *numbers, called=0):
    return tuple(Chosen(journal, number, number + called) for number in numbers)


def ended(job):
    wait_for(lambda: job.look() and not job.under_way)
    return job.look()


@pytest.mark.slow
def test_a_training_goes_from_the_journal_to_a_run_that_says_what_it_learned_from(tmp_path):
    job = TrainingJob(planned(tmp_path, model="cae"))
    heard = []
    while job.under_way:
        heard.append(job.look())
        time.sleep(0.02)
    done = job.look()
    job.cancel()
    assert done.phase == "done"
    assert {one.phase for one in heard} >= {"exporting", "training"}
    assert done.epoch > 0
    assert done.epochs == 30
    assert done.loss is not None
    run = read_run(tmp_path / "runs" / "waving")
    dataset = run.dataset()
    assert dataset.rate_hz == 10.0
    assert [len(episode.state) for episode in dataset.episodes] == [21] * 3
    assert {episode.task for episode in dataset.episodes} == {"wave"}
    assert RunList(tmp_path, None).runs() == {"waving": tmp_path / "runs" / "waving"}


def test_episodes_that_are_too_short_are_named_in_a_sentence_and_nothing_is_left(tmp_path):
    job = TrainingJob(planned(tmp_path, (2.0, 2.0, 0.4)))
    failed = ended(job)
    assert failed.phase == "failed"
    (why,) = failed.why
    assert why.code == "episodes_too_short"
    assert why.text.startswith("Recording 3 is too short: the arm moves for less than 1 s.")
    assert not list(tmp_path.glob("*/waving"))


class Listener:
    """Hears what a training says, in the same process."""

    def __init__(self):
        self.said = []

    def say(self, message):
        self.said.append(message)


def test_an_axis_that_moves_nothing_is_named(tmp_path):
    plan = planned(tmp_path)
    journal_of(tmp_path / "alike.sqlite", (2.0, 2.0, 2.0), alike=True)
    wire = Listener()
    train_as_planned(wire, replace(plan, chosen=chosen_of(tmp_path / "alike.sqlite", 1, 2, 3)))
    lesson = wire.said[-1].lesson
    assert len(lesson.weak) == 1
    assert (lesson.recordings, lesson.learned_from) == (3, 1)
    assert wire.said[-1].why == ()


def test_a_run_is_driven_where_its_recordings_were_made_also_those_of_earlier_starts(tmp_path):
    earlier = journal_of(tmp_path / "earlier.sqlite", (2.0, 2.0), task_name="marshmallows")
    now = journal_of(tmp_path / "now.sqlite", (2.0, 2.0), task_name="marshmallows")
    chosen = (*chosen_of(earlier, 1, 2), *chosen_of(now, 2, called=2))
    train_as_planned(wire := Listener(), TrainingPlan(chosen, "fed", "pca", 2, tmp_path))
    assert wire.said[-1].phase == "done"
    run = read_run(tmp_path / "runs" / "fed")
    assert run.task == "marshmallows"
    assert {one.task for one in run.dataset().episodes} == {"wave"}
    for server in (Spec(), Spec(task="dessert")):
        setup = load_setup(server.with_run(run.folder, own_task=True))
        assert setup.todo.task == "marshmallows"
        assert "plate" in setup.shown.names
        assert {goal.name for goal in setup.task.goals} <= set(setup.shown.names)
    assert load_setup(Spec(run.folder, task="dessert")).todo.task == "dessert", "as the command says"


@pytest.mark.parametrize(
    ("other", "code"),
    [
        ({"robot": "arm.xml"}, "recordings_of_robots"),
        ({"rate_hz": 50.0}, "recordings_of_rates"),
        ({"task_name": "dessert"}, "recordings_of_tasks"),
        ({"goals": (Goal("cup", np.zeros(7), Pose(np.zeros(3), np.eye(3))),)}, "recordings_of_tasks"),
    ],
)
def test_recordings_that_do_not_go_together_are_named(tmp_path, other, code):
    first = journal_of(tmp_path / "first.sqlite", (1.0, 1.0), task_name="marshmallows")
    # A recording that does not say its task goes with any that has the same things.
    silent = journal_of(tmp_path / "silent.sqlite", (1.0,))
    check_alike(read_chosen((*chosen_of(first, 1), *chosen_of(silent, 1, called=8))))
    second = journal_of(tmp_path / "second.sqlite", (1.0,), **{"task_name": "marshmallows", **other})
    with pytest.raises(NoticeError) as refused:
        check_alike(read_chosen((*chosen_of(first, 1, 2), *chosen_of(second, 1, called=2))))
    assert refused.value.notice.code == code
    assert refused.value.notice.parameters == {"number": 3, "other": 1}


def test_a_full_disk_is_said_and_leaves_nothing(tmp_path):
    plan = planned(tmp_path)
    (tmp_path / "datasets").write_text("a file where a folder must be")
    failed = ended(TrainingJob(plan))
    assert failed.phase == "failed"
    assert "datasets" in failed.why[0].text
    assert not (tmp_path / "runs").exists()


@pytest.mark.slow
def test_a_cancelled_training_leaves_nothing(tmp_path):
    job = TrainingJob(planned(tmp_path, (30.0,) * 5, model="homogeneous"))
    wait_for(lambda: job.look().phase == "training")
    job.cancel()
    assert job.look().phase == "cancelled"
    assert not list(tmp_path.glob("datasets/*"))
    assert not list(tmp_path.glob("runs/*"))
    assert planned(tmp_path, (30.0,) * 5)  # and its name is free again


@pytest.mark.parametrize("name", ["", ".", "..", "../waving", "a/b", "-x", "x" * 61, "a\nb", " ", "x."])
def test_a_name_that_is_no_folder_is_refused(tmp_path, name):
    with pytest.raises(UserError, match="choose another"):
        planned(tmp_path, name=name)


def test_a_name_that_is_taken_and_too_few_episodes_are_refused(tmp_path):
    (tmp_path / "runs" / "waving").mkdir(parents=True)
    with pytest.raises(UserError, match="is there already"):
        planned(tmp_path)
    with pytest.raises(UserError, match="Training needs at least 3 recordings, and only one is chosen"):
        planned(tmp_path, name="other", episodes=(2, 2, 2))


@pytest.mark.parametrize(
    "frame",
    [
        '{"type":"train","name":"a","model":"pca","latent_dim":3,"episodes":[]}',
        '{"type":"train","name":"a","model":"../os","latent_dim":2,"episodes":[]}',
        '{"type":"train","name":"a","model":"pca","latent_dim":2,"episodes":[1]}',
        '{"type":"train","name":"a","model":"pca","latent_dim":2,"episodes":[],"out":"/tmp"}',
        '{"type":"run"}',
        '{"type":"run","run":""}',
        '{"type":"cancel_training","why":"x"}',
    ],
)
def test_what_is_not_of_the_schema_is_no_message(frame):
    with pytest.raises(ValueError):
        parse_message(frame)


def test_a_run_has_one_name_however_it_is_reached(tmp_path, monkeypatch):
    for place in ("out/runs/one", "elsewhere/one", "elsewhere/two"):
        (tmp_path / place).mkdir(parents=True)
        (tmp_path / place / "config.json").write_text("{}")
    monkeypatch.chdir(tmp_path)
    run_list = RunList(Path("out"), Path("elsewhere/one"))
    assert list(run_list.runs()) == ["one", "one (2)"]
    assert run_list.name_of(tmp_path / "out" / "runs" / "one") == "one"
    assert run_list.name_of(tmp_path / "elsewhere" / "one") == "one (2)"
    assert run_list.name_of(None) is None
    assert list(RunList(Path("elsewhere"), Path("elsewhere/two")).runs()) == ["two"]


def record(page, direction):
    """Drive one way for 1.5 s while an episode is recorded, then put the arm back."""
    before = (page.state["recording"] or {"episodes": 0})["episodes"]
    page.send(type="record", on=True, task="push")
    page.enable()
    page.u = direction
    time.sleep(1.5)
    page.u = [0.0, 0.0]
    page.wait(lambda state: state["phase"] == "ready")
    page.send(type="stop")
    page.wait(lambda state: state["phase"] == "disengaged")
    page.u = None
    page.send(type="record", on=False)
    page.wait(lambda state: state["recording"]["episodes"] == before + 1)
    page.send(type="reset")
    time.sleep(0.3)


@pytest.mark.slow
def test_what_is_recorded_is_trained_and_driven_without_a_terminal(tmp_path, serve):
    with serve(Spec(out=tmp_path)) as site, site.page() as page, site.page("Bob") as bob:
        assert page.learning["runs"] == []
        assert page.welcome["modes"] == ["end_effector"]
        for direction in ([1.0, 0.3], [1.0, -0.3], [0.9, 0.0]):
            record(page, direction)
        wait_for(lambda: len(page.learning["recordings"]) == FEWEST)
        assert {one["task"] for one in page.learning["recordings"]} == {"push"}
        assert all(1.0 < one["seconds"] < 6.0 for one in page.learning["recordings"])
        chosen = [{key: one[key] for key in ("file", "episode")} for one in page.learning["recordings"]]

        train = {"type": "train", "name": "pushed", "model": "pca", "latent_dim": 1, "episodes": chosen}
        bob.send(**train)
        time.sleep(0.5)
        assert page.learning["training"] is None, "only the driver may train"
        page.send(**(train | {"name": "../pushed"}))
        wait_for(lambda: bob.learning["training"])
        assert bob.learning["training"]["phase"] == "failed"
        assert [one["code"] for one in bob.learning["training"]["why"]] == ["name_invalid"]
        page.send(**train)
        page.send(**(train | {"name": "second"}))
        wait_for(lambda: page.learning["training"]["phase"] == "done")
        assert page.learning["training"]["run"] == "pushed"
        wait_for(lambda: bob.learning["runs"] == ["pushed"])

        page.enable()
        page.send(type="run", run="pushed")
        page.wait(lambda state: "Stop the arm first" in said(state))
        page.send(type="stop")
        page.u = None
        page.wait(lambda state: state["phase"] == "disengaged")
        page.send(type="run", run="../pushed")
        bob.send(type="run", run="pushed")
        time.sleep(0.5)
        assert page.welcome["run"] is None, "a run is named as it is listed, and by the driver"
        page.send(type="run", run="pushed")
        wait_for(lambda: page.welcome["run"] == bob.welcome["run"] == "pushed")
        assert page.welcome["latent_dim"] == 1
        page.wait(lambda state: state["mode"] in ("latent", "assisted"))
        wait_for(lambda: page.learning["run"] == "pushed")
        page.drive(1.0)
        named = page.welcome["task"]["choices"]
    with serve(Spec(out=tmp_path, arm="mujoco")) as site, site.page() as page:
        wait_for(lambda: [one["earlier"] for one in page.learning["recordings"]] == [True] * FEWEST)
        page.send(**(train | {"name": "again"}))
        wait_for(lambda: (page.learning["training"] or {}).get("phase") == "done")
        page.send(type="run", run="again")
        wait_for(lambda: page.welcome["run"] == "again")
        assert page.welcome["task"]["choices"] == named
        assert set(named) <= {thing["name"] for thing in page.welcome["things"]}
        page.drive(1.0)


def test_a_run_that_has_gone_is_not_driven_and_the_arm_stays_as_it_was(tmp_path, serve, trained):
    shutil.copytree(trained, tmp_path / "runs" / "copy")
    with serve(Spec(trained, out=tmp_path)) as site, site.page() as page:
        assert page.learning["runs"] == ["copy", "run"]
        (tmp_path / "runs" / "copy" / "model.safetensors").write_bytes(b"broken")
        page.send(type="run", run="copy")
        page.wait(lambda state: "model.safetensors" in said(state), within_s=60.0)
        assert page.welcome["run"] == "run"
        page.enable()
