"""Evidence that positions are in another unit than stated."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, FloatArray
from latentarm.demonstrations.importers.turns import TURN, turning
from latentarm.demonstrations.importers.units import Unit
from latentarm.robots.robot import Robot

_READABLE: Final = 1e6


def check_degrees(
    demonstrations: Demonstrations, joints: Sequence[int], units: Sequence[Unit], robot: Robot, source: str
) -> None:
    """Refuse positions that can be degrees and cannot be the radians that they are taken for.

    Being outside the limits is not evidence: joints without stops count turns, the robot may be another one,
    and the radians of most arms are within the limits as degrees too. At least a quarter of the joints must
    go past a whole turn, and one of them outside its limits: past two turns although it has stops, or at more
    than a turn a second.
    """
    values = _positions(demonstrations, joints)
    hinges = np.array([unit == "rad" for unit in units]) & ~robot.chain.slide
    if values is None or not hinges.any():
        return
    outside = robot.limits.violation(values).max(axis=0) > 1.0
    in_degrees = robot.limits.violation(np.where(hinges, np.deg2rad(values), values)).max(axis=0)
    stops = hinges & ~turning(robot)
    furthest, speeds = np.abs(values).max(axis=0), _usual_speeds(demonstrations, joints)
    far, fast = stops & (furthest > 2.0 * TURN), hinges & (speeds > TURN)
    many = 4 * np.count_nonzero(hinges & (furthest > TURN)) >= np.count_nonzero(hinges)
    if not many or in_degrees[stops].max(initial=0.0) >= 0.2:
        return
    for joint in [*np.flatnonzero(outside & far), *np.flatnonzero(outside & fast)][:1]:
        why = f"moves at {speeds[joint]:.3g} a second, faster than any arm turns in rad"
        if far[joint]:
            why = f"goes up to {furthest[joint]:.4g}, more than two turns, though it has stops"
        raise UserError(
            f"{source}: joint {robot.joint_names[joint]} {why}, and in degrees every joint is within its"
            " limits: if these are degrees, pass --units deg."
        )


def radians_after_all(
    demonstrations: Demonstrations, joints: Sequence[int], units: Sequence[Unit], robot: Robot
) -> str:
    """A warning if positions stated in degrees look like radians, else ""."""
    values = _positions(demonstrations, joints)
    if values is None or any(unit == "rad" for unit in units):
        return ""
    largest = float(np.abs(values).max())
    if largest < TURN and robot.limits.violation(values).max() < 0.2 and np.ptp(values, axis=0).max() > 0.1:
        return f"no position is beyond {largest:.3g}: they look like rad, not {units[0]}"
    return ""


def _positions(demonstrations: Demonstrations, joints: Sequence[int]) -> FloatArray | None:
    """(N, n), as recorded; None for unreadable numbers, which validation refuses later."""
    states = [one.state for one in demonstrations.episodes if one.state.ndim == 2]
    if not states:
        return None
    values = np.concatenate(states)[:, joints]
    readable = values.size > 0 and bool(np.all(np.abs(values) < _READABLE))
    return values if readable else None


def _usual_speeds(demonstrations: Demonstrations, joints: Sequence[int]) -> FloatArray:
    """(n,), 95th percentile of each joint's speed, in its unit a second; 0 where times do not grow."""
    speeds = [
        np.abs(np.diff(one.state[:, joints], axis=0)) / np.diff(one.timestamp)[:, None]
        for one in demonstrations.episodes
        if one.state.ndim == 2 and len(one.state) > 1 and (np.diff(one.timestamp) > 0).all()
    ]
    return np.percentile(np.concatenate(speeds), 95, axis=0) if speeds else np.zeros(len(joints))
