"""Importing tables in plain text (CSV), one line per sample.

The first line names the columns: ``episode`` (any label; its lines lie together), ``timestamp`` (s,
growing within an episode, from any origin), one column per joint with its position in rad, and
where wanted ``action.JOINT`` for every joint with its commanded velocity in rad/s, ``task``, and ``robot``,
the name of the robot that was recorded. With a robot whose joint names are all among the columns,
those are read, and a gripper's; otherwise every column that is not named above.
"""

import math
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, final

import numpy as np

from latentarm.demonstrations.bounds import MAX_COLUMNS, MAX_EPISODES
from latentarm.demonstrations.columns import is_gripper
from latentarm.demonstrations.csv_lines import read_lines
from latentarm.errors import UserError
from latentarm.types import Demonstrations, Episode, FloatArray

ACTION_PREFIX: Final = "action."
RESERVED_COLUMNS: Final = frozenset({"episode", "timestamp", "task", "robot"})


@final
@dataclass
class _Run:
    """Lines of one episode while they are being read, as flat rows of numbers."""

    label: str
    task: str
    robot: str
    numbers: "array[float]" = field(default_factory=lambda: array("d"))


def read_csv(
    source: Path,
    joint_names: Sequence[str] = (),
    rate_hz: float | None = None,
    task: str | None = None,
) -> Demonstrations:
    """Read demonstrations from a CSV file.

    Args:
        source: the file.
        joint_names: the robot's joints, where a robot is known.
        rate_hz: nominal sampling rate; by default the mean rate of the timestamps.
        task: what was done, where the file has no such column; the file's name by default.

    Raises:
        UserError: naming the file and the line that cannot be understood.
    """
    lines = read_lines(source)
    header = [name.strip() for name in next(lines, (0, []))[1]]
    joints = _joints(header, joint_names, source)
    actions = [f"{ACTION_PREFIX}{joint}" for joint in joints]
    recorded = all(action in header for action in actions)
    columns = ["timestamp", *joints, *(actions if recorded else [])]
    default_task = source.stem if task is None else task
    runs = _runs(lines, header, columns, default_task, source)
    episodes = tuple(_episode(run, len(joints), len(columns)) for run in runs)
    if not episodes:
        raise UserError(f"{source} has no line after its header.")
    rate = _mean_rate(episodes) if rate_hz is None else rate_hz
    robots = sorted({run.robot for run in runs})
    if len(robots) > 1:
        raise UserError(f"{source} holds episodes of different robots ({', '.join(robots)}): split the file.")
    return Demonstrations(episodes=episodes, rate_hz=rate, joint_names=joints, robot=robots[0])


def _joints(header: list[str], joint_names: Sequence[str], source: Path) -> tuple[str, ...]:
    if len(header) > MAX_COLUMNS:
        raise UserError(f"{source} has {len(header):,} columns, over the limit of {MAX_COLUMNS:,}.")
    repeated = sorted({name for name in header if header.count(name) > 1})
    if repeated:
        raise UserError(f"{source}: the column {repeated[0]!r} occurs twice.")
    for name in ("episode", "timestamp"):
        if name not in header:
            raise UserError(f"{source} has no column {name!r}; its first line must name the columns.")
    joints = tuple(
        name for name in header if name not in RESERVED_COLUMNS and not name.startswith(ACTION_PREFIX)
    )
    if joint_names and set(joint_names) <= set(header):
        # The robot's own names: what else there is, text perhaps, is not looked at, but for a gripper.
        return tuple(name for name in joints if name in joint_names or is_gripper(name))
    if not joints:
        raise UserError(f"{source} has no column of joint positions.")
    return joints


def _runs(
    lines: Iterator[tuple[int, list[str]]], header: list[str], columns: list[str], task: str, source: Path
) -> list[_Run]:
    place = {name: index for index, name in enumerate(header)}
    wanted = [place[name] for name in columns]
    runs: list[_Run] = []
    seen: set[str] = set()
    for number, fields in lines:
        if len(fields) != len(header):
            raise UserError(
                f"{source}: line {number} is ragged: {len(fields)} fields under {len(header)} columns."
            )
        label = fields[place["episode"]]
        if not runs or runs[-1].label != label:
            if label in seen:
                raise UserError(f"{source}: line {number} goes back to episode {label!r}, which had ended.")
            if len(seen) == MAX_EPISODES:
                raise UserError(f"{source} has more than {MAX_EPISODES:,} episodes; split the file.")
            seen.add(label)
            told = {name: fields[place[name]] for name in ("task", "robot") if name in place}
            runs.append(_Run(label, told.get("task", task), told.get("robot", "")))
        for name, index in zip(columns, wanted, strict=True):
            try:
                runs[-1].numbers.append(float(fields[index]))
            except ValueError as error:
                raise UserError(
                    f"{source}: line {number}, column {name!r}: {fields[index][:40]!r} is not a number."
                ) from error
    return runs


def _episode(run: _Run, dof: int, width: int) -> Episode:
    numbers: FloatArray = np.frombuffer(run.numbers).reshape(-1, width).copy()
    return Episode(
        timestamp=numbers[:, 0] - numbers[0, 0],
        state=numbers[:, 1 : 1 + dof],
        action=numbers[:, 1 + dof :] if width > 1 + dof else None,
        task=run.task,
    )


def _mean_rate(episodes: Sequence[Episode]) -> float:
    """Samples per second over all episodes, a whole number where it is within 1 % of one."""
    steps = sum(len(episode.timestamp) - 1 for episode in episodes)
    elapsed = sum(float(episode.timestamp[-1]) for episode in episodes)
    rate = steps / elapsed if elapsed > 0 else 0.0
    whole = math.floor(rate + 0.5) if math.isfinite(rate) else 0
    return float(whole) if abs(rate - whole) < 0.01 * rate else rate
