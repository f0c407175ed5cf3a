"""A fork, a spoon or a cup in a robot's hand."""

from dataclasses import dataclass, replace
from typing import Final, final

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.assemble import assemble
from latentarm.robots.attachment import ATTACHMENT_BODY, TINES_BODY, Attachment, Tines, Vessel
from latentarm.robots.fixing import fix_slides
from latentarm.robots.kinematics.reader import reference_positions
from latentarm.robots.parts import add_parts
from latentarm.robots.robot import Robot
from latentarm.robots.scene.containers import WALL_M, cup
from latentarm.robots.scene.thing import Part

HANDLE_HALF_M: Final = 0.006  # half the thickness of every handle
_TOOL: Final = "tool"
_STEEL: Final = (0.75, 0.77, 0.80, 1.0)
_BEHIND_M: Final = 0.015  # how far a handle reaches back past the middle of the fingertips
_TINE_LENGTH_M: Final = 0.045
_TINE_RADIUS_M: Final = 0.0015
_TINE_YS: Final = (-0.0105, -0.0035, 0.0035, 0.0105)
_FORK_REACH_M: Final = 0.11
_SPOON_REACH_M: Final = 0.10
_SPOON_HALF: Final = (0.005, 0.014, 0.020)  # of the bowl's outside: depth, width, length, m
_SPOON_WALL_M: Final = 0.0015
_CUP_REACH_M: Final = 0.06
_CUP: Final = cup()


@final
@dataclass(frozen=True, eq=False)
class _Kind:
    what: Attachment
    reach_m: float
    parts: tuple[Part, ...]
    mass_kg: float
    tines: tuple[Part, ...] = ()
    tines_kg: float = 0.0


def _handle(reach_m: float, to_m: float) -> Part:
    """From behind the hand's frame to a place on z of the tool's frame."""
    start, end = -reach_m - _BEHIND_M, to_m
    return Part(
        "capsule", (HANDLE_HALF_M, (end - start) / 2.0), (0.0, 0.0, (end + start) / 2.0), colour=_STEEL
    )


def _fork() -> _Kind:
    root = -_TINE_LENGTH_M
    half = _TINE_YS[-1] + _TINE_RADIUS_M
    bar = Part("box", (0.002, half, 0.006), (0.0, 0.0, root - 0.006), colour=_STEEL)
    size = (_TINE_RADIUS_M, _TINE_LENGTH_M / 2.0 - _TINE_RADIUS_M)
    tines = tuple(Part("capsule", size, (0.0, y, root / 2.0), colour=_STEEL) for y in _TINE_YS)
    tips = np.array([[0.0, y, 0.0] for y in _TINE_YS])
    what = Attachment("fork", Tines(tips, _TINE_LENGTH_M, half))
    return _Kind(what, _FORK_REACH_M, (_handle(_FORK_REACH_M, root - 0.012), bar), 0.04, tines, 0.01)


def _spoon() -> _Kind:
    depth, width, length = _SPOON_HALF
    wall = _SPOON_WALL_M
    floor = Part("box", (wall, width, length), (wall - depth, 0.0, 0.0), colour=_STEEL)
    sides = [
        Part("box", (depth, wall, length), (0.0, sign * (width - wall), 0.0), colour=_STEEL)
        for sign in (-1.0, 1.0)
    ]
    ends = [
        Part("box", (depth, width, wall), (0.0, 0.0, sign * (length - wall)), colour=_STEEL)
        for sign in (-1.0, 1.0)
    ]
    parts = (_handle(_SPOON_REACH_M, -length - HANDLE_HALF_M / 2.0), floor, *sides, *ends)
    return _Kind(Attachment("spoon"), _SPOON_REACH_M, parts, 0.05)


