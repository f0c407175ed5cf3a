"""A summary of a dataset, for a person to check before training on it."""

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

    rate_hz: float
    episodes: tuple[EpisodeSummary, ...]
    joints: tuple[JointSummary, ...]
    gripper: tuple[GripperUse, ...] = ()  # for each episode; empty where not recorded

    def tables(self) -> tuple[Table, ...]:
        """Tables of episodes, joints and, if recorded, the gripper."""
        tables = {
            "Episodes": [_episode_cells(episode) for episode in self.episodes],
            "Joints": [_joint_cells(joint) for joint in self.joints],
            "Gripper": [_gripper_cells(index, use) for index, use in enumerate(self.gripper)],
        }
        return tuple(
            Table(title, tuple(cells[0]), tuple(tuple(row.values()) for row in cells))
            for title, cells in tables.items()
            if cells
        )

    def rows(self) -> list[Row]:
        """Every figure in machine-readable form; the condition is the episode or joint."""
        rows = [
            _row("episodes", "count", len(self.episodes)),
            _row("samples", "count", sum(one.samples for one in self.episodes)),
            _row("duration_s", "s", sum(one.duration_s for one in self.episodes)),
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
    return Summary(
        rate_hz=demonstrations.rate_hz,
        episodes=tuple(_episode(index, one, robot) for index, one in enumerate(demonstrations.episodes)),
        joints=_joints(demonstrations, None if robot is None else robot.limits),
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


def _episode_cells(one: EpisodeSummary) -> dict[str, str]:
    return {
        "episode": str(one.index),
        "task": one.task,
        "samples": str(one.samples),
        "duration (s)": _text(one.duration_s, 1),
        "rate (Hz)": _text(one.rate_hz, 1),
        "joint path (rad)": _text(one.path_rad, 2),
        "tool path (m)": _text(one.path_m, 2),
        "peak (rad/s)": _text(one.peak_speed_rad_s, 2),
        "still (%)": _text(100 * one.still_fraction, 0),
    }


def _joint_cells(one: JointSummary) -> dict[str, str]:
    return {
        "joint": one.name,
        "lowest (rad)": _text(one.lowest, 3),
        "highest (rad)": _text(one.highest, 3),
        "limits (rad)": "–" if one.lower is None else f"{_text(one.lower, 3)} … {_text(one.upper, 3)}",
        "margin (rad)": _text(one.margin_rad, 3),
        "speed (rad/s) p50": _text(one.speed_p50, 2),
        "p95": _text(one.speed_p95, 2),
        "p99": _text(one.speed_p99, 2),
        "max": _text(one.speed_max, 2),
        "limit": _text(one.speed_limit, 2),
    }


def _gripper_cells(index: int, use: GripperUse) -> dict[str, str]:
    closed, toggled = (
        _text(None if share is None else 100 * share, 0)
        for share in (use.closed_fraction, use.toggled_fraction)
    )
    return {
        "episode": str(index),
        "closed (%)": closed,
        "toggled (%)": toggled,
        "changes": str(use.changes),
    }
