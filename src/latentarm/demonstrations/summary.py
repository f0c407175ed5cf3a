"""A summary of a dataset, for a person to check before training on it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, final

import numpy as np

from latentarm.core.types import Demonstrations, Episode, FloatArray, Row
from latentarm.demonstrations.gripper import GripperUse, gripper_uses
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.limits import JointLimits
from latentarm.robots.robot import Robot

STUDY: Final = "inspect"


class Column(NamedTuple):
    """A figure of every episode or joint; None where it is not known."""

    heading: str
    values: Sequence[float | str | None]
    shown: str = ""  # format in the table; a share is in percent
    measure: str = ""  # in machine-readable form; "" for none
    unit: str = ""


@final
@dataclass(frozen=True)
class Table:
    """Figures of episodes or joints, with units in their headings."""

    title: str
    noun: str  # what each row is of
    names: Sequence[str]  # of the rows
    columns: tuple[Column, ...]

    def headings(self) -> tuple[str, ...]:
        """Of all columns for people, the names' first."""
        return self.noun, *(one.heading for one in self.columns)

    def lines(self) -> list[tuple[str, ...]]:
        """The rows for people."""
        shown = [[_cell(value, one.shown) for value in one.values] for one in self.columns]
        return list(zip(self.names, *shown, strict=True))

    def rows(self) -> list[Row]:
        """The figures in machine-readable form, row by row; the condition is the episode or joint."""
        return [
            _row(one.measure, one.unit, value, f"episode_{name}" if self.noun == "episode" else name)
            for index, name in enumerate(self.names)
            for one in self.columns
            if one.measure and isinstance(value := one.values[index], float | int)
        ]


@final
@dataclass(frozen=True)
class Summary:
    """A summary of a dataset."""

    overall: tuple[Row, ...]
    tables: tuple[Table, ...]  # of episodes, joints and, if recorded, the gripper

    def rows(self) -> list[Row]:
        """Every figure in machine-readable form."""
        return [*self.overall, *(row for table in self.tables for row in table.rows())]


def _cell(value: float | str | None, shown: str) -> str:
    return "–" if value is None else format(value, shown).removesuffix("%")


def summarise(demonstrations: Demonstrations, robot: Robot | None = None) -> Summary:
    """Measure a dataset; with a robot also the limits and the end-effector's path."""
    episodes = demonstrations.episodes
    names = [str(index) for index in range(len(episodes))]
    columns = _episodes(episodes, robot)
    joints = _joints(demonstrations, None if robot is None else robot.limits)
    uses = gripper_uses(demonstrations, None if robot is None else robot.gripper)
    return Summary(
        (
            _row("episodes", "count", len(episodes)),
            _row("samples", "count", sum(len(one.timestamp) for one in episodes)),
            _row("duration_s", "s", sum(_duration_s(one) for one in episodes)),
            _row("rate_hz", "Hz", demonstrations.rate_hz),
        ),
        (
            Table("Episodes", "episode", names, columns),
            Table("Joints", "joint", demonstrations.joint_names, joints),
            *([Table("Gripper", "episode", names, _gripper(uses))] if uses else []),
        ),
    )


def _speed(episode: Episode) -> FloatArray:
    """(T - 1, n), rad/s, between one sample and the next."""
    return np.abs(np.diff(episode.state, axis=0)) / np.diff(episode.timestamp)[:, None]


def _duration_s(episode: Episode) -> float:
    return float(episode.timestamp[-1] - episode.timestamp[0])


def _length(points: FloatArray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _still_fraction(episode: Episode) -> float:
    """Share of the time in which no joint is faster than `STILL_RAD_S`."""
    still = _speed(episode).max(axis=1) <= STILL_RAD_S
    return float(np.diff(episode.timestamp)[still].sum() / _duration_s(episode))


def _episodes(episodes: Sequence[Episode], robot: Robot | None) -> tuple[Column, ...]:
    rates = [(len(one.timestamp) - 1) / _duration_s(one) for one in episodes]
    paths = [None if robot is None else _length(robot.chain.forward(one.state).position) for one in episodes]
    return (
        Column("task", [one.task for one in episodes]),
        Column("samples", [len(one.timestamp) for one in episodes], "d", "samples", "count"),
        Column("duration (s)", [_duration_s(one) for one in episodes], ".1f", "duration_s", "s"),
        Column("rate (Hz)", rates, ".1f", "rate_hz", "Hz"),
        Column("joint path (rad)", [_length(one.state) for one in episodes], ".2f", "path_length_rad", "rad"),
        Column("tool path (m)", paths, ".2f", "path_length", "m"),
        Column("peak (rad/s)", [float(_speed(one).max()) for one in episodes], ".2f", "peak_speed", "rad/s"),
        Column("still (%)", [_still_fraction(one) for one in episodes], ".0%", "still_fraction", "1"),
    )


def _joints(demonstrations: Demonstrations, limits: JointLimits | None) -> tuple[Column, ...]:
    states = np.concatenate([episode.state for episode in demonstrations.episodes])
    speeds = np.concatenate([_speed(episode) for episode in demonstrations.episodes])
    lowest, highest = states.min(axis=0), states.max(axis=0)
    p50, p95, p99, fastest = np.percentile(speeds, [50, 95, 99, 100], axis=0).tolist()
    ranges = margins = most = [None] * demonstrations.dof
    if limits is not None:
        ranges = [f"{low:.3f} … {high:.3f}" for low, high in zip(limits.lower, limits.upper, strict=True)]
        # The least distance to a limit, negative past it.
        margins = np.minimum(lowest - limits.lower, limits.upper - highest).tolist()
        most = limits.velocity.tolist()
    return (
        Column("lowest (rad)", lowest.tolist(), ".3f", "lowest", "rad"),
        Column("highest (rad)", highest.tolist(), ".3f", "highest", "rad"),
        Column("limits (rad)", ranges),
        Column("margin (rad)", margins, ".3f", "limit_margin", "rad"),
        Column("speed (rad/s) p50", p50, ".2f", "speed_p50", "rad/s"),
        Column("p95", p95, ".2f", "speed_p95", "rad/s"),
        Column("p99", p99, ".2f", "speed_p99", "rad/s"),
        Column("max", fastest, ".2f", "speed_max", "rad/s"),
        Column("limit", most, ".2f"),
    )


def _gripper(uses: Sequence[GripperUse]) -> tuple[Column, ...]:
    closed = [one.closed_fraction for one in uses]
    toggled = [one.toggled_fraction for one in uses]
    return (
        Column("closed (%)", closed, ".0%", "gripper_closed_fraction", "1"),
        Column("toggled (%)", toggled, ".0%", "gripper_toggled_fraction", "1"),
        Column("changes", [one.changes for one in uses], "d", "gripper_changes", "count"),
    )


def _row(measure: str, unit: str, value: float, condition: str | None = None) -> Row:
    return Row(study=STUDY, measure=measure, unit=unit, mean=value, sd=None, n=1, condition=condition)
