"""Which recorded samples are physically possible; only those go into a dataset."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.core.types import StepRecord
from latentarm.robots.limits import JointLimits

_OUTSIDE: Final = 0.01  # readings this far past a limit are noise, rad
_JUMP: Final = 0.03
"""Tolerance on how far a joint can move between two samples, rad: sensors that are slower than the loop move
in steps, and are noisy."""


def first_implausible(
    records: Sequence[StepRecord], joint_names: Sequence[str], limits: JointLimits | None
) -> tuple[int, str] | None:
    """The index of an episode's first impossible sample and a short reason; None if all are possible.

    ``limits`` are of the joints; without them only numbers and the clock are checked. Where one sample has a
    gripper, those without are impossible.
    """
    if not records:
        return None
    state = np.stack([record.state for record in records])
    time_s = np.array([record.time_s for record in records])
    found: list[tuple[int, str]] = []
    unread = ~np.isfinite(state).all(axis=1)
    if unread.any():
        found.append((int(unread.argmax()), "the joints could not be read"))
    ungripped = np.array([record.gripper is None for record in records])
    if ungripped.any() and not ungripped.all():
        found.append((int(ungripped.argmax()), "the gripper could not be read"))
    elapsed_s = np.diff(time_s)
    # Written so that a time that is not a number counts as well.
    back = ~(elapsed_s > 0.0)
    if back.any():
        found.append((int(back.argmax()) + 1, "the clock stood still or went back"))
    if limits is not None:
        found.extend(_beyond(state, elapsed_s, joint_names, limits))
    return min(found, key=lambda one: one[0], default=None)


def _beyond(
    state: np.ndarray, elapsed_s: np.ndarray, joint_names: Sequence[str], limits: JointLimits
) -> list[tuple[int, str]]:
    found: list[tuple[int, str]] = []
    # NaN samples are reported above; they must not raise here.
    outside = np.nan_to_num(limits.violation(state)) > _OUTSIDE
    if outside.any():
        index, joint = np.argwhere(outside)[0]
        ends = f"{limits.lower[joint]:.3g} and {limits.upper[joint]:.3g}"
        reads = f"joint {joint_names[joint]!r} reads {state[index, joint]:.3g}"
        found.append((int(index), f"{reads}, outside its limits {ends}"))
    moved = np.nan_to_num(np.abs(np.diff(state, axis=0)))
    fast = moved > limits.velocity * np.maximum(elapsed_s, 0.0)[:, None] + _JUMP
    if fast.any():
        index, joint = np.argwhere(fast)[0]
        speed = moved[index, joint] / max(float(elapsed_s[index]), 1e-9)
        moves = f"joint {joint_names[joint]!r} moves at {speed:.3g} rad/s"
        found.append((int(index) + 1, f"{moves} and can do {limits.velocity[joint]:.3g}"))
    return found