def _cup() -> _Kind:
    middle = (_CUP.interior.top_m + _CUP.interior.bottom_m) / 2.0
    upright = Rotation.from_euler("Y", np.pi / 2.0)  # z of the cup is x of the tool
    frame = np.eye(4)
    frame[:3, :3] = upright.as_matrix()
    frame[:3, 3] = frame[:3, :3] @ [0.0, 0.0, -middle]
    parts: list[Part] = []
    for part in _CUP.parts:
        x, y, z = (float(one) for one in frame[:3, :3] @ part.position + frame[:3, 3])
        turned = upright * Rotation.from_quat(part.quaternion, scalar_first=True)
        w, i, j, k = (float(one) for one in turned.as_quat(scalar_first=True))
        parts.append(replace(part, position=(x, y, z), quaternion=(w, i, j, k)))
    wall = -_CUP.interior.radius_m - WALL_M - HANDLE_HALF_M
    what = Attachment("cup", vessel=Vessel(frame, _CUP.interior))
    return _Kind(what, _CUP_REACH_M, (_handle(_CUP_REACH_M, wall), *parts), 0.15)


ATTACHMENTS: Final = {"fork": _fork, "spoon": _spoon, "cup": _cup}  # for `attach`


def attach(robot: Robot, attachment: str) -> Robot:
    """The robot with an attachment in its hand: a name in `ATTACHMENTS`.

    The hand is the end-effector, whose z axis points away from the arm. A gripper is closed about the handle
    and stays so: the robot has none to command. The attachment becomes part of the last link, with its mass,
    its inertia and its shell. The first tool of the chain is then named "tool". It is turned as the hand is,
    and lies on the hand's z axis: for a *fork* between the tips of the tines, with z along them and y across
    them, along the cutting edge; for a *spoon* in the middle of its bowl, which opens along x; for a *cup* in
    the middle of its room, which opens along x, so that it stands upright when the Panda's hand points
    straight away.

    Raises UserError where there is no such attachment, or the robot has one already.
    """
    if attachment not in ATTACHMENTS:
        raise UserError(f"There is no attachment {attachment!r}: use one of {', '.join(ATTACHMENTS)}.")
    if robot.attachment is not None:
        raise UserError(f"The robot {robot.name} holds its {robot.attachment.name} already.")
    kind = ATTACHMENTS[attachment]()
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    home = _home(robot)
    if robot.gripper is not None:
        opening = min(HANDLE_HALF_M, robot.gripper.width_m / 2.0)
        home = {name: at for name, at in home.items() if name not in robot.gripper.joints}
        fix_slides(spec, dict.fromkeys(robot.gripper.joints, opening))
    for key in spec.keys:
        spec.delete(key)
    _hang(spec, robot, kind)
    model = spec.compile()
    qpos = np.array(model.qpos0)
    for name, at in home.items():
        first = int(model.joint(name).qposadr[0])
        qpos[first : first + len(at)] = at
    spec.add_key(name="home", qpos=list(qpos))
    spec.compile()
    name = f"{robot.name}_{attachment}"
    spec.modelname = name
    made = assemble(
        name,
        spec.to_xml(),
        [_TOOL, *(tool.name for tool in robot.chain.tools[1:])],
        robot.limits,
        robot.home,
        robot.tool_speed_limit,
        robot.model_path,
        tool_speed_source=robot.tool_speed_source,
        attachment=kind.what,
    )
    return replace(made, stated_limits=robot.stated_limits)


def _home(robot: Robot) -> dict[str, FloatArray]:
    model = robot.model()
    at = reference_positions(model)
    ends = np.append(model.jnt_qposadr, model.nq)
    return {model.joint(i).name: at[ends[i] : ends[i + 1]] for i in range(model.njnt)}


def _hang(spec: mujoco.MjSpec, robot: Robot, kind: _Kind) -> None:
    hand = robot.chain.tools[0].name
    site = spec.site(hand)
    if site is None:
        parent, place, turn = spec.body(hand), np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
    else:
        parent, place, turn = site.parent, np.array(site.pos), np.array(site.quat)
        if hand == _TOOL:
            spec.delete(site)
    reach = np.empty(3)
    mujoco.mju_rotVecQuat(reach, np.array([0.0, 0.0, kind.reach_m]), turn)
    body = parent.add_body(name=ATTACHMENT_BODY, pos=list(place + reach), quat=list(turn))
    add_parts(body, kind.parts, kind.mass_kg)
    body.add_site(name=_TOOL, size=[0.003, 0.003, 0.003])
    if kind.tines:
        add_parts(body.add_body(name=TINES_BODY), kind.tines, kind.tines_kg)
