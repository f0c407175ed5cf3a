"""Compares the kind that an arm says it is, and the poses of its flange and tool, with the model."""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Final, final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.arms.real import Fact
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.reader import read
from latentarm.robots.robot import Robot

TOLERANCE_M: Final = 0.005
TOLERANCE_DEG: Final = 1.0  # a model that is farther off is refused
_AROUND_RAD: Final = 0.15  # step between the joints of `poses_about`


@final
@dataclass(frozen=True, eq=False)
class OwnPose:
    """Where an arm itself says that its tool is, in its base frame, at some joint positions."""

    q: FloatArray  # (n,), in the robot's order, rad
    tool: FloatArray  # (4, 4), m
    offset: FloatArray | None = None  # (4, 4), the tool in the flange's frame, m; None where it is not told


def poses_about(q: FloatArray, robot: Robot) -> tuple[FloatArray, ...]:
    """Three other positions (n,), rad, within the limits, in each of which the joints differ from each other.

    For arms that compute poses for any joint positions: two joints that stand alike, and so cannot be told
    apart by one pose, are apart in these.
    """
    steps = np.where(robot.chain.slide, 0.1, 1.0) * _AROUND_RAD * (1.0 + np.arange(robot.dof))
    found = [q + np.roll(steps * np.where(np.arange(robot.dof) % 2, -1.0, 1.0), turn) for turn in range(3)]
    return tuple(np.clip(one, robot.limits.lower, robot.limits.upper) for one in found)


def misfits(poses: Sequence[OwnPose], robot: Robot) -> tuple[str, ...]:
    """Why the model is not the arm, at most one sentence: its kinematics first, then its tool."""
    frames = list(_frames(robot))
    for own in poses:
        if own.offset is not None and (said := _flange_misfit(own, own.offset, robot, frames)):
            return (said,)
    for own in poses:
        if said := _tool_misfit(own, robot):
            return (said,)
    return ()


def compared(poses: Sequence[OwnPose], robot: Robot) -> Fact:
    """How far the arm's and the model's tool are apart, and what these poses cannot tell."""
    if not poses:
        return Fact("tool pose", "not told by the arm, so not compared: compare the page's picture with it")
    apart = [_apart(one.tool, _tool(robot, one.q)) for one in poses]
    metres, degrees = (max(figures) for figures in zip(*apart, strict=True))
    where = "at one pose" if len(poses) == 1 else f"at {len(poses)} poses"
    said = f"{1000 * metres:.1f} mm and {degrees:.1f}° from the model's {where}"
    alike = [
        f"{robot.joint_names[one]} and {robot.joint_names[other]}"
        for one, other in combinations(range(robot.dof), 2)
        if all(_near(_tool(robot, _swapped(own.q, one, other)), own.tool) for own in poses)
    ]
    if alike:
        said += f"; it does not tell apart {', '.join(alike)}: add --guided to compare other poses"
    return Fact("tool pose", said)


def _flange_misfit(
    own: OwnPose, offset: FloatArray, robot: Robot, frames: Sequence[tuple[str, FloatArray]]
) -> str:
    """Compare the arm's flange with the nearest frame of the last link, but for a turn about its axis."""
    flange = own.tool @ np.linalg.inv(offset)
    link = robot.chain.link_transforms(own.q)[robot.chain.tools[0].link]
    found: list[tuple[float, float, str]] = []
    for name, frame in frames:
        placed = link @ frame
        turned = np.degrees(np.arccos(np.clip(flange[:3, 2] @ placed[:3, 2], -1.0, 1.0)))
        found.append((float(np.linalg.norm(flange[:3, 3] - placed[:3, 3])), float(turned), name))
    if any(metres <= TOLERANCE_M and turned <= TOLERANCE_DEG for metres, turned, _ in found):
        return ""
    metres, turned, name = min(found)
    return (
        f"At {_angles(own, robot)} the arm says that its flange is at {_place(flange)} mm, which is"
        f" {1000 * metres:.0f} mm and {turned:.1f}° from {name} of {robot.name} ({_tolerance()}): choose the"
        " model that the arm is, with its joints in the arm's order and in the arm's own base frame."
    )


