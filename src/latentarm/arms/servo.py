"""Velocity servos for the joints of a MuJoCo model, in place of its actuators."""

from collections.abc import Sequence
from typing import Final, final

import mujoco
import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, IntArray
from latentarm.robots.kinematics.reader import reference_positions
from latentarm.robots.robot import Robot

FREQUENCY_RAD_S: Final = 100.0  # natural frequency of a free joint, critically damped
_JOINT: Final = int(mujoco.mjtTrn.mjTRN_JOINT)
_NO_BIAS: Final = int(mujoco.mjtBias.mjBIAS_NONE)


@final
class Servo:
    """Runs the servos of `add_servos`.

    The model has the servos that hold positions first, then those that hold velocities. ``quickening`` (n,)
    is the largest change of a joint's velocity in a time step, rad/s.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, joints: IntArray, quickening: FloatArray
    ) -> None:
        self._n = len(joints)
        self._positions = model.jnt_qposadr[joints]
        self._quickening = quickening
        self._velocity = np.zeros(self._n)
        stiffness = model.actuator_gainprm[: self._n, 0]
        self._farthest = model.jnt_actfrcrange[joints, 1] / stiffness
        self._qpos, self._act = data.qpos, data.act[: self._n]
        self._ctrl = data.ctrl[: 2 * self._n].reshape(2, self._n)
        self._act[:] = self._qpos[self._positions]

    def prepare(self, commanded: FloatArray) -> bool:
        """Set the servos to velocities (n,), rad/s; returns whether the step after needs that again."""
        changes = bool((self._velocity != commanded).any())
        if changes:
            change = np.clip(commanded - self._velocity, -self._quickening, self._quickening)
            self._velocity = np.where(
                np.abs(commanded - self._velocity) <= self._quickening, commanded, self._velocity + change
            )
        self._ctrl[:] = self._velocity
        return changes

    def unwind(self) -> None:
        """After a time step: a blocked joint must not wind its servo up, or it would leap once free."""
        q = self._qpos[self._positions]
        np.maximum(self._act, q - self._farthest, out=self._act)
        np.minimum(self._act, q + self._farthest, out=self._act)


def torque_limits(model: mujoco.MjModel, joints: IntArray, robot: Robot) -> FloatArray:
    """(n,), largest torque of each joint, N m (N where it slides): its own, or else its actuators'."""
    limits = np.zeros(len(joints))
    for index, joint in enumerate(joints):
        if model.jnt_actfrclimited[joint]:
            limits[index] = np.abs(model.jnt_actfrcrange[joint]).min()
        else:
            limits[index] = sum(
                _strength(model, actuator)
                for actuator in range(model.nu)
                if model.actuator_trntype[actuator] == _JOINT and model.actuator_trnid[actuator, 0] == joint
            )
        if not limits[index] > 0.0:
            raise UserError(
                f"The model of {robot.name} states no torque limit for joint {robot.joint_names[index]!r}:"
                " give the joint an actuatorfrcrange, or an actuator with a forcerange."
            )
    return limits


def _strength(model: mujoco.MjModel, actuator: int) -> float:
    """The largest force of an actuator on its joint; 0 where there is no limit."""
    gear = abs(float(model.actuator_gear[actuator, 0]))
    if model.actuator_forcelimited[actuator]:
        return gear * float(np.abs(model.actuator_forcerange[actuator]).min())
    if model.actuator_ctrllimited[actuator] and model.actuator_biastype[actuator] == _NO_BIAS:
        gain = abs(float(model.actuator_gainprm[actuator, 0]))
        return gear * gain * float(np.abs(model.actuator_ctrlrange[actuator]).min())
    return 0.0


def drop_actuators(spec: mujoco.MjSpec) -> None:
    """Remove the model's actuators, and references to them."""
    for part in (*spec.sensors, *spec.keys, *spec.actuators):
        spec.delete(part)


def hold_still_joints(
    spec: mujoco.MjSpec, model: mujoco.MjModel, joints: IntArray, fingers: Sequence[str]
) -> None:
    """Hold every hinge and slide that nothing drives at the model's start."""
    held = reference_positions(model)
    driven = {int(joint) for joint in joints}
    following = {int(model.eq_obj1id[i]) for i in range(model.neq) if model.eq_active0[i]}
    for joint in spec.joints:
        if joint.type not in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
            continue
        if joint.id in driven or joint.id in following or joint.name in fingers:
            continue
        joint.name = joint.name or f"joint{joint.id}"
        at = int(model.jnt_qposadr[joint.id])
        spec.add_equality(
            type=mujoco.mjtEq.mjEQ_JOINT,
            name1=joint.name,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            data=[held[at] - model.qpos0[at], *([0.0] * (mujoco.mjNEQDATA - 1))],
        )


def add_servos(
    spec: mujoco.MjSpec, model: mujoco.MjModel, joints: IntArray, torque: FloatArray, inertia: FloatArray
) -> None:
    """Add two servos to each joint: for the velocity's integral, and for the velocity itself.

    ``torque`` (n,), N m, bounds both together and gravity compensation; ``inertia`` (n,) is each joint's
    load, kg m².
    """
    of = {joint.id: joint for joint in spec.joints}
    stiffness = FREQUENCY_RAD_S**2 * inertia
    damping = 2.0 * FREQUENCY_RAD_S * inertia
    for index, joint in enumerate(int(joint) for joint in joints):
        of[joint].name = of[joint].name or f"joint{joint}"
        of[joint].actfrclimited = True
        of[joint].actfrcrange = [-torque[index], torque[index]]
        of[joint].actgravcomp = True
    for gain, kind in ((stiffness, "integral"), (damping, "velocity")):
        for index, joint in enumerate(int(joint) for joint in joints):
            servo = spec.add_actuator(
                name=f"{of[joint].name} {kind}", target=of[joint].name, trntype=mujoco.mjtTrn.mjTRN_JOINT
            )
            servo.gaintype, servo.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
            servo.gainprm[0] = gain[index]
            if kind == "integral":
                servo.dyntype, servo.actdim = mujoco.mjtDyn.mjDYN_INTEGRATOR, 1
                servo.biasprm[1] = -gain[index]
            else:
                servo.biasprm[2] = -gain[index]
