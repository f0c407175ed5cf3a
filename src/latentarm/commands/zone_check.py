"""A zones file for an arm: its speeds, and how far from each zone and solid the arm stands."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from latentarm.arms.real import Fact, Findings
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.obstacles import HalfSpace
from latentarm.robots.robot import Robot
from latentarm.safety.body import Body, Placement
from latentarm.safety.config import SafetyConfig
from latentarm.safety.proximity import heights_change
from latentarm.safety.zone_distances import ZoneDistances
from latentarm.safety.zones import SLOWEST_M_PER_S, Zone
from latentarm.safety.zones_file import StatedZones, read_zones
from latentarm.web.arm_process.speed_limits import Speeds


def zones_for(path: Path | None, speeds: Speeds) -> StatedZones:
    """The zones of a file, in which an arm with a lower speed of its links keeps that one."""
    if path is None:
        return StatedZones()
    stated, most = read_zones(path), Speeds().link
    for zone in stated.slow:
        if zone.speed > most:
            raise UserError(
                f"{path}: the zone {zone.name!r} allows {zone.speed:g} m/s, and the arm may do {most:g} m/s"
                " anywhere: state at most that."
            )
    return replace(stated, slow=tuple(replace(one, speed=min(one.speed, speeds.link)) for one in stated.slow))


def with_distances(found: Findings, stated: StatedZones, robot: Robot, q: FloatArray) -> Findings:
    """The findings, and how far the arm's moving parts are from each zone and solid at ``q``, (n,), rad."""
    body, usual_m = Body(robot), SafetyConfig.clearance
    # Distances are to solids grown by the clearance that they keep beyond the usual.
    grown = [kept_m - usual_m for kept_m in stated.clearance]
    solids = tuple(Zone(solid, SLOWEST_M_PER_S) for solid in stated.keep_out)
    everything = (*stated.slow, *solids)
    distances, placement = ZoneDistances(body, everything), Placement(body, q)
    parts = [robot.capsules.name[one] for one in body.capsule] + [tool.name for tool in robot.chain.tools]
    facts, notices = list(found.facts), list(found.notices)
    for index, zone in enumerate(everything):
        solid = index - len(stated.slow)
        away = distances.measured(index, placement) + (grown[solid] if solid >= 0 else 0.0)
        if solid >= 0 and isinstance(zone.shape, HalfSpace):
            # A base that turns on a table comes no closer to it.
            away[: body.count][~heights_change(body, [zone.shape])[0]] = np.inf
        nearest = int(np.argmin(away))
        said = f"{1000 * away[nearest]:.0f} mm away from {parts[nearest]}"
        kind = f"zone {zone.name}" if solid < 0 else f"keep out of {zone.name}"
        facts.append(Fact(kind, said))
        if solid >= 0 and away[nearest] < stated.clearance[solid]:
            notices.append(
                f"{zone.name} is {said}, and {1000 * stated.clearance[solid]:.0f} mm are kept: from where it"
                " stands the arm may only leave, or the file has it elsewhere than it is."
            )
    return replace(found, facts=tuple(facts), notices=tuple(notices))
