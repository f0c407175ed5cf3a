"""Planar arms of the paper's simulations: n links of equal length, one arm or two."""

from functools import cache

import mujoco
import numpy as np

from latentarm.core.errors import UserError
from latentarm.robots.assemble import assemble
from latentarm.robots.limits import JointLimits, same_source
from latentarm.robots.robot import Robot

REACH_M = 1.0  # length of a whole arm
BASES_APART_M = 0.8  # distance between the bases of two arms, along y
_RADIUS_M = 0.02


@cache
def planar(n_links: int = 5, arms: int = 1) -> Robot:
    """A planar arm, or two side by side with one state, the left first. Do not write to its arrays."""
    if n_links < 1 or arms not in (1, 2):
        raise UserError(
            f"A planar robot has at least one link and one or two arms, not {n_links} links and {arms} arms."
        )
    spec = mujoco.MjSpec()
    spec.modelname = "planar" if arms == 1 else f"planar{arms}"
    spec.compiler.degree = False
    length = REACH_M / n_links
    sides = ("",) if arms == 1 else ("left_", "right_")
    for side, y in zip(sides, (0.0,) if arms == 1 else (BASES_APART_M / 2, -BASES_APART_M / 2), strict=True):
        body = spec.worldbody.add_body(name=f"{side}base", pos=[0.0, y, 0.0])
        for i in range(n_links):
            body = body.add_body(name=f"{side}link{i + 1}", pos=[length if i else 0.0, 0.0, 0.0])
            body.add_joint(name=f"{side}joint{i + 1}", axis=[0.0, 0.0, 1.0], range=[-np.pi, np.pi])
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_CAPSULE,
                fromto=[0.0, 0.0, 0.0, length, 0.0, 0.0],
                size=[_RADIUS_M, 0.0, 0.0],
                rgba=[0.93, 0.94, 0.95, 1.0] if i % 2 else [0.35, 0.37, 0.40, 1.0],
            )
        body.add_site(name=f"{side}tool", pos=[length, 0.0, 0.0], size=[0.005, 0.005, 0.005])
    n = n_links * arms
    # Bent to one side, so that no arm starts at a singularity; two arms bend towards each other.
    bend = np.full(n_links, np.pi / (2.0 * n_links))
    bend[0] = -np.pi / 4
    home = np.concatenate([bend, -bend])[-n:] if arms == 2 else bend
    spec.compile()
    spec.add_key(name="home", qpos=list(home))
    spec.compile()
    limits = JointLimits(
        lower=np.full(n, -np.pi),
        upper=np.full(n, np.pi),
        velocity=np.full(n, 2.0),
        acceleration=np.full(n, 10.0),
        jerk=np.full(n, 1000.0),
        # An imaginary arm: these limits are its specification.
        sources=same_source("model", n),
    )
    tools = [f"{side}tool" for side in sides]
    return assemble(spec.modelname, spec.to_xml(), tools, limits, home, 2.0, tool_speed_source="model")
