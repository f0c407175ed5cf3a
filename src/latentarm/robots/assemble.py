"""Makes a `Robot` of a MuJoCo model."""

from collections.abc import Sequence
from dataclasses import replace

import mujoco
import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, FloatArray, StatedGripper, StatedLimits
from latentarm.robots.end_effector import arm_joints, finger_joints
from latentarm.robots.gripper import Gripper
from latentarm.robots.kinematics.chain import Capsules
from latentarm.robots.kinematics.reader import ModelChain, read
from latentarm.robots.limits import JointLimits, Source
from latentarm.robots.limits_file import with_stated
from latentarm.robots.robot import Robot
from latentarm.robots.shapes import body_name, read_capsules, self_pairs
from latentarm.robots.tines import HANDLE_BODY, TINES_BODY, Tines


def assemble(
    name: str,
    mjcf: str,
    end_effectors: Sequence[str],
    limits: JointLimits,
    home: FloatArray,
    tool_speed_limit: float,
    model_path: str | None = None,
    model: mujoco.MjModel | None = None,
    tool_speed_source: Source = "assumed",
    gripper: Gripper | None = None,
    tines: Tines | None = None,
) -> Robot:
    """Read a robot's kinematics and shape from its model, and add what the model lacks.

    ``mjcf`` is the model's text, from which the chain is read, so that the two agree to rounding.
    ``end_effectors`` are sites or bodies, the tool first; ``home`` is (n,), rad; ``tool_speed_limit`` is in
    m/s. Pass ``model`` if it is compiled already: large meshes take seconds.
    """
    if model is None:
        model = mujoco.MjModel.from_xml_string(mjcf)
    reading = read(model, end_effectors)
    sliding = () if gripper is None else gripper.joints
    capsules = read_capsules(model, reading, sliding, () if tines is None else (HANDLE_BODY, TINES_BODY))
    joints = frozenset(int(joint) for joint in reading.joints)
    return Robot(
        name=name,
        chain=reading.chain,
        limits=limits,
        home=home,
        capsules=capsules,
        self_pairs=self_pairs(reading.chain, capsules, limits, home, _excluded(model, capsules)),
        mjcf=mjcf,
        still_joints=_names(model, arm_joints(model) - joints),
        driven_fingers=_names(model, finger_joints(model) & joints),
        tool_speed_limit=tool_speed_limit,
        tool_speed_source=tool_speed_source,
        model_path=model_path,
        gripper=gripper,
        tines=tines,
        tuck=_tuck(model, reading, limits),
        home_stated=model_path is None or mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home") >= 0,
    )


def restate(robot: Robot, stated: StatedLimits) -> Robot:
    """The robot with stated limits in place of known or assumed ones."""
    chain = robot.chain
    limits = with_stated(robot.limits, stated, chain.joint_names, chain.slide.tolist())
    home = robot.home
    if limits.violation(home).any():
        home = np.clip(home, limits.lower, limits.upper)
    tool_speed, source = robot.tool_speed_limit, robot.tool_speed_source
    if stated.tool_speed is not None:
        tool_speed, source = stated.tool_speed, "limits_file"
    names = [tool.name for tool in chain.tools]
    # Recomputed, because the joint ranges decide which capsules can touch.
    anew = assemble(
        robot.name,
        robot.mjcf,
        names,
        limits,
        home,
        tool_speed,
        robot.model_path,
        tool_speed_source=source,
        gripper=robot.gripper if stated.gripper is None else _stated_gripper(robot, stated.gripper),
        tines=robot.tines,
    )
    return replace(anew, stated_limits=stated)


def _stated_gripper(robot: Robot, stated: StatedGripper) -> Gripper:
    model = robot.model()
    travel: list[tuple[float, float]] = []
    for name in stated.joints:
        joint = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
        if joint < 0:
            raise UserError(f"The limits file names the gripper's joint {name!r}, which {robot.name} lacks.")
        if name in robot.joint_names:
            raise UserError(
                f"The gripper's joint {name!r} is driven as one of the arm's: name an end-effector before it."
            )
        if not model.jnt_limited[joint]:
            raise UserError(f"The gripper's joint {name!r} of {robot.name} has no range in the model.")
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
            low, high = model.jnt_range[joint]
            travel.append((float(low), float(high)))
    if travel and len(travel) < len(stated.joints):
        raise UserError(f"The gripper of {robot.name} has joints that slide and joints that turn.")
    return Gripper(stated.joints, stated.width, stated.speed, stated.force, tuple(travel))


def _tuck(model: mujoco.MjModel, reading: ModelChain, limits: JointLimits) -> FloatArray | None:
    """Key frame "tuck", (n,), rad, or None where the model has none within the limits."""
    key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "tuck")
    if key < 0:
        return None
    found = np.array(model.key_qpos[key][model.jnt_qposadr[reading.joints]])
    return None if limits.violation(found).any() else found


def _names(model: mujoco.MjModel, joints: frozenset[int]) -> tuple[str, ...]:
    return tuple(str(model.joint(joint).name) or f"joint{joint}" for joint in sorted(joints))


def _excluded(model: mujoco.MjModel, capsules: Capsules) -> BoolArray:
    """(K, K), pairs of capsules whose bodies the model's <exclude> elements name.

    Other capsules on the same links are still checked: a hand may hit a forearm that the flange cannot
    reach. So is a capsule shared by several bodies, which carries none of their names.
    """
    excluded = np.zeros((len(capsules), len(capsules)), dtype=np.bool_)
    names = np.array(capsules.name)
    for signature in model.exclude_signature:
        first, second = (names == body_name(model, int(one)) for one in (signature >> 16, signature & 0xFFFF))
        excluded |= np.outer(first, second) | np.outer(second, first)
    return excluded
