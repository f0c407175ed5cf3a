"""All steps of a drive, in a file: measured again, they give the same record.

A file holds a row of figures for each step, one after the other in one array, and in its metadata what they
are: names, and what changes seldom, such as contacts and the mode, at each step at which it has changed.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from pathlib import Path
from typing import Any, Final, final

import numpy as np
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from latentarm.core.errors import UserError
from latentarm.core.files import written_whole
from latentarm.core.types import Command, FloatArray, GripperCommand, GripperReading, Pose, StepRecord, Stop
from latentarm.core.untrusted.documents import parse_object
from latentarm.core.untrusted.opening import check_file
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm_research.drives.following import Following
from latentarm_research.user_studies.definition import StudyTask
from latentarm_research.user_studies.drive_record import DriveContext, DriveRecord, record_of
from latentarm_research.user_studies.scenes import scene_of

MOST_BYTES: Final = 1 << 29  # of a file
FULL_BYTES: Final = 1 << 28  # of figures: a drive with so many ends
FULL_MARKS: Final = 1 << 19  # commas and brackets of labels: likewise; `parse_object` takes twice as many
_VALUES: Final = "values"
_ARRAYS: Final = ("state", "input", "latent", "action_human", "action_assist", "belief")  # of a `StepRecord`


@final
@dataclass
class StepLog:
    """The steps so far."""

    rows: list[FloatArray] = field(default_factory=list)
    # by name: from which step on, and what
    labels: dict[str, list[tuple[int, Any]]] = field(default_factory=dict)
    bytes: int = 0  # of the figures
    marks: int = 0  # of the labels in JSON

    @property
    def full(self) -> bool:
        """True if the file must get no longer: the drive ends."""
        return self.bytes >= FULL_BYTES or self.marks >= FULL_MARKS

    def add(self, state: SceneState, record: StepRecord, device: str) -> None:
        """Add a step: how things stood, what was decided, and the pushed input device, "" for none."""
        for name, value in {**_labels(state, record), "device": device}.items():
            changes = self.labels.setdefault(name, [])
            if not changes or changes[-1][1] != value:
                changes.append((len(self.rows), value))
                self.marks += sum(map(json.dumps(changes[-1]).count, ",[{"))
        self.rows.append(np.concatenate([np.ravel(part) for part in _parts(state, record)]))
        self.bytes += self.rows[-1].nbytes

    def write(self, path: Path, seed: int) -> None:
        """Write the file; ``seed`` is that of the scene and the start."""
        about = {"seed": seed, "steps": len(self.rows), "labels": self.labels}
        content = save({_VALUES: np.concatenate(self.rows)}, {"about": json.dumps(about)})
        with written_whole(path) as part:
            part.write_bytes(content)


@final
class Measuring:
    """Measures a drive as its steps come, or again from their file."""

    def __init__(self, scene: SceneTask, choice: int, seed: int, limit_s: float) -> None:
        begun = begin(scene, choice, seed)
        self._chain = scene.robot.chain
        self._choice = choice
        self._limit_s = limit_s
        self._follow = Following(begun)
        self._stops = 0
        self._enabled = False
        self._input_s: dict[str, float] = {}

    def sees(self, state: SceneState, record: StepRecord, device: str) -> bool:
        """Take a step. True if the drive has ended with it."""
        enabled = record.command.stop is None
        self._stops += self._enabled and not enabled
        self._enabled = enabled
        records = self._follow.records
        self._follow.sees(state)
        if self._follow.ending is None:
            if device and enabled and records:
                span_s = record.time_s - records[-1].time_s
                self._input_s[device] = self._input_s.get(device, 0.0) + span_s
            records.append(record)
        over = self._follow.ending is not None or record.time_s - records[0].time_s >= self._limit_s
        return bool(records) and over

    def record(self, where: DriveContext, task: StudyTask, *, full: bool) -> DriveRecord:
        """The record of the drive so far; ``full``: it ends because its file must get no longer."""
        found = record_of(where, task, self._follow.trace(self._choice, self._chain, self._stops))
        ending = {"ending": "record_full"} if full and self._follow.ending is None else {}
        return found.model_copy(update={"input_s": self._input_s, **ending})


def begin(scene: SceneTask, choice: int, seed: int) -> Beginning:
    """The start of a drive. A simulated person who comes no nearer is stuck; a real one may think."""
    return replace(scene.begin(choice, np.random.default_rng(seed)), patient=True)


def measured_again(path: Path, kept: DriveRecord, task: StudyTask) -> DriveRecord:
    """Compute a drive's record from its steps file; UserError if the file is not valid."""
    seed, steps = read_steps(path)
    measuring = Measuring(scene_of(task.scene), kept.choice, seed, float("inf"))
    try:
        for state, record, device in steps:
            measuring.sees(state, record, device)
    except (ValueError, LookupError, TypeError, AttributeError) as error:
        raise UserError(f"{path} does not hold the steps of a drive.") from error
    where = DriveContext(*(getattr(kept, name) for name in DriveContext._fields))
    return measuring.record(where, task, full=kept.ending == "record_full")


