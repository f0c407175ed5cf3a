"""A gripper in MuJoCo: a position servo for each finger, with bounded speed and force.

Values in m are a finger's share of the opening, also where its joint turns.
"""

from collections import deque
from typing import Final, final

import mujoco
import numpy as np

from latentarm.arms.simulated_gripper import SimulatedGripper
from latentarm.core.types import FloatArray, GripperReading
from latentarm.robots.gripper import Gripper

FREQUENCY_RAD_S: Final = 300.0  # natural frequency of a free finger, critically damped
_STILL_M_S: Final = 0.002  # fingers slower than this count as stalled, m/s of the opening
_STALLED_M: Final = 3e-4  # fingers that stand this far before their servo's target press on something, m each
_STALLED_S: Final = 0.05  # fingers that have stalled for so long hold something, s
_LEAST_N: Final = 0.2  # fingers that may not press this hard hold nothing, N


@final
class FingerServo(SimulatedGripper):
    """Runs the servos of `add_finger_servos`.

    The servo's target goes to the commanded width at the commanded speed. Where the fingers meet something it
    stays so far ahead of them that each finger presses with the commanded force, and never more. Held things
    stay held when commands end, when the arm stops, and when it is disabled.

    A gripper reports that it holds something once it has stood still before the commanded width for 50 ms
    while both servos press, and as long as they press. Fingers that meet have nothing between them.
    Measurements are ``delay_s`` old. Servos of further fingers follow ``first_actuator``.
    """

    def __init__(
        self,
        gripper: Gripper,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        first_actuator: int,
        delay_s: float,
    ) -> None:
        super().__init__(gripper)
        self._model, self._data, self._delay_s = model, data, delay_s
        joints = np.array([model.joint(name).id for name in gripper.joints])
        self._positions, self._speeds = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        self._servos = slice(first_actuator, first_actuator + len(joints))
        self._closed, self._per_m = np.array(gripper.closed), gripper.per_m
        # Of a finger's share of the opening, N/m.
        self._stiffness = float(model.actuator_gainprm[first_actuator, 0]) * self._per_m**2
        self._goal = self._target = gripper.width_m / len(joints)
        self._per_step = 0.0
        data.qpos[self._positions] = self._closed + self._per_m * self._target
        data.ctrl[self._servos] = data.qpos[self._positions]
        self._lead = self._moved_s = 0.0
        self._holding = False
        self._press(gripper.force_n)
        self._measured: deque[tuple[float, GripperReading]] = deque()
        self.note()

    def prepare(self) -> bool:
        """Set the servos for the next time step; returns whether the step after needs that again."""
        # Plain numbers: NumPy takes several times as long for so few, and this runs in every time step.
        where = self._shares()
        pressing = self._pressing(where)
        if not (pressing and self._still()):
            self._moved_s = self._data.time
        # Shaking does not end a hold; fingers that no longer press do.
        self._holding = pressing and (self._holding or self._data.time - self._moved_s >= _STALLED_S)
        if self._target == self._goal:
            return False
        way = min(max(self._goal - self._target, -self._per_step), self._per_step)
        # Fingers that are held must not wind their servos up, or they would leap once they are free.
        self._target = min(max(self._target + way, max(where) - self._lead), min(where) + self._lead)
        self._data.ctrl[self._servos] = self._closed + self._per_m * self._target
        return True

    def note(self) -> None:
        """Store the present measurement until its delay has passed."""
        time_s, where = float(self._data.time), self._shares()
        self._measured.append((time_s, GripperReading(sum(where), self._holding)))
        while len(self._measured) > 1 and time_s - self._measured[1][0] >= self._delay_s - 1e-9:
            self._measured.popleft()

    def measure(self) -> GripperReading:
        return self._measured[0][1]

    def halt(self) -> None:
        """Stay at the present opening. Fingers that do not hold anything yet press no more."""
        where = self._shares()
        if self._per_step > 0.0 and not self._holding:
            self._target = sum(where) / len(where)
            self._data.ctrl[self._servos] = self._closed + self._per_m * self._target
        # Once: where fingers give way later, they press back.
        self._goal, self._per_step = self._target, 0.0

    def _aim(self, width_m: float, speed_m_s: float, force_n: float) -> None:
        fingers = len(self._closed)
        self._goal = width_m / fingers
        self._per_step = speed_m_s / fingers * float(self._model.opt.timestep)
        self._press(force_n)

    def _press(self, force_n: float) -> None:
        self._lead = force_n / self._stiffness
        torque = force_n / self._per_m
        self._model.actuator_forcerange[self._servos] = -torque, torque

    def _shares(self) -> list[float]:
        """Opening of each finger, m."""
        return ((self._data.qpos[self._positions] - self._closed) / self._per_m).tolist()

    def _pressing(self, where: list[float]) -> bool:
        """True if something keeps fingers at these positions, m, from their servos' target."""
        enough = max(min(_STALLED_M, 0.5 * self._lead), 0.5 * _LEAST_N / self._stiffness)
        return min(where) - self._target > enough

    def _still(self) -> bool:
        return abs(sum(self._data.qvel[self._speeds].tolist()) / self._per_m) < _STILL_M_S


def add_finger_servos(spec: mujoco.MjSpec, gripper: Gripper, moved_kg: FloatArray) -> None:
    """Add a position servo to each finger; ``moved_kg`` is each joint's load, kg (kg m² where it turns)."""
    for name, mass in zip(gripper.joints, moved_kg, strict=True):
        stiffness = FREQUENCY_RAD_S**2 * mass
        servo = spec.add_actuator(
            name=f"{name} position",
            target=name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            forcelimited=True,
            forcerange=[-gripper.force_n / gripper.per_m, gripper.force_n / gripper.per_m],
        )
        servo.gaintype, servo.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
        servo.gainprm[0] = stiffness
        servo.biasprm[1], servo.biasprm[2] = -stiffness, -2.0 * FREQUENCY_RAD_S * mass
