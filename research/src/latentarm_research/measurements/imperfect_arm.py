"""An arm in physics as filters do not know it: payload, noise, late readings; and how it is enabled."""

from typing import Final

import numpy as np

from latentarm.arms.kinematic import KinematicArm
from latentarm.arms.mujoco import Imperfections, MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import Input

PERIOD_S: Final = 0.01
LATE_TICKS: Final = (0, 1, 2, 3)
PAYLOAD_KG: Final = 1.0
POSITION_NOISE_RAD: Final = 1e-4
VELOCITY_NOISE_RAD_S: Final = 1e-3


def imperfect(late_ticks: int, rng: np.random.Generator) -> Imperfections:
    """An arm with a payload, and noise on readings that are so many ticks late."""
    return Imperfections(
        position_noise_rad=POSITION_NOISE_RAD,
        velocity_noise_rad_s=VELOCITY_NOISE_RAD_S,
        delay_s=PERIOD_S * late_ticks,
        payload_kg=PAYLOAD_KG,
        seed=int(rng.integers(2**31)),
    )


def enabled(
    arm: KinematicArm | MujocoArm,  # not connected yet
    step: Step,
    clock: SimulatedClock,
    late_ticks: int,  # how old its readings are, ticks of the step
    inputs: int = 1,
) -> int:
    """Connect an arm, read it until its first late reading is there, enable it; the tick it may move from."""
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
