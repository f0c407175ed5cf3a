"""Detects implausible rates and speeds, and speeds beyond the arm's limits."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations
from latentarm.robots.robot import Robot

SLOWEST_HZ: Final = 1.0
FASTEST_HZ: Final = 1000.0
RATE_TOLERANCE: Final = 0.2  # of the timestamps' rate, as a share of the stated one
IMPLAUSIBLE_RAD_S: Final = 30.0
"""Five turns a second, faster than any arm's joint; usually a sign of lost samples or wrong units."""


def check_rate(demonstrations: Demonstrations, source: str) -> None:
    """Refuse rates that no recording of an arm has, or that the timestamps contradict."""
    rate = demonstrations.rate_hz
    if not SLOWEST_HZ <= rate <= FASTEST_HZ:
        raise UserError(
            f"{source}: the sampling rate is {rate:g} Hz; recordings of arms have {SLOWEST_HZ:g} to"
            f" {FASTEST_HZ:g} Hz: state the right one with --rate-hz, or check the unit of the timestamps"
            " (s)."
        )
    steps = np.concatenate([np.diff(episode.timestamp) for episode in demonstrations.episodes])
    timed = 1.0 / float(np.median(steps))
    if abs(timed - rate) > RATE_TOLERANCE * rate:
        raise UserError(
            f"{source}: the timestamps advance at {timed:.4g} Hz, but the rate is {rate:g} Hz: one of them is"
            f" wrong, and so are all speeds. If the timestamps are right, pass --rate-hz {timed:.4g}."
        )


def speed_warning(demonstrations: Demonstrations, robot: Robot, source: str, names: Sequence[str]) -> str:
    """Refuse impossible speeds; return a sentence about the joint furthest beyond its limit, or ""."""
    limit = robot.limits.velocity
    peak, over, count = np.zeros(robot.dof), 0, 0
    for name, episode in zip(names, demonstrations.episodes, strict=True):
        speed = np.abs(np.diff(episode.state, axis=0)) / np.diff(episode.timestamp)[:, None]
        wild = (speed > IMPLAUSIBLE_RAD_S) & (speed > limit) & ~robot.chain.slide
        for sample, joint in np.argwhere(wild)[:1]:
            raise UserError(
                f"{source}: episode {name}, sample {sample + 1}: joint {robot.joint_names[joint]} moves at"
                f" {speed[sample, joint]:.0f} rad/s, which no arm can do: look for lost samples, wrong units"
                " (--units) or a wrong rate (--rate-hz)."
            )
        peak = np.maximum(peak, speed.max(axis=0))
        over += int((speed > limit).any(axis=1).sum())
        count += len(speed)
    if not over:
        return ""
    worst = int(np.argmax(peak / limit))
    known = "assumed limit" if robot.limits.sources["velocity"][worst] == "assumed" else "limit"
    return (
        f"{100.0 * over / count:.2g} % of the steps are faster than the robot's limits:"
        f" {robot.joint_names[worst]} goes up"
        f" to {peak[worst]:.2f} rad/s, its {known} is {limit[worst]:.2f} rad/s"
    )
