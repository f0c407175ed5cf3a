"""The abilities of an arm with the limits that are stated: reach, speed, and which models it can train."""

from dataclasses import replace
from itertools import product
from typing import Final

import numpy as np

from latentarm.arms.real import Fact
from latentarm.core.errors import UserError
from latentarm.robots.robot import Robot
from latentarm.safety.limits import Bounds
from latentarm.web.arm_process.drive_setup import PERIOD_S, safety_limits
from latentarm.web.arm_process.speed_limits import SLOWEST, Speeds

_SAMPLES: Final = 4000
_HARDLY_RAD: Final = 0.1  # a joint with a smaller range hardly moves, rad or m
_STEP: Final = 0.01  # of proposed speeds, rad/s and m/s
_SLOW: Final = Speeds(0.1, 0.05)
_TIMES: Final = tuple(2.0**power for power in range(11))


def abilities(robot: Robot, asked: Speeds) -> tuple[tuple[Fact, ...], tuple[str, ...]]:
    """Facts, and why the asked speeds cannot be driven with what to change, a sentence, or nothing."""
    bounds = _bounds(robot, asked)
    facts = [Fact("reach", _reach(robot)), Fact("learns from", _learns(robot))]
    if isinstance(bounds, Bounds):
        said = (
            f"{asked.joint:g} rad/s and {asked.link:g} m/s; commands end within {1000 * bounds.stop_s:.0f} ms"
        )
        return (*facts, Fact("driven at up to", said)), ()
    works = _slower(robot, asked)
    if works is not None:
        options = f"--joint-speed {works.joint:g} --link-speed {works.link:g}"
        said = f"{works.joint:g} rad/s and {works.link:g} m/s, with {options}"
        return (*facts, Fact("driven at up to", said)), (f"{bounds.removesuffix('.')}; {options} works.",)
    needed = _quicker(robot)
    said = "no speed works with these limits" + ("" if needed is None else f": {needed}")
    return (*facts, Fact("driven at up to", said)), (f"{bounds.removesuffix('.')}; {said}.",)


def _bounds(robot: Robot, speeds: Speeds) -> Bounds | str:
    try:
        return Bounds(safety_limits(speeds), robot, PERIOD_S)
    except UserError as error:
        return str(error)


def _slower(robot: Robot, asked: Speeds) -> Speeds | None:
    """The fastest speeds that can be driven, up to the asked ones; where joints slide, of links too."""
    limits, slide = robot.limits, robot.chain.slide
    link = min(asked.link, robot.tool_speed_limit)
    joint = min(asked.joint, *limits.velocity[~slide])
    slow_links = bool(slide.any())
    for share in np.linspace(1.0, 0.0, 51):
        speeds = [
            _STEP * np.floor(one / _STEP + 1e-9)
            for one in (share * joint, (share if slow_links else 1.0) * link)
        ]
        if min(speeds) < SLOWEST:
            return None
        found = Speeds(*(round(float(one), 2) for one in speeds))
        if isinstance(_bounds(robot, found), Bounds):
            return found
    return None


def _quicker(robot: Robot) -> str | None:
    """The least factor of the stated figures that slow driving needs, in words; None if they are enough."""
    limits = robot.limits
    for acceleration, jerk in product(_TIMES, _TIMES):
        quicker = replace(limits, acceleration=acceleration * limits.acceleration, jerk=jerk * limits.jerk)
        if isinstance(_bounds(replace(robot, limits=quicker), _SLOW), Bounds):
            times = f"{acceleration:g} times the acceleration and {jerk:g} times the jerk"
            return f"{_SLOW.joint:g} rad/s needs {times}"
    return None


def _reach(robot: Robot) -> str:
    limits = robot.limits
    q = np.random.default_rng(0).uniform(limits.lower, limits.upper, size=(_SAMPLES, robot.dof))
    at = robot.chain.forward(q).position
    far, low, high = np.linalg.norm(at, axis=1).max(), at[:, 2].min(), at[:, 2].max()
    return f"the tool gets {far:.2f} m from the base, and from {low:.2f} to {high:.2f} m high"


def _learns(robot: Robot) -> str:
    limits = robot.limits
    still = [
        name
        for name, span in zip(robot.joint_names, limits.upper - limits.lower, strict=True)
        if span < _HARDLY_RAD
    ]
    said = f"motions of its {robot.dof} joints within these limits, recorded on the page or imported"
    return said + (f"; {', '.join(still)} can hardly move" if still else "")
