"""Looks at an arm at poses that a person moves it to by hand."""

import time
from collections.abc import Callable
from typing import Final

from latentarm.arms.catalogue import make_real_arm
from latentarm.arms.checking import look_at
from latentarm.arms.real import Fact, Findings, GuidableArm, RealArm
from latentarm.control.clock import MonotonicClock
from latentarm.control.loop import ENABLING_S
from latentarm.core.errors import UserError
from latentarm.robots.robot import Robot
from latentarm.web.arm_process.drive_setup import PERIOD_S

_POSES: Final = 3
_LOOK_S: Final = 0.02


def look_guided(address: str, robot: Robot, ask: Callable[[str], None]) -> Findings:
    """Look at three poses. ``ask`` says what to do and waits until it is done.

    The person can move the arm only while they are asked; it holds its position while its pose is read.
    """
    facts: list[Fact] = []
    refusals: list[str] = []
    for number in range(1, _POSES + 1):
        arm = make_real_arm(address, robot, MonotonicClock().now_s)
        try:
            how = released(arm)
            ask(f"Pose {number} of {_POSES}. {how} Turn every joint by 10° or more, each by another angle.")
        finally:
            arm.close()
        found = look_at(make_real_arm(address, robot, MonotonicClock().now_s), robot, PERIOD_S)
        facts += [Fact(f"{one.name} {number}", one.value) for one in found.facts if one.name == "tool pose"]
        refusals += found.refusals
    return Findings(tuple(facts), tuple(dict.fromkeys(refusals)))


def released(arm: RealArm) -> str:
    """Let go of an arm that can be guided from here; how it is moved, a sentence."""
    if not isinstance(arm, GuidableArm):
        return "Move the arm with its own controls."
    arm.connect()
    try:
        arm.guide()
    except UserError:
        return "Switch on the arm's own mode for guiding by hand, move it, and switch that off."
    until_s = time.monotonic() + ENABLING_S
    while (status := arm.status()).phase != "guided":
        if status.phase != "disabled" or time.monotonic() > until_s:
            raise UserError(f"The arm cannot be moved by hand now ({status.reason.removesuffix('.')}).")
        time.sleep(_LOOK_S)
    return "The arm can be moved by hand until you press Enter: hold it."
