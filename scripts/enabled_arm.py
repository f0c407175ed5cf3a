"""A simulated arm that is connected, read until its first late reading is there, and enabled."""

import numpy as np

from latentarm.arms.kinematic import KinematicArm
from latentarm.arms.mujoco import MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import Input


def enabled(
    arm: KinematicArm | MujocoArm, step: Step, clock: SimulatedClock, late_ticks: int, inputs: int = 1
) -> int:
    """Connect an arm, let it stand, and enable it.

    Args:
        arm: not connected yet.
        step: drives it.
        clock: at zero.
        late_ticks: how old its readings are, ticks of the step.
        inputs: how many numbers an input of the step has.

    Returns:
        The first tick in which it may move.

    Raises:
        RuntimeError: it cannot be enabled.
    """
    arm.connect()
    for tick in range(late_ticks + 2):
        clock.wait_until(step.dt_s * tick)
        reading = arm.read()
        if tick == 0:
            step.reset(reading.q)
        step(Input(np.zeros(inputs)), 0.0, reading, clock.now_s())
    arm.enable()
    if (refused := step.enable()) is not None:
        raise RuntimeError(f"the arm could not be enabled: {refused.reason}")
    return late_ticks + 2
