from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.cli import main
from latentarm.core.types import Command, Input, Reading, StepRecord
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder
from latentarm.tasks.table_top import TableTop
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.arm_process.incident import begin_incident


def drive_on_the_page(out: Path) -> None:
    """An incident file of two ticks, as `latentarm teleop` leaves it."""
    setup = load_setup(Spec(out=out))
    calls = begin_incident(setup)
    step = setup.step(calls=calls)
    step.reset(setup.start)
    for tick in range(2):
        step(Input(np.zeros(2)), 0.0, Reading(setup.start, np.zeros(7), 0.01 * tick, tick), 0.01 * tick)
    calls.close()


def record_on_the_page(journal: Path) -> None:
    """A journal with one short episode, as `latentarm teleop` leaves it."""
    robot = TableTop().robot
    recorder = Recorder(journal)
    recorder.begin_episode(EpisodeHeader(robot.name, robot.joint_names, 100.0, "stab"))
    for tick in range(5):
        still, stick = np.zeros(robot.dof), np.zeros(2)
        recorder.record(
            StepRecord(
                0.01 * tick, robot.home, stick, stick, still, still, 0.0, np.zeros(0), 0, Command(still, 0.05)
            )
        )
    recorder.end_episode()
    recorder.close()


@pytest.fixture(name="record_on_the_page", scope="session")
def fixture_record_on_the_page() -> Callable[[Path], None]:
    return record_on_the_page


@pytest.fixture(name="workspace", scope="session")
def fixture_workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What pages assume that readers have: a recording, its dataset, a run and a journal of the page."""
    folder = tmp_path_factory.mktemp("workspace")
    demonstrations = TableTop().demonstrate(6, np.random.default_rng(0))
    states = [episode.state[::4] for episode in demonstrations.episodes]
    recording = folder / "recording.npz"
    ends = np.cumsum([len(state) for state in states])
    np.savez(recording, q=np.concatenate(states), episode_ends=ends, rate_hz=5.0)
    assert main(["import", str(recording), str(folder / "eat")]) == 0
    hardly = ["--epochs", "1", "--seeds", "1", "--hidden", "8"]
    train = ["train", "--demonstrations", str(folder / "eat"), *hardly]
    assert main([*train, "--out", str(folder / "runs/eat-cvae")]) == 0
    (folder / "teleop").mkdir()
    record_on_the_page(folder / "teleop/journal.sqlite")
    drive_on_the_page(folder / "teleop")
    return folder
