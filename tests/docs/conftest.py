from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.control.recorder import EpisodeHeader, Recorder
from latentarm.tasks.table_top import TableTop
from latentarm.types import Command, StepRecord


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
