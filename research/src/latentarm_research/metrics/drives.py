"""Measures of a drive: how far it came, time, input, the tool's way, forces, and what was spilled."""

import itertools
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from typing import Any, Final, final

import numpy as np

from latentarm.core.types import FloatArray, Pose, Row, StepRecord
from latentarm.evaluation.summary import Subject, summarise
from latentarm.robots.kinematics.rotations import angle_between
from latentarm_research.metrics.stick import idle_time, turned_round_share


@final
@dataclass(frozen=True)
class Drive:
    """Figures of one drive."""

    success: bool  # all steps were done, and nothing went wrong
    steps_done: float  # share of the steps that were done
    time_s: float  # from the first step of the loop to the last, s
    idle_s: float  # time without input, s
    input_magnitude: float  # integral of ‖u‖ over time, s (seconds of full deflection of one axis)
    turned_round: float  # share of the time in which the stick points away from where it pointed a moment ago
    mode_switches: int  # how often the controller's mode changed
    path_length: float  # way of the tool through space, m
    stops: int  # how often the arm was stopped, such as for not following when it met a dish
    # integral over time of the tool's distance to the goal that is closest to it, m s; NaN without goals
    goal_error_m_s: float
    goal_error_m: float  # mean of the same distance over time, m
    final_distance: float  # of the tool from the last waypoint of the last step at the end, m
    final_angle_deg: float  # the same for orientation, degrees
    # mean over time of the dot product of the direction in which the tool points and the one needed at that
    # moment
    preference_alignment: float
    # largest force of the tool on the table or a dish, N; NaN where nothing can be touched
    table_force_n: float
    food_force_n: float  # largest force of the tool on food, N; NaN where nothing can be touched
    spilled: int  # grains that were spilled
    grains: int  # grains that there were

    def as_json(self) -> dict[str, object]:
        """Plain mapping; figures without a value are None."""
        return {
            name: None if isinstance(value, float) and not isfinite(value) else value
            for name, value in asdict(self).items()
        }


def path_length(position: FloatArray) -> float:
    """Length of the path through positions (T, 3), m."""
    return float(np.linalg.norm(np.diff(position, axis=0), axis=-1).sum())


def input_magnitude(time_s: FloatArray, u: FloatArray) -> float:
    """Integral of ‖u‖ over time: u (T, d) holds from its own time (T,), s, to the next."""
    return float(np.linalg.norm(u[:-1], axis=-1) @ np.diff(time_s))


def mode_switches(mode: Sequence[int]) -> int:
    """How often the mode differs from the one before."""
    return sum(now != before for before, now in itertools.pairwise(mode))


def goal_error(
    time_s: FloatArray,  # (T,), s
    position: FloatArray,  # (T, 3), the tool; it counts until the next time, m
    goals: FloatArray,  # (G, 3), m
) -> tuple[float, float]:
    """*Goal Error* of the paper's third user study: the "total distance to the closest plate".

    The integral over time, m s, and the mean, m; for a drive that took no time, 0 and the distance; NaN
    without goals.
    """
    if not len(goals):
        return np.nan, np.nan
    closest = np.linalg.norm(position[:, None] - goals, axis=-1).min(axis=1)
    total = float(closest[:-1] @ np.diff(time_s))
    took_s = float(time_s[-1] - time_s[0])
    return total, total / took_s if took_s > 0.0 else float(closest[0])


def measure_drive(
    records: Sequence[StepRecord],  # every step of the loop in order
    tool: Pose,  # (T,), where the tool was at each
    target: Pose,  # the last waypoint of the last step, as things stand at the end
    goals: FloatArray,  # places that the person might have wanted, (G, 3), m
    **at_task: Any,  # the fields of `Drive` that say how the task went
) -> Drive:
    """Figures of a drive from its record. Raises a `ValueError` where there are no records."""
    if not records:
        raise ValueError("A drive without a single step has no figures.")
    time_s = np.array([record.time_s for record in records])
    u = np.stack([record.input for record in records])
    total, mean = goal_error(time_s, tool.position, goals)
    return Drive(
        time_s=float(time_s[-1] - time_s[0]),
        idle_s=idle_time(time_s, u),
        input_magnitude=input_magnitude(time_s, u),
        turned_round=turned_round_share(time_s, u),
        mode_switches=mode_switches([record.mode for record in records]),
        path_length=path_length(tool.position),
        goal_error_m_s=total,
        goal_error_m=mean,
        final_distance=float(np.linalg.norm(tool.position[-1] - target.position)),
        final_angle_deg=float(np.rad2deg(angle_between(tool.rotation[-1], target.rotation))),
        **at_task,
    )


MEASURES: Final = (
    "steps_done",
    "time_s",
    "idle_s",
    "input_magnitude",
    "turned_round",
    "mode_switches",
    "path_length",
    "stops",
    "goal_error_m_s",
    "goal_error_m",
    "final_distance",
    "preference_alignment",
    "table_force_n",
    "food_force_n",
)
"""Fields of `Drive` that are measures as they are, in the order of rows."""


TRIAL_MEASURES: Final = (*MEASURES[: MEASURES.index("stops") + 1], "preference_alignment")
"""Those of every trial of a user study that has a value for them."""


def drive_rows(subject: Subject, drives: Sequence[Drive]) -> list[Row]:
    """Mean and SD over the drives of one condition; measures that no drive has are left out.

    ``success_rate`` is the share of drives that succeeded. All other figures are over all drives,
    failed ones too, so that a controller cannot look fast by giving up.
    """
    spilled = [one.spilled / one.grains if one.grains else np.nan for one in drives]
    rows = [
        summarise(subject, "success_rate", [one.success for one in drives]),
        *(summarise(subject, name, [float(getattr(one, name)) for one in drives]) for name in MEASURES),
        summarise(subject, "spilled_share", spilled),
    ]
    return [row for row in rows if row.n]
