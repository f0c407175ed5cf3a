"""Your own input device: anything that yields (x, y) pairs drives the arm; it stops when they cease."""

from collections.abc import Iterator
from typing import final

import numpy as np

import latentarm as la


@final
class Device(la.InputSource):
    """Takes the next pair of an iterator in every period of the loop."""

    def __init__(self, pairs: Iterator[tuple[float, float]]) -> None:
        self._pairs = pairs
        self._newest, self._since_s = la.Input(np.zeros(2)), 0.0

    def latest(self, now_s: float) -> tuple[la.Input, float]:
        """The newest input and its age, s."""
        pair = next(self._pairs, None)
        if pair is not None:
            self._newest, self._since_s = la.Input(np.array(pair)), now_s
        return self._newest, now_s - self._since_s


robot = la.load_robot("panda")
clock = la.SimulatedClock()
step = la.Step(robot, la.EndEffectorController(robot), la.SafetyConfig())
joystick = iter([(0.0, 0.0)] * 5 + [(1.0, 0.0)] * 100)  # your device here
with la.make_arm("kinematic", robot, robot.home, clock.now_s) as arm:
    loop = la.ControlLoop(step, arm, Device(joystick), clock)
    loop.enable()
    loop.run(ticks=150)
    print(f"The tool is at {np.round(robot.chain.forward(arm.read().q).position, 2)} m.")
print(f"Why it stopped: {step.stopped.reason if step.stopped else 'it did not'}")