def _tool_misfit(own: OwnPose, robot: Robot) -> str:
    theirs, ours, name = own.tool, _tool(robot, own.q), robot.chain.tools[0].name
    if _near(theirs, ours):
        return ""
    metres, degrees = _apart(theirs, ours)
    said = (
        f"At {_angles(own, robot)} the arm says that its tool is at {_place(theirs)} mm, which is"
        f" {1000 * metres:.0f} mm and {degrees:.1f}° from {name} of {robot.name} ({_tolerance()}): "
    )
    if own.offset is None:
        return (
            said + "choose the model that the arm is, another --end-effector, or the arm's own frame for it."
        )
    needed = np.linalg.inv(own.tool @ np.linalg.inv(own.offset)) @ ours
    (a, _, _), (b, _, _), (c, d, e) = needed[:3, :3].tolist()
    turn = np.degrees([math.atan2(d, e), math.asin(min(max(-c, -1.0), 1.0)), math.atan2(b, a)])
    return said + (
        "name another --end-effector, or, if the arm carries what the model says, set the tool on the arm to"
        f" {_place(needed)} mm and roll, pitch, yaw {', '.join(map(_whole, turn))}° from its"
        " flange."
    )


def _frames(robot: Robot) -> Iterator[tuple[str, FloatArray]]:
    """The frames that ride on the tool's link, in that link's frame: its bodies, and the tool itself."""
    tool = robot.chain.tools[0]
    yield tool.name, tool.transform
    model = robot.model()
    reading = read(model, [tool.name])
    for body in np.flatnonzero(reading.body_link == reading.chain.tools[0].link):
        yield model.body(int(body)).name, reading.body_transform[body]


def _tool(robot: Robot, q: FloatArray) -> FloatArray:
    pose = robot.chain.forward(q)
    placed = np.eye(4)
    placed[:3, :3], placed[:3, 3] = pose.rotation, pose.position
    return placed


def _apart(one: FloatArray, other: FloatArray) -> tuple[float, float]:
    """The distance, m, and the angle, degrees, between two poses (4, 4)."""
    turn = Rotation.from_matrix(one[:3, :3].T @ other[:3, :3]).magnitude()
    return float(np.linalg.norm(one[:3, 3] - other[:3, 3])), float(np.degrees(turn))


def _near(one: FloatArray, other: FloatArray) -> bool:
    metres, degrees = _apart(one, other)
    return metres <= TOLERANCE_M and degrees <= TOLERANCE_DEG


def _swapped(q: FloatArray, one: int, other: int) -> FloatArray:
    found = q.copy()
    found[[one, other]] = q[[other, one]]
    return found


def _angles(own: OwnPose, robot: Robot) -> str:
    figures = (
        f"{1000 * one:.0f} mm" if slides else f"{np.degrees(one):.0f}°"
        for one, slides in zip(own.q, robot.chain.slide, strict=True)
    )
    return f"joints {', '.join(figures)}"


def _place(frame: FloatArray) -> str:
    return f"({', '.join(_whole(1000.0 * one) for one in frame[:3, 3])})"


def _whole(figure: float) -> str:
    return f"{round(figure):d}"


def _tolerance() -> str:
    return f"{1000 * TOLERANCE_M:g} mm and {TOLERANCE_DEG:g}° may be"


# Kinds of arms by the names that makers and people give them.
_KINDS: Final = {
    "Franka Research 3": r"fr3|research.?3",
    "Franka Emika Panda": r"panda|emika|(^|_)fer(_|$)",
    "xArm 5": r"xarm.?5",
    "xArm 6": r"xarm.?6",
    "xArm 7": r"xarm.?7",
    "Lite 6": r"lite.?6",
    "850": r"(uf|^).?850",
    "SO-100": r"so.{0,5}100",
    "SO-101": r"so.{0,5}101",
    "Koch": r"koch",
    "OMX": r"omx",
}


def kind_of(name: str) -> str | None:
    """The kind that a name names, or None."""
    return next((kind for kind, said in _KINDS.items() if re.search(said, name, re.IGNORECASE)), None)


def kind_misfit(told: str, robot: Robot) -> tuple[str, ...]:
    """Why an arm that says what it is, is not this robot: a sentence, or nothing where one is not known."""
    theirs, ours = kind_of(told), kind_of(Path(robot.name).name)
    if theirs is None or ours is None or theirs == ours:
        return ()
    return (
        f"The arm says that its type is {theirs}, and {robot.name} is {ours} by its name: name the arm's own"
        " model with --robot, or a run that was trained for it.",
    )
