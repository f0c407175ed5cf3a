"""Measures of a drive: success, time, input, mode switches, path, and distances from goals and target."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from latentarm.core.types import FloatArray, Pose, Row, StepRecord
from latentarm.evaluation.contract import PlacesTool
from latentarm.evaluation.summary import Subject, summarise
from latentarm.robots.kinematics.rotations import angle_between
from latentarm_research.metrics.stick import idle_time, turned_round_share


@dataclass(frozen=True)
class Drive:
    """Figures that every drive has.

    Attributes:
        success: the task was done.
        time_s: from the first step to the last, s.
        idle_s: time without input, s.
        input_magnitude: integral of ‖u‖ over time, s (seconds of full deflection of one axis).
        turned_round: share of the time in which the stick points away from where it pointed a moment ago.
        mode_switches: how often the controller's mode changed.
        path_length: way of the tool through space, m.
    """

    success: bool
    time_s: float
    idle_s: float
    input_magnitude: float
    turned_round: float
    mode_switches: int
    path_length: float


@dataclass(frozen=True)
class GoalDrive:
    """Figures of one drive to a goal.

    Attributes:
        drive: those that every drive has.
        goal_error_m_s: integral over time of the tool's distance to the goal that is closest to it, m s.
        goal_error_m: mean of the same distance over time, m.
        final_distance: of the tool from the target at the end, m.
        final_angle_deg: of the tool from the target's orientation at the end, degrees.
    """

    drive: Drive
    goal_error_m_s: float
    goal_error_m: float
    final_distance: float
    final_angle_deg: float


def path_length(position: FloatArray) -> float:
    """Length of the path through positions (T, 3), m."""
    return float(np.linalg.norm(np.diff(position, axis=0), axis=-1).sum())


def input_magnitude(time_s: FloatArray, u: FloatArray) -> float:
    """Integral of ‖u‖ over time: u (T, d) holds from its own time (T,), s, to the next."""
    return float(np.linalg.norm(u[:-1], axis=-1) @ np.diff(time_s))


def mode_switches(mode: Sequence[int]) -> int:
    """How often the mode differs from the one before."""
    return sum(now != before for before, now in itertools.pairwise(mode))


def goal_error(time_s: FloatArray, position: FloatArray, goals: FloatArray) -> tuple[float, float]:
    """*Goal Error* of the paper's third user study: the "total distance to the closest plate".

    Args:
        time_s: (T,), s.
        position: (T, 3), the tool; it counts until the next time, m.
        goals: (G, 3), m.

    Returns:
        The integral over time, m s, and the mean, m; for a drive that took no time, 0 and the distance.
    """
    closest = np.linalg.norm(position[:, None] - goals, axis=-1).min(axis=1)
    total = float(closest[:-1] @ np.diff(time_s))
    took_s = float(time_s[-1] - time_s[0])
    return total, total / took_s if took_s > 0.0 else float(closest[0])


def measure_drive(records: Sequence[StepRecord], position: FloatArray, *, success: bool) -> Drive:
    """Figures of a drive from its record.

    Args:
        records: every step in order.
        position: (T, 3), the tool at each, m.
        success: whether the task says that it was done.

    Raises:
        ValueError: there are no records.
    """
    if not records:
        raise ValueError("A drive without a single step has no figures.")
    time_s = np.array([record.time_s for record in records])
    u = np.stack([record.input for record in records])
    return Drive(
        success=success,
        time_s=float(time_s[-1] - time_s[0]),
        idle_s=idle_time(time_s, u),
        input_magnitude=input_magnitude(time_s, u),
        turned_round=turned_round_share(time_s, u),
        mode_switches=mode_switches([record.mode for record in records]),
        path_length=path_length(position),
    )


def measure_goal_drive(
    records: Sequence[StepRecord],
    chain: PlacesTool,
    target: Pose,
    goals: Sequence[Pose],
    *,
    success: bool,
    tool: int = 0,
) -> GoalDrive:
    """Figures of a drive to a goal from its record.

    Args:
        records: every step in order; the last holds the state in which the drive ended.
        chain: the robot's forward kinematics.
        target: where the tool was to end.
        goals: all that the person might have wanted; at least one.
        success: whether the task says that it was done.
        tool: which end-effector, where there are several.

    Raises:
        ValueError: there are no records.
    """
    if not records:
        raise ValueError("A drive without a single step has no figures.")
    pose = chain.forward(np.stack([record.state for record in records]), tool)
    position = pose.position
    time_s = np.array([record.time_s for record in records])
    total, mean = goal_error(time_s, position, np.stack([goal.position for goal in goals]))
    return GoalDrive(
        drive=measure_drive(records, position, success=success),
        goal_error_m_s=total,
        goal_error_m=mean,
        final_distance=float(np.linalg.norm(position[-1] - target.position)),
        final_angle_deg=float(np.rad2deg(angle_between(pose.rotation[-1], target.rotation))),
    )


def drive_rows(subject: Subject, drives: Sequence[Drive]) -> list[Row]:
    """Mean and SD over the drives of one condition, of what every drive has.

    ``success_rate`` is the share of drives that succeeded. All other figures are over all drives,
    failed ones too, so that a controller cannot look fast by giving up.
    """
    return [
        summarise(subject, "success_rate", [drive.success for drive in drives]),
        summarise(subject, "time_s", [drive.time_s for drive in drives]),
        summarise(subject, "idle_s", [drive.idle_s for drive in drives]),
        summarise(subject, "input_magnitude", [drive.input_magnitude for drive in drives]),
        summarise(subject, "turned_round", [drive.turned_round for drive in drives]),
        summarise(subject, "mode_switches", [drive.mode_switches for drive in drives]),
        summarise(subject, "path_length", [drive.path_length for drive in drives]),
    ]


def goal_drive_rows(subject: Subject, drives: Sequence[GoalDrive]) -> list[Row]:
    """Mean and SD over the drives to goals of one condition, failed ones too."""
    return [
        *drive_rows(subject, [one.drive for one in drives]),
        summarise(subject, "goal_error_m_s", [one.goal_error_m_s for one in drives]),
        summarise(subject, "goal_error_m", [one.goal_error_m for one in drives]),
        summarise(subject, "final_distance", [one.final_distance for one in drives]),
    ]