def read_steps(path: Path) -> tuple[int, Iterator[tuple[SceneState, StepRecord, str]]]:
    """The seed of a drive's start, and its steps with the input device that was pushed, "" for none."""
    check_file(path, MOST_BYTES)
    try:
        with safe_open(path, framework="numpy") as file:
            values: FloatArray = file.get_tensor(_VALUES)
            about = parse_object((file.metadata() or {}).get("about", ""), str(path))
        return int(about["seed"]), _steps(values, about["labels"], int(about["steps"]))
    except (SafetensorError, ValueError, KeyError, TypeError) as error:
        raise UserError(f"{path} does not hold the steps of a drive.") from error


def _labels(state: SceneState, record: StepRecord) -> dict[str, Any]:
    stop = record.command.stop
    return {
        "things": sorted(state.poses),
        "grains": {name: len(middles) for name, middles in sorted(state.grains.items())},
        "stabbed": sorted(state.stabbed),
        "gripped": sorted(state.gripped),
        "bonds": sorted(map(list, state.bonds)),
        "touching": sorted(map(list, state.force_n)),
        "mode": int(record.mode),
        "stop": None if stop is None else stop.reason,
        "limited_by": list(record.command.limited_by),
        "sizes": [len(getattr(record, name)) for name in _ARRAYS],
        "holding": None if record.gripper is None else bool(record.gripper.holding),
        "gripper": None if record.command.gripper is None else list(astuple(record.command.gripper)),
    }


def _parts(state: SceneState, record: StepRecord) -> Iterator[Any]:
    """The figures of a step, in the order in which `_step` takes them."""
    yield state.time_s
    for pose in (state.tool, *(state.poses[name] for name in sorted(state.poses))):
        yield pose.position
        yield pose.rotation
    yield [state.speed_m_s[name] for name in sorted(state.poses)]
    yield from (state.grains[name] for name in sorted(state.grains))
    yield [state.force_n[one, other] for one, other in sorted(state.force_n)]
    yield record.time_s, record.alpha, record.added, record.delay_s
    yield record.command.velocity
    yield from (getattr(record, name) for name in _ARRAYS)
    if record.gripper is not None:
        yield record.gripper.width_m


def _steps(
    values: FloatArray, labels: Mapping[str, Sequence[tuple[int, Any]]], count: int
) -> Iterator[tuple[SceneState, StepRecord, str]]:
    at = 0
    now: dict[str, Any] = {"device": ""}  # files of earlier versions do not have it
    changes: dict[int, dict[str, Any]] = {}
    for name, theirs in labels.items():
        for index, value in theirs:
            changes.setdefault(index, {})[name] = value
    for index in range(count):
        now.update(changes.get(index, {}))
        (state, record), used = _step(values[at:], now)
        at += used
        yield state, record, now["device"]


def _step(values: FloatArray, labels: Mapping[str, Any]) -> tuple[tuple[SceneState, StepRecord], int]:
    at = 0

    def take(*shape: int) -> FloatArray:
        nonlocal at
        at += (size := int(np.prod(shape)))
        return values[at - size : at].reshape(shape)

    things = labels["things"]
    time_s = float(take(1)[0])
    tool, *poses = (Pose(take(3), take(3, 3)) for _ in range(1 + len(things)))
    state = SceneState(
        time_s=time_s,
        tool=tool,
        poses=dict(zip(things, poses, strict=True)),
        speed_m_s=dict(zip(things, take(len(things)).tolist(), strict=True)),
        stabbed=frozenset(labels["stabbed"]),
        gripped=frozenset(labels["gripped"]),
        bonds=frozenset((one, other) for one, other in labels["bonds"]),
        grains={name: take(size, 3) for name, size in labels["grains"].items()},
        force_n={
            (one, other): float(force_n)
            for (one, other), force_n in zip(labels["touching"], take(len(labels["touching"])), strict=True)
        },
    )
    step_s, alpha, added, delay_s = take(4).tolist()
    stop = None if labels["stop"] is None else Stop(labels["stop"])
    asked = None if labels["gripper"] is None else GripperCommand(*labels["gripper"])
    command = Command(take(labels["sizes"][0]), 0.0, stop, tuple(labels["limited_by"]), asked)
    arrays: dict[str, Any] = {name: take(size) for name, size in zip(_ARRAYS, labels["sizes"], strict=True)}
    holding = labels["holding"]
    gripper = None if holding is None else GripperReading(float(take(1)[0]), holding)
    record = StepRecord(
        time_s=step_s,
        alpha=alpha,
        added=added,
        delay_s=delay_s,
        mode=labels["mode"],
        command=command,
        gripper=gripper,
        **arrays,
    )
    return (state, record), at
