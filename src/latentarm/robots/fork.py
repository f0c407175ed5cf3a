"""A fork in a robot's hand."""

from dataclasses import replace
from typing import Final

import mujoco
import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.assemble import assemble
from latentarm.robots.fixing import fix_slides
from latentarm.robots.kinematics.reader import reference_positions
from latentarm.robots.parts import add_parts
from latentarm.robots.robot import Robot
from latentarm.robots.scene.thing import Part
from latentarm.robots.tines import HANDLE_BODY, TINES_BODY, Tines

_TOOL: Final = "tool"
_STEEL: Final = (0.75, 0.77, 0.80, 1.0)
_REACH_M: Final = 0.11  # from the hand's frame to the tips
_HANDLE_HALF_M: Final = 0.006  # half its thickness
_BEHIND_M: Final = 0.015  # how far the handle reaches back past the middle of the fingertips
_HANDLE_KG: Final = 0.04
_TINES_KG: Final = 0.01
_TINE_LENGTH_M: Final = 0.045
_TINE_RADIUS_M: Final = 0.0015
_TINE_YS: Final = (-0.0105, -0.0035, 0.0035, 0.0105)
_EDGE_HALF_M: Final = _TINE_YS[-1] + _TINE_RADIUS_M


def with_fork(robot: Robot) -> Robot:
    """The robot with a fork in its hand.

    The hand is the end-effector, whose z axis points away from the arm. A gripper is closed about the handle
    and stays so: the robot has none to command. The fork becomes part of the last link, with its mass, its
    inertia and its shell. The first tool of the chain is then named "tool". It is turned as the hand is, and
    lies on the hand's z axis between the tips of the tines, with z along them and y across them, along the
    cutting edge.

    Raises UserError where the robot holds one already.
    """
    if robot.tines is not None:
        raise UserError(f"The robot {robot.name} holds its fork already.")
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    home = _home(robot)
    if robot.gripper is not None:
        opening = min(_HANDLE_HALF_M, robot.gripper.width_m / 2.0)
        home = {name: at for name, at in home.items() if name not in robot.gripper.joints}
        fix_slides(spec, dict.fromkeys(robot.gripper.joints, opening))
    for key in spec.keys:
        spec.delete(key)
    _hang(spec, robot)
    model = spec.compile()
    qpos = np.array(model.qpos0)
    for name, at in home.items():
        first = int(model.joint(name).qposadr[0])
        qpos[first : first + len(at)] = at
    spec.add_key(name="home", qpos=list(qpos))
    spec.compile()
    name = f"{robot.name}_fork"
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
        tines=Tines(np.array([[0.0, y, 0.0] for y in _TINE_YS]), _TINE_LENGTH_M, _EDGE_HALF_M),
    )
    return replace(made, stated_limits=robot.stated_limits)


def _home(robot: Robot) -> dict[str, FloatArray]:
    model = robot.model()
    at = reference_positions(model)
    ends = np.append(model.jnt_qposadr, model.nq)
    return {model.joint(i).name: at[ends[i] : ends[i + 1]] for i in range(model.njnt)}


def _hang(spec: mujoco.MjSpec, robot: Robot) -> None:
    hand = robot.chain.tools[0].name
    site = spec.site(hand)
    if site is None:
        parent, place, turn = spec.body(hand), np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0])
    else:
        parent, place, turn = site.parent, np.array(site.pos), np.array(site.quat)
        if hand == _TOOL:
            spec.delete(site)
    reach = np.empty(3)
    mujoco.mju_rotVecQuat(reach, np.array([0.0, 0.0, _REACH_M]), turn)
    body = parent.add_body(name=HANDLE_BODY, pos=list(place + reach), quat=list(turn))
    add_parts(body, _handle(), _HANDLE_KG)
    body.add_site(name=_TOOL, size=[0.003, 0.003, 0.003])
    size = (_TINE_RADIUS_M, _TINE_LENGTH_M / 2.0 - _TINE_RADIUS_M)
    middle = -_TINE_LENGTH_M / 2.0
    tines = [Part("capsule", size, (0.0, y, middle), colour=_STEEL) for y in _TINE_YS]
    add_parts(body.add_body(name=TINES_BODY), tines, _TINES_KG)


def _handle() -> tuple[Part, Part]:
    """A stick from behind the hand's frame, and the bar that carries the tines."""
    start, end = -_REACH_M - _BEHIND_M, -_TINE_LENGTH_M - 0.012
    size = (_HANDLE_HALF_M, (end - start) / 2.0)
    stick = Part("capsule", size, (0.0, 0.0, (end + start) / 2.0), colour=_STEEL)
    bar = Part("box", (0.002, _EDGE_HALF_M, 0.006), (0.0, 0.0, -_TINE_LENGTH_M - 0.006), colour=_STEEL)
    return stick, bar
