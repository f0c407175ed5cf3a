"""Inspection of a real arm before driving: the driver's findings, and checks for all arms."""

from dataclasses import replace
from pathlib import Path

from latentarm.arms.contract import arm_refusals, check_rate
from latentarm.arms.own_limits import beyond, limit_facts, unconfirmed
from latentarm.arms.real import Fact, Findings, RealArm
from latentarm.core.errors import UserError
from latentarm.robots.robot import Robot


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
        refusals += beyond(found.limits, robot)
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
    return replace(
        found,
        facts=(*facts, *limit_facts(found.limits, robot)),
        refusals=tuple(dict.fromkeys(refusals)),
        notices=(*found.notices, *unconfirmed(found.limits, robot)),
    )
