"""Fixes joints of a model where they are."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from latentarm.robots.robot import Robot

if TYPE_CHECKING:
    import mujoco


def arm_model(robot: Robot) -> "mujoco.MjModel":
    """The model with the arm's joints alone; the gripper's fingers stay where the model has them."""
    import mujoco

    from latentarm.robots.kinematics.reader import reference_positions

    fingers = () if robot.gripper is None else robot.gripper.slides
    if not fingers:
        return robot.model()
    model = robot.model()
    at = reference_positions(model)
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    fix_slides(spec, {name: float(at[model.joint(name).qposadr[0]]) for name in fingers})
    return spec.compile()


def fix_slides(spec: "mujoco.MjSpec", positions: Mapping[str, float]) -> None:
    """Remove sliding joints from a model, with their couplings, and its key frames, at positions in m."""
    import mujoco

    for key in spec.keys:
        spec.delete(key)
    for one in spec.equalities:
        if one.type == mujoco.mjtEq.mjEQ_JOINT and {one.name1, one.name2} & set(positions):
            spec.delete(one)
    for actuator in spec.actuators:
        if actuator.target in positions:
            spec.delete(actuator)
    for name, position in positions.items():
        joint = spec.joint(name)
        body = joint.parent
        turned = np.empty(3)
        mujoco.mju_rotVecQuat(turned, np.asarray(joint.axis, dtype=np.float64), body.quat)
        body.pos = body.pos + position * turned
        spec.delete(joint)
