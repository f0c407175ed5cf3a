"""A process that drives a real arm until it is killed."""

import multiprocessing
import os
import signal
from multiprocessing.connection import Connection
from typing import Self, final

from latentarm.arms.catalogue import make_real_arm
from latentarm.control.clock import MonotonicClock
from latentarm.core.types import Command, FloatArray
from latentarm.robots.robot import Robot

_PERIOD_S = 0.01


@final
class Driving:
    """Another process that drives an arm at a velocity (n,), rad/s, by commands of ``hold_s``."""

    def __init__(self, address: str, robot: Robot, velocity: FloatArray, hold_s: float) -> None:
        context = multiprocessing.get_context("spawn")
        self._reading, writing = context.Pipe(duplex=False)
        arguments = (address, robot, velocity, hold_s, writing)
        self._process = context.Process(target=_drive, args=arguments, daemon=True)

    def __enter__(self) -> Self:
        self._process.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Kill it, if it still lives."""
        self.kill()

    @property
    def driving(self) -> bool:
        """Whether it has begun to send commands; EOFError where it has failed."""
        return self._reading.poll(0)

    def kill(self) -> None:
        """End it at once; it can do nothing any more."""
        if self._process.pid is not None and self._process.is_alive():
            os.kill(self._process.pid, signal.SIGKILL)
        self._process.join()


def _drive(address: str, robot: Robot, velocity: FloatArray, hold_s: float, told: Connection) -> None:
    clock = MonotonicClock()
    arm = make_real_arm(address, robot, clock.now_s)
    arm.connect()
    arm.enable()
    while not arm.status().takes_commands:
        clock.wait_until(clock.now_s() + _PERIOD_S)
    told.send_bytes(b"driving")
    while True:
        arm.send(Command(velocity, duration_s=hold_s))
        clock.wait_until(clock.now_s() + _PERIOD_S)
