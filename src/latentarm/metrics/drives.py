"""Measures of a drive: success, time, input, mode switches, path and final distance."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from latentarm.kinematics.rotations import angle_between
from latentarm.metrics.contract import PlacesTool
from latentarm.metrics.summary import Subject, summarise
from latentarm.types import FloatArray, Pose, Row, StepRecord


@dataclass(frozen=True)
class Drive:
    """Figures of one drive.

    Attributes:
        success: the task was done.
        time_s: from the first step to the last, s.
        input_magnitude: integral of ‖u‖ over time, s (seconds of full deflection of one axis).
        mode_switches: how often the controller's mode changed.
        path_length: way of the tool through space, m.
        final_distance: of the tool from the target at the end, m.
        final_angle_deg: of the tool from the target's orientation at the end, degrees.
    """

    success: bool
    time_s: float
    input_magnitude: float
    mode_switches: int
    path_length: float
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


def measure_drive(
    records: Sequence[StepRecord], chain: PlacesTool, target: Pose, *, success: bool, tool: int = 0
) -> Drive:
    """Figures of a drive from its record.

    Args:
        records: every step in order; the last holds the state in which the drive ended.
        chain: the robot's forward kinematics.
        target: where the tool was to end.
        success: whether the task says that it was done.
        tool: which end-effector, where there are several.

    Raises:
        ValueError: there are no records.
    """
    if not records:
        raise ValueError("A drive without a single step has no figures.")
    time_s = np.array([record.time_s for record in records])
    pose = chain.forward(np.stack([record.state for record in records]), tool)
    position = pose.position
    return Drive(
        success=success,
        time_s=float(time_s[-1] - time_s[0]),
        input_magnitude=input_magnitude(time_s, np.stack([record.input for record in records])),
        mode_switches=mode_switches([record.mode for record in records]),
        path_length=path_length(position),
        final_distance=float(np.linalg.norm(position[-1] - target.position)),
        final_angle_deg=float(np.rad2deg(angle_between(pose.rotation[-1], target.rotation))),
    )


def drive_rows(subject: Subject, drives: Sequence[Drive]) -> list[Row]:
    """Mean and SD over the drives of one condition.

    ``success_rate`` is the share of drives that succeeded. All other figures are over all drives,
    failed ones too, so that a controller cannot look fast by giving up.
    """
    return [
        summarise(subject, "success_rate", [drive.success for drive in drives]),
        summarise(subject, "time_s", [drive.time_s for drive in drives]),
        summarise(subject, "input_magnitude", [drive.input_magnitude for drive in drives]),
        summarise(subject, "mode_switches", [drive.mode_switches for drive in drives]),
        summarise(subject, "path_length", [drive.path_length for drive in drives]),
        summarise(subject, "final_distance", [drive.final_distance for drive in drives]),
    ]
