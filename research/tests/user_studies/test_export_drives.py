"""The exported drives are the kept ones: each is an episode that the table of drives names."""

import csv
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from latentarm.core.types import Command, StepRecord
from latentarm.demonstrations.dataset import read_dataset
from latentarm.robots.scene.scene import SceneState
from latentarm_research.drives.drive import RATE_HZ
from latentarm_research.user_studies import drive_steps
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.drive_steps import StepLog, begin, measured_again
from latentarm_research.user_studies.export.dataset import write_dataset
from latentarm_research.user_studies.recorded import Recorded
from latentarm_research.user_studies.scenes import scene_of
from latentarm_research.user_studies.serving.page_drive import STEPS as PAGE_STEPS
from latentarm_research.user_studies.serving.page_drive import PageDrive, ToDrive
from latentarm_research.user_studies.serving.running import kept_record
from latentarm_research.user_studies.sizes import PRESETS
from latentarm_research.user_studies.trace import Trace

EATING = load_definition("eating")
TASKS = {task.name: task for task in EATING.tasks}
STEPS = 30


def a_drive(
    folder: Path, person: int, task: str, *, added: float = 0.0, kept: bool = True
) -> tuple[DriveRecord, Path]:
    """A drive with the file of its steps."""
    log = StepLog()
    for state, record in steps(task, person, added):
        log.add(state, record, "")
    path = folder / f"{person}-{task}.safetensors"
    if kept:
        log.write(path, person)
    record = DriveRecord(
        people_are="real", person=person, condition=EATING.conditions[0].name, order=0, task=task, trial=0,
        choice=0, attempt=0, ending="done", measures={},
        trace=Trace(person, EATING.conditions[0].name, task, 0, 0, True, (), (), (), ()),
    )  # fmt: skip
    return record, path


def steps(task: str, person: int, added: float = 0.0) -> Iterator[tuple[SceneState, StepRecord]]:
    """The steps of a drive in which each joint turns at 0.1 rad/s and the first thing rises."""
    scene = scene_of(TASKS[task].scene)
    begun = begin(scene, 0, person)
    first = begun.objects[0]
    for number in range(STEPS):
        time_s = number / RATE_HZ
        q = begun.state + 0.1 * time_s
        poses = {thing.name: thing.pose for thing in begun.scene.things}
        up = np.array([0.0, 0.0, 0.01 * number])
        poses[first] = replace(poses[first], position=poses[first].position + up)
        tool = scene.robot.chain.forward(q)
        none = frozenset[str]()
        state = SceneState(time_s, tool, poses, dict.fromkeys(poses, 0.0), none, none, frozenset(), {}, {})
        record = StepRecord(
            time_s=time_s, state=q, input=np.array([0.5, 0.0]), latent=np.zeros(2),
            action_human=np.full(7, 0.1), action_assist=np.zeros(7), alpha=0.0,
            belief=np.full(len(begun.goals), 0.5), mode=0, command=Command(np.full(7, 0.1), 0.0), added=added,
        )  # fmt: skip
        yield state, record


@pytest.mark.filterwarnings("error")
def test_drives_are_episodes_of_lerobot_datasets_and_the_table_says_which(tmp_path: Path) -> None:
    drives = [
        a_drive(tmp_path, 1, "entree"),
        a_drive(tmp_path, 1, "dessert"),
        a_drive(tmp_path, 2, "entree", kept=False),
        a_drive(tmp_path, 3, "entree", added=0.2),
    ]
    study = Recorded(EATING, "real", (), (), (), PRESETS["smoke"])
    write_dataset(tmp_path / "out", study, drives)
    table = tmp_path / "out" / "data" / "study-Eating_description-drives_data.csv"
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert [(row["person"], row["task"], row["episode"]) for row in rows] == [
        ("1", "entree", "0"), ("2", "entree", ""), ("3", "entree", "1"), ("1", "dessert", "0"),
    ]  # fmt: skip
    entree = read_dataset(tmp_path / "out" / "drives" / "entree")
    objects = begin(scene_of("entree"), 0, 1).objects
    assert (entree.rate_hz, entree.objects, len(entree.episodes)) == (RATE_HZ, objects, 2)
    for person, added, episode in zip((1, 3), (0.0, 0.2), entree.episodes, strict=True):
        driven = episode.provenance
        assert driven is not None
        assert (driven.person, driven.task_name) == (str(person), "entree")
        assert driven.controller == EATING.conditions[0].name
        assert episode.action is not None
        start = begin(scene_of("entree"), 0, person)
        np.testing.assert_allclose(episode.state[0], start.state, atol=1e-6)
        np.testing.assert_allclose(episode.action, 0.1, atol=1e-6)
        np.testing.assert_allclose(episode.extras["assist.added"], added, atol=1e-6)
        height_m = episode.extras["observation.environment_state"][:, 2]
        np.testing.assert_allclose(height_m - height_m[0], 0.01 * np.arange(STEPS), atol=1e-5)


def test_a_drive_ends_before_its_file_is_too_large_and_replays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (state, first), *_ = steps("entree", 1)
    log = StepLog()
    log.add(state, first, "")
    monkeypatch.setattr(drive_steps, "FULL_BYTES", 10 * log.bytes)
    due = ToDrive("trial", EATING.conditions[0], 0, TASKS["entree"], 0, 0, 0, 240.0, 1)
    now: list[SceneState] = []
    arm: Any = SimpleNamespace(scene_state=lambda: now[-1])
    watch = PageDrive(due, 1, None, tmp_path).watch(arm, lambda: "keyboard" if len(now) > 5 else "")
    for state, record in steps("entree", 1):
        now.append(state)
        watch(record)
        if kept_record(tmp_path) is not None:
            break
    assert len(now) == 10
    found = kept_record(tmp_path)
    assert found is not None
    assert found.ending == "record_full"
    assert found.input_s == pytest.approx({"keyboard": 5 / RATE_HZ})
    assert measured_again(tmp_path / PAGE_STEPS, found, TASKS["entree"]) == found
