"""Limits acceleration and jerk."""

from typing import final

import numpy as np
from ruckig import ControlInterface, InputParameter, Result, Ruckig, RuckigError, Synchronization, Trajectory
from typing_extensions import override

from latentarm.core.types import FloatArray, Stop
from latentarm.safety.filter import SafetyFilter, Situation


@final
class Ramp(SafetyFilter):
    """Moves from the last command towards the requested one at limited acceleration and jerk.

    All joints arrive together: in proportion where the way is straight, so that no mix of old and new
    velocity moves any point faster than the faster of the two.

    ``dt_s`` is the loop's period; acceleration (n,), rad/s², and jerk (n,), rad/s³, are the limits.
    """

    name = "ramp"

    def __init__(self, dt_s: float, acceleration: FloatArray, jerk: FloatArray) -> None:
        dof = len(acceleration)
        self._dt_s = dt_s
        self._generator = Ruckig(dof)
        self._trajectory = Trajectory(dof)
        wanted = InputParameter(dof)
        wanted.control_interface = ControlInterface.Velocity
        wanted.synchronization = Synchronization.Phase
        wanted.max_acceleration = acceleration.tolist()
        wanted.max_jerk = jerk.tolist()
        self._wanted = wanted

    @override
    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray | Stop:
        ramped = self.ramped(velocity, situation.velocity, situation.acceleration)
        return ramped if isinstance(ramped, Stop) else ramped[0]

    def ramped(
        self, target: FloatArray, velocity: FloatArray, acceleration: FloatArray
    ) -> tuple[FloatArray, FloatArray] | Stop:
        """Velocity (n,), rad/s, and acceleration (n,), rad/s², one period later; a stop where no ramp exists.

        ``target`` is (n,), rad/s; ``velocity`` and ``acceleration`` are those of the last command.
        """
        wanted = self._wanted
        wanted.current_velocity = velocity.tolist()
        wanted.current_acceleration = acceleration.tolist()
        wanted.target_velocity = target.tolist()
        try:
            result = self._generator.calculate(wanted, self._trajectory)
        except RuckigError:
            # This happens during a stop, whose acceleration exceeds that of ordinary motion.
            result = Result.Error
        if result not in (Result.Working, Result.Finished):
            return Stop("No smooth path to the requested velocity was found.", code="no_smooth_path")
        _, velocities, accelerations = self._trajectory.at_time(self._dt_s)
        return np.array(velocities), np.array(accelerations)
