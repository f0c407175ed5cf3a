"""The steps of a drive are read as they were written."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from latentarm.core.types import Command, GripperCommand, GripperReading, Pose, StepRecord, Stop
from latentarm.robots.scene.scene import SceneState
from latentarm_research.user_studies.drive_record import together
from latentarm_research.user_studies.drive_steps import StepLog, read_steps


def a_step(rng: np.random.Generator, number: int) -> tuple[SceneState, StepRecord]:
    def pose() -> Pose:
        return Pose(rng.normal(size=3), rng.normal(size=(3, 3)))

    touched = [("plate", "tool"), ("bite", "plate")][: number % 3]
    state = SceneState(
        0.01 * number, pose(), {"plate": pose(), "bite": pose()}, {"plate": 0.0, "bite": float(rng.normal())},
        frozenset(["bite"] if number > 3 else []), frozenset(), frozenset([("bite", "plate")][: number % 2]),
        {"rice": rng.normal(size=(4, 3))}, {pair: float(rng.uniform()) for pair in touched},
    )  # fmt: skip
    arrays = {name: rng.normal(size=2) for name in ("input", "latent")}
    joints = {name: rng.normal(size=7) for name in ("state", "action_human", "action_assist")}
    stop = Stop("The arm stops.") if number == 2 else None
    asked = GripperCommand(*rng.uniform(size=3).tolist()) if number > 2 else None
    command = Command(rng.normal(size=7), 0.0, stop, ("speed",) if number % 2 else (), asked)
    record = StepRecord(
        time_s=0.01 * number, alpha=0.3, belief=rng.uniform(size=3), mode=number % 2, command=command,
        gripper=GripperReading(float(rng.uniform()), number > 5) if number > 1 else None,
        delay_s=0.1 * number if number else np.nan, **arrays, **joints,
    )  # fmt: skip
    return state, record


def plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, dict):
        return {name: plain(one) for name, one in value.items()}
    if isinstance(value, Pose | SceneState | StepRecord | Command | GripperReading | GripperCommand):
        return {one.name: plain(getattr(value, one.name)) for one in fields(value)}
    return None if value != value else value


def test_steps_are_read_as_they_were_written(tmp_path: Path) -> None:
    rng, log = np.random.default_rng(43), StepLog()
    steps = [a_step(rng, number) for number in range(8)]
    for number, (state, record) in enumerate(steps):
        log.add(state, record, "keyboard" if number > 4 else "")
    log.write(tmp_path / "drive.safetensors", 5)
    seed, found = read_steps(tmp_path / "drive.safetensors")
    assert seed == 5
    read = list(found)
    assert [plain(list(map(plain, step[:2]))) for step in read] == [list(map(plain, step)) for step in steps]
    assert [device for *_, device in read] == [""] * 5 + ["keyboard"] * 3


def test_a_figure_that_one_drive_of_a_trial_lacks_is_left_out() -> None:
    assert together([{"time_s": 1.0, "input_delay_s": 0.2}, {"time_s": 2.0}]) == {"time_s": 3.0}
