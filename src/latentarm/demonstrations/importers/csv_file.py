"""Importing tables in plain text (CSV), one line per sample.

The first line names the columns: ``timestamp`` (s, growing within an episode, from any origin), one column
per joint with its position in rad, and optionally ``episode`` (any label; its lines lie together),
``action.JOINT`` for every joint with its commanded velocity in rad/s, ``task``, and ``robot``, the name of
the robot. Without ``episode`` the file is one episode. If the robot's joint names are all among the columns,
only those and a gripper's are read; otherwise every column that is not named above.

Output of ``rostopic echo -p`` for a topic of ``sensor_msgs/JointState`` works too.
"""

from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray
from latentarm.demonstrations.bounds import MAX_COLUMNS, MAX_EPISODES
from latentarm.demonstrations.importers.columns import is_gripper
from latentarm.demonstrations.importers.csv_lines import CsvTable
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.demonstrations.importers.source import SourceData
from latentarm.demonstrations.timing import typical_rate_hz

ACTION_PREFIX: Final = "action."
RESERVED_COLUMNS: Final = frozenset({"episode", "timestamp", "task", "robot"})
SECONDS: Final[dict[str, float]] = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_LEAST_STEP: Final[dict[str, float]] = {"ns": 1e6, "us": 1e3, "ms": 5.0}
"""No recording has so few samples a second that its timestamps would advance by this in any longer unit."""

_ROSTOPIC: Final = "%time"  # first column of what ``rostopic echo -p`` prints
_ROS_NAME: Final = "field.name"
_ROS_POSITION: Final = "field.position"


@final
@dataclass
class _Run:
    """Lines of one episode, as flat rows of numbers."""

    label: str
    task: str
    robot: str
    numbers: "array[float]" = field(default_factory=lambda: array("d"))


def read_csv(source: Path, joint_names: Sequence[str], options: ImportOptions) -> SourceData:
    """Read demonstrations from a CSV file.

    ``joint_names`` are the robot's, where it is known. By default the rate is the timestamps', the task of a
    file without such a column its name, and the unit s, or a shorter one where steps are too long for s.
    """
    table = CsvTable(source)
    header, rows = table.header, table.rows()
    if _ROSTOPIC in header:
        header, rows = _joint_states(header, rows, source)
    joints = _joints(header, joint_names, source)
    actions = [f"{ACTION_PREFIX}{joint}" for joint in joints]
    recorded = all(action in header for action in actions)
    columns = ["timestamp", *joints, *(actions if recorded else [])]
    runs = _runs(table, header, rows, columns, options.instruction or source.name.split(".")[0])
    robots = sorted({run.robot for run in runs})
    if len(robots) > 1:
        raise UserError(f"{source} holds episodes of different robots ({', '.join(robots)}): split the file.")
    tables: list[FloatArray] = [np.frombuffer(run.numbers).reshape(-1, len(columns)) for run in runs]
    steps = np.concatenate([np.diff(one[:, 0]) for one in tables])
    step = float(np.median(steps)) if len(steps) else 0.0
    unit = options.time_unit or next((unit for unit, least in _LEAST_STEP.items() if step >= least), "s")
    record = {"timestamps": f"taken for {unit}, as they advance by {step:.6g}"}
    width = 1 + len(joints)
    episodes = tuple(
        Episode(
            timestamp=(numbers[:, 0] - numbers[0, 0]) * SECONDS[unit],
            state=numbers[:, 1:width].copy(),
            action=numbers[:, width:].copy() if recorded else None,
            task=run.task,
        )
        for run, numbers in zip(runs, tables, strict=True)
    )
    return SourceData(
        Demonstrations(
            episodes=episodes,
            rate_hz=options.rate_hz or typical_rate_hz(episodes),
            joint_names=joints,
            robot=robots[0],
        ),
        layout="CSV",
        in_rad=True,
        names=tuple(run.label for run in runs),
        record=record if unit != "s" and options.time_unit is None else {},
    )


def _joint_states(
    header: list[str], rows: Iterator[tuple[int, list[str]]], source: Path
) -> tuple[list[str], Iterator[tuple[int, list[str]]]]:
    """The positions in output of ``rostopic echo -p``, under the joints' names."""
    positions = [name for name in header if name.startswith(_ROS_POSITION)]
    labels = [name.replace(_ROS_POSITION, _ROS_NAME) for name in positions]
    if not positions or not set(labels) <= set(header):
        raise UserError(
            f"{source} was printed by rostopic, but not from a topic of sensor_msgs/JointState: print that"
            " topic with `rostopic echo -b BAG -p TOPIC`, or import the bag."
        )
    named, kept = ([header.index(name) for name in some] for some in (labels, [_ROSTOPIC, *positions]))
    number, first = next(rows)
    names = [first[index] for index in named]

    def picked() -> Iterator[tuple[int, list[str]]]:
        for line, fields in chain([(number, first)], rows):
            if [fields[index] for index in named] != names:
                raise UserError(f"{source}: line {line} names other joints than line {number}.")
            yield line, [fields[index] for index in kept]

    return ["timestamp", *names], picked()


def _joints(header: list[str], joint_names: Sequence[str], source: Path) -> tuple[str, ...]:
    if len(header) > MAX_COLUMNS:
        raise UserError(f"{source} has {len(header):,} columns, over the limit of {MAX_COLUMNS:,}.")
    repeated = sorted({name for name in header if header.count(name) > 1})
    if repeated:
        raise UserError(f"{source}: the column {repeated[0]!r} occurs twice.")
    if "timestamp" not in header:
        raise UserError(f"{source} has no column 'timestamp'; its first line must name the columns.")
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
    table: CsvTable, header: list[str], rows: Iterator[tuple[int, list[str]]], columns: list[str], task: str
) -> list[_Run]:
    place = {name: index for index, name in enumerate(header)}
    wanted = [place[name] for name in columns]
    runs: list[_Run] = []
    seen: set[str] = set()
    for at, fields in rows:
        told = {name: fields[place[name]] for name in ("episode", "task", "robot") if name in place}
        label = told.get("episode", "0")
        if not runs or runs[-1].label != label:
            if label in seen:
                raise UserError(f"{table.source}: line {at} goes back to episode {label!r}, which had ended.")
            if len(seen) == MAX_EPISODES:
                raise UserError(f"{table.source} has more than {MAX_EPISODES:,} episodes; split the file.")
            seen.add(label)
            runs.append(_Run(label, told.get("task", task), told.get("robot", "")))
        runs[-1].numbers.extend(
            table.number(fields[index], at, name) for name, index in zip(columns, wanted, strict=True)
        )
    return runs
