"""A summary of a dataset, for a person to check before training on it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple, final

import numpy as np

from latentarm.core.types import Demonstrations, Episode, FloatArray, Row
from latentarm.demonstrations.gripper import GripperUse, gripper_uses
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.limits import JointLimits
from latentarm.robots.robot import Robot

STUDY: Final = "inspect"


@final
@dataclass(frozen=True)
class EpisodeSummary:
    """Figures of one episode."""

    task: str
    samples: int
    duration_s: float
    rate_hz: float  # samples per second by its own timestamps
    path_rad: float  # length of its path in joint space
    path_m: float | None  # length of the end-effector's path, or None without a robot
    peak_speed_rad_s: float  # of the fastest joint, from displacements between samples
    still_fraction: float  # share of the time in which no joint is faster than `STILL_RAD_S`


@final
@dataclass(frozen=True)
class JointSummary:
    """Figures of one joint over all episodes, rad and rad/s; limits are None without a robot."""

    name: str
    lowest: float
    highest: float
    limits: str | None  # lower and upper, for people
    margin_rad: float | None  # least distance to a limit; negative past it
    speed_p50: float
    speed_p95: float
    speed_p99: float
    speed_max: float
    speed_limit: float | None


@final
@dataclass(frozen=True)
class Table:
    """A table as plain data for the command line, with units in its headings."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


class _Figure(NamedTuple):
    field: str  # of a summary
    heading: str  # of its column
    shown: str = ""  # format in the table; a share is in percent
    measure: str = ""  # in machine-readable form; "" for none
    unit: str = ""


_EPISODE: Final = (
    _Figure("task", "task"),
    _Figure("samples", "samples", "d", "samples", "count"),
    _Figure("duration_s", "duration (s)", ".1f", "duration_s", "s"),
    _Figure("rate_hz", "rate (Hz)", ".1f", "rate_hz", "Hz"),
    _Figure("path_rad", "joint path (rad)", ".2f", "path_length_rad", "rad"),
    _Figure("path_m", "tool path (m)", ".2f", "path_length", "m"),
    _Figure("peak_speed_rad_s", "peak (rad/s)", ".2f", "peak_speed", "rad/s"),
    _Figure("still_fraction", "still (%)", ".0%", "still_fraction", "1"),
)
_JOINT: Final = (
    _Figure("lowest", "lowest (rad)", ".3f", "lowest", "rad"),
    _Figure("highest", "highest (rad)", ".3f", "highest", "rad"),
    _Figure("limits", "limits (rad)"),
    _Figure("margin_rad", "margin (rad)", ".3f", "limit_margin", "rad"),
    _Figure("speed_p50", "speed (rad/s) p50", ".2f", "speed_p50", "rad/s"),
    _Figure("speed_p95", "p95", ".2f", "speed_p95", "rad/s"),
    _Figure("speed_p99", "p99", ".2f", "speed_p99", "rad/s"),
    _Figure("speed_max", "max", ".2f", "speed_max", "rad/s"),
    _Figure("speed_limit", "limit", ".2f"),
)
_GRIPPER: Final = (
    _Figure("closed_fraction", "closed (%)", ".0%", "gripper_closed_fraction", "1"),
    _Figure("toggled_fraction", "toggled (%)", ".0%", "gripper_toggled_fraction", "1"),
    _Figure("changes", "changes", "d", "gripper_changes", "count"),
)


