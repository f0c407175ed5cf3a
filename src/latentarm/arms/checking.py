"""Inspection of a real arm before driving: the driver's findings, and checks for all arms."""

from pathlib import Path
from typing import Final

import numpy as np

from latentarm.arms.contract import arm_refusals, check_rate
from latentarm.arms.real import Fact, Findings, FoundLimits, RealArm
from latentarm.core.errors import UserError
from latentarm.robots.robot import Robot

_BEYOND: Final = 1e-3  # rounding that a limit of the robot may exceed the arm's own by, rad or rad/s


def look_at(arm: RealArm, robot: Robot, dt_s: float) -> Findings:
    """Findings of a driver that is not connected, and checks of all arms; ``dt_s`` is the loop's period."""
    spec, found = arm.spec, arm.look()
    refusals = [*arm_refusals(spec, robot), *found.refusals]
    if spec.simulated:
        refusals.append("The driver says that this arm is simulated: it must state simulated=False.")
    try:
        check_rate(spec, dt_s)
    except UserError as error:
        refusals.append(str(error))
    if found.limits is not None:
        refusals += _beyond(found.limits, robot)
    stops = "not known"
    if spec.stops_after_s is not None:
        stops = f"begins to stop within {1000 * spec.stops_after_s:.0f} ms"
    common = (
        Fact("robot", Path(robot.name).name),
        Fact("joints", ", ".join(spec.joint_names)),
        Fact("gripper", "none" if spec.gripper is None else f"opens {1000 * spec.gripper.width_m:.0f} mm"),
        Fact("commands", f"up to {spec.rate_hz:g} per second"),
        Fact("without commands", stops),
    )
    told = {fact.name for fact in found.facts}
    facts = (*(fact for fact in common if fact.name not in told), *found.facts)
    return Findings(facts, tuple(dict.fromkeys(refusals)), found.limits)


def _beyond(own: FoundLimits, robot: Robot) -> list[str]:
    """Limits of the robot beyond the arm's own, where the arm would stop with a fault."""
    shape = (robot.dof,)
    if not own.lower.shape == own.upper.shape == own.velocity.shape == shape:
        return [
            f"The arm tells limits of {len(own.lower)} joints, and {robot.name} has {robot.dof}: choose the"
            " robot that the arm is."
        ]
    limits = robot.limits
    beyond = {
        "lower": limits.lower < own.lower - _BEYOND,
        "upper": limits.upper > own.upper + _BEYOND,
        "velocity": limits.velocity > own.velocity + _BEYOND,
    }
    said: list[str] = []
    for name, joints in beyond.items():
        for joint in np.flatnonzero(joints):
            slides = bool(robot.chain.slide[joint])
            mine, arms = (
                (1000.0 if slides else 180.0 / np.pi) * getattr(one, name)[joint] for one in (limits, own)
            )
            unit = ("mm" if slides else "°") + ("/s" if name == "velocity" else "")
            said.append(
                f"The {name} limit of {robot.joint_names[joint]} is {mine:.1f}{unit} for {robot.name} and"
                f" {arms:.1f}{unit} for the arm: choose the model that the arm is, or state the arm's own"
                " with --limits FILE."
            )
    return said
