"""Joints without stops: readings that wrap or count turns become one way through the joint's range."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from latentarm.core.types import BoolArray, Episode, FloatArray
from latentarm.demonstrations.importers.units import TARGET_POSITION
from latentarm.robots.robot import Robot

TURN: Final = 2.0 * np.pi


def turning(robot: Robot) -> BoolArray:
    """(n,), whether each joint has no stops: neither the model nor a limits file gives any within a turn."""
    limits = robot.limits
    wide = limits.upper - limits.lower >= TURN
    told = np.array(limits.sources["position"])
    return ~robot.chain.slide & ((told == "assumed") | ((told == "limits_file") & wide))


def unwrapped(episodes: Sequence[Episode], robot: Robot) -> tuple[tuple[Episode, ...], str]:
    """Episodes whose turning joints neither jump by a turn nor lie turns outside their range.

    A joint that does neither in any episode is unchanged. For any other, each episode begins within half a
    turn of the first one's beginning, which lies next to the middle of the range. Validation later refuses
    ragged or infinite states. Also returns a note, or "".
    """
    if any(one.state.ndim != 2 or not len(one.state) or not np.isfinite(one.state).all() for one in episodes):
        return tuple(episodes), ""
    states = [one.state.copy() for one in episodes]
    middle = 0.5 * (robot.limits.lower + robot.limits.upper)
    changed: list[str] = []
    for joint in np.flatnonzero(turning(robot)):
        outside = any(robot.limits.violation(one)[:, joint].any() for one in states)
        wraps = sum(int((np.abs(np.diff(one[:, joint])) > np.pi).sum()) for one in states)
        if not (outside or wraps):
            continue
        near = middle[joint]
        for state in states:
            way: FloatArray = np.unwrap(state[:, joint])
            state[:, joint] = way - TURN * np.round((way[0] - near) / TURN)
            near = states[0][0, joint]
        told = [f"wraps {wraps} times"] * bool(wraps) + ["counts turns"] * outside
        changed.append(f"{robot.joint_names[joint]} {' and '.join(told)}")
    text = f"{', '.join(changed)}: unwrapped, each episode moved by whole turns to begin near the first"
    return tuple(map(_with, episodes, states)), text if changed else ""


def _with(episode: Episode, state: FloatArray) -> Episode:
    """The episode with other states; commanded positions keep their distance from them, within a turn."""
    moved = state - episode.state
    if TARGET_POSITION not in episode.extras or not moved.any():
        return replace(episode, state=state)
    target = episode.extras[TARGET_POSITION] + moved
    lag = np.where(moved.any(axis=0), np.round((target - state) / TURN), 0.0)
    return replace(episode, state=state, extras={**episode.extras, TARGET_POSITION: target - TURN * lag})