@final
@dataclass(frozen=True)
class Summary:
    """A summary of a dataset."""

    rate_hz: float
    episodes: tuple[EpisodeSummary, ...]
    joints: tuple[JointSummary, ...]
    gripper: tuple[GripperUse, ...] = ()  # for each episode; empty where not recorded

    def tables(self) -> tuple[Table, ...]:
        """Tables of episodes, joints and, if recorded, the gripper."""
        return tuple(
            Table(
                title,
                (noun, *(one.heading for one in figures)),
                tuple((name, *(_cell(part, one) for one in figures)) for name, part in parts.items()),
            )
            for title, noun, parts, figures in self._parts()
            if parts
        )

    def rows(self) -> list[Row]:
        """Every figure in machine-readable form; the condition is the episode or joint."""
        rows = [
            _row("episodes", "count", len(self.episodes)),
            _row("samples", "count", sum(one.samples for one in self.episodes)),
            _row("duration_s", "s", sum(one.duration_s for one in self.episodes)),
            _row("rate_hz", "Hz", self.rate_hz),
        ]
        for _, noun, parts, figures in self._parts():
            for name, part in parts.items():
                condition = f"episode_{name}" if noun == "episode" else name
                measured = (one for one in figures if one.measure)
                rows += [_row(one.measure, one.unit, getattr(part, one.field), condition) for one in measured]
        return [row for row in rows if row.mean is not None]

    def _parts(self) -> tuple[tuple[str, str, Mapping[str, object], tuple[_Figure, ...]], ...]:
        """Title, noun, summaries by name, and figures of each table."""
        episodes = {str(index): one for index, one in enumerate(self.episodes)}
        joints = {one.name: one for one in self.joints}
        gripper = dict(zip(episodes, self.gripper, strict=False))
        return (
            ("Episodes", "episode", episodes, _EPISODE),
            ("Joints", "joint", joints, _JOINT),
            ("Gripper", "episode", gripper, _GRIPPER),
        )


def _cell(part: object, figure: _Figure) -> str:
    value = getattr(part, figure.field)
    return "–" if value is None else format(value, figure.shown).removesuffix("%")


def summarise(demonstrations: Demonstrations, robot: Robot | None = None) -> Summary:
    """Measure a dataset; with a robot also the limits and the end-effector's path."""
    return Summary(
        rate_hz=demonstrations.rate_hz,
        episodes=tuple(_episode(one, robot) for one in demonstrations.episodes),
        joints=_joints(demonstrations, None if robot is None else robot.limits),
        gripper=gripper_uses(demonstrations, None if robot is None else robot.gripper),
    )


def _speed(episode: Episode) -> FloatArray:
    """(T - 1, n), rad/s, between one sample and the next."""
    return np.abs(np.diff(episode.state, axis=0)) / np.diff(episode.timestamp)[:, None]


def _episode(episode: Episode, robot: Robot | None) -> EpisodeSummary:
    speed = _speed(episode).max(axis=1)
    elapsed = np.diff(episode.timestamp)
    duration = float(episode.timestamp[-1] - episode.timestamp[0])
    return EpisodeSummary(
        task=episode.task,
        samples=len(episode.timestamp),
        duration_s=duration,
        rate_hz=(len(episode.timestamp) - 1) / duration,
        path_rad=_length(episode.state),
        path_m=None if robot is None else _length(robot.chain.forward(episode.state).position),
        peak_speed_rad_s=float(speed.max()),
        still_fraction=float(elapsed[speed <= STILL_RAD_S].sum() / duration),
    )


def _length(points: FloatArray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _joints(demonstrations: Demonstrations, limits: JointLimits | None) -> tuple[JointSummary, ...]:
    states = np.concatenate([episode.state for episode in demonstrations.episodes])
    speeds = np.concatenate([_speed(episode) for episode in demonstrations.episodes])
    lowest, highest = states.min(axis=0), states.max(axis=0)
    p50, p95, p99, fastest = np.percentile(speeds, [50, 95, 99, 100], axis=0)
    return tuple(
        JointSummary(
            name=name,
            lowest=float(lowest[joint]),
            highest=float(highest[joint]),
            limits=None if limits is None else f"{limits.lower[joint]:.3f} … {limits.upper[joint]:.3f}",
            margin_rad=None
            if limits is None
            else float(min(lowest[joint] - limits.lower[joint], limits.upper[joint] - highest[joint])),
            speed_p50=float(p50[joint]),
            speed_p95=float(p95[joint]),
            speed_p99=float(p99[joint]),
            speed_max=float(fastest[joint]),
            speed_limit=None if limits is None else float(limits.velocity[joint]),
        )
        for joint, name in enumerate(demonstrations.joint_names)
    )


def _row(measure: str, unit: str, value: float | None, condition: str | None = None) -> Row:
    return Row(study=STUDY, measure=measure, unit=unit, mean=value, sd=None, n=1, condition=condition)
