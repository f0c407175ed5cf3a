"""A summary of a dataset, for a person to check before training on it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

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

    index: int
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
    lower: float | None
    upper: float | None
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


@final
@dataclass(frozen=True)
class Summary:
    """A summary of a dataset."""

    robot: str
    rate_hz: float
    episodes: tuple[EpisodeSummary, ...]
    joints: tuple[JointSummary, ...]
    goals: tuple[str, ...]  # names
    features: tuple[str, ...]  # names of everything recorded beside the states
    gripper: tuple[GripperUse, ...] = ()  # for each episode; empty where not recorded

    @property
    def samples(self) -> int:
        """Number of samples in all episodes."""
        return sum(episode.samples for episode in self.episodes)

    @property
    def duration_s(self) -> float:
        """Total length of all episodes."""
        return sum(episode.duration_s for episode in self.episodes)

    def tables(self) -> tuple[Table, ...]:
        """Tables of episodes, joints and, if recorded, the gripper."""
        gripper = (_gripper_table(self.gripper),) if self.gripper else ()
        return _episode_table(self.episodes), _joint_table(self.joints), *gripper

    def rows(self) -> list[Row]:
        """Every figure in machine-readable form; the condition is the episode or joint."""
        rows = [
            _row("episodes", "count", len(self.episodes)),
            _row("samples", "count", self.samples),
            _row("duration_s", "s", self.duration_s),
            _row("rate_hz", "Hz", self.rate_hz),
        ]
        for episode in self.episodes:
            name = f"episode_{episode.index}"
            rows += [
                _row("samples", "count", episode.samples, name),
                _row("duration_s", "s", episode.duration_s, name),
                _row("rate_hz", "Hz", episode.rate_hz, name),
                _row("path_length_rad", "rad", episode.path_rad, name),
                _row("path_length", "m", episode.path_m, name),
                _row("peak_speed", "rad/s", episode.peak_speed_rad_s, name),
                _row("still_fraction", "1", episode.still_fraction, name),
            ]
        for joint in self.joints:
            rows += [
                _row("lowest", "rad", joint.lowest, joint.name),
                _row("highest", "rad", joint.highest, joint.name),
                _row("limit_margin", "rad", joint.margin_rad, joint.name),
                _row("speed_p50", "rad/s", joint.speed_p50, joint.name),
                _row("speed_p95", "rad/s", joint.speed_p95, joint.name),
                _row("speed_p99", "rad/s", joint.speed_p99, joint.name),
                _row("speed_max", "rad/s", joint.speed_max, joint.name),
            ]
        for index, use in enumerate(self.gripper):
            name = f"episode_{index}"
            rows += [
                _row("gripper_closed_fraction", "1", use.closed_fraction, name),
                _row("gripper_toggled_fraction", "1", use.toggled_fraction, name),
                _row("gripper_changes", "count", use.changes, name),
            ]
        return [row for row in rows if row.mean is not None]


def summarise(demonstrations: Demonstrations, robot: Robot | None = None) -> Summary:
    """Measure a dataset; with a robot also the limits and the end-effector's path."""
    first = demonstrations.episodes[0]
    recorded = ("action",) if first.action is not None else ()
    return Summary(
        robot=demonstrations.robot,
        rate_hz=demonstrations.rate_hz,
        episodes=tuple(_episode(index, one, robot) for index, one in enumerate(demonstrations.episodes)),
        joints=_joints(demonstrations, None if robot is None else robot.limits),
        goals=tuple(goal.name for goal in demonstrations.goals),
        features=(*recorded, *sorted(first.extras)),
        gripper=gripper_uses(demonstrations, None if robot is None else robot.gripper),
    )


def _speed(episode: Episode) -> FloatArray:
    """(T - 1, n), rad/s, between one sample and the next."""
    return np.abs(np.diff(episode.state, axis=0)) / np.diff(episode.timestamp)[:, None]


def _episode(index: int, episode: Episode, robot: Robot | None) -> EpisodeSummary:
    speed = _speed(episode).max(axis=1)
    elapsed = np.diff(episode.timestamp)
    duration = float(episode.timestamp[-1] - episode.timestamp[0])
    return EpisodeSummary(
        index=index,
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
            lower=None if limits is None else float(limits.lower[joint]),
            upper=None if limits is None else float(limits.upper[joint]),
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


def _text(value: float | None, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}f}"


def _episode_table(episodes: Sequence[EpisodeSummary]) -> Table:
    columns = (
        "episode",
        "task",
        "samples",
        "duration (s)",
        "rate (Hz)",
        "joint path (rad)",
        "tool path (m)",
        "peak (rad/s)",
        "still (%)",
    )
    rows = tuple(
        (
            str(one.index),
            one.task,
            str(one.samples),
            _text(one.duration_s, 1),
            _text(one.rate_hz, 1),
            _text(one.path_rad, 2),
            _text(one.path_m, 2),
            _text(one.peak_speed_rad_s, 2),
            _text(100 * one.still_fraction, 0),
        )
        for one in episodes
    )
    return Table("Episodes", columns, rows)


def _gripper_table(uses: Sequence[GripperUse]) -> Table:
    columns = ("episode", "closed (%)", "toggled (%)", "changes")
    rows = tuple(
        (
            str(index),
            _text(None if one.closed_fraction is None else 100 * one.closed_fraction, 0),
            _text(None if one.toggled_fraction is None else 100 * one.toggled_fraction, 0),
            str(one.changes),
        )
        for index, one in enumerate(uses)
    )
    return Table("Gripper", columns, rows)


def _joint_table(joints: Sequence[JointSummary]) -> Table:
    columns = (
        "joint",
        "lowest (rad)",
        "highest (rad)",
        "limits (rad)",
        "margin (rad)",
        "speed (rad/s) p50",
        "p95",
        "p99",
        "max",
        "limit",
    )
    rows = tuple(
        (
            one.name,
            _text(one.lowest, 3),
            _text(one.highest, 3),
            "–" if one.lower is None else f"{_text(one.lower, 3)} … {_text(one.upper, 3)}",
            _text(one.margin_rad, 3),
            _text(one.speed_p50, 2),
            _text(one.speed_p95, 2),
            _text(one.speed_p99, 2),
            _text(one.speed_max, 2),
            _text(one.speed_limit, 2),
        )
        for one in joints
    )
    return Table("Joints", columns, rows)
