"""An arm that answers over TCP, a line of JSON for every request: what the driver `wooden_arm` talks to.

As a program it serves until its standard input ends: ``python wooden_server.py [ROBOT]`` prints its port.
"""

import json
import socket
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import MonotonicClock
from latentarm.core.types import Command, FloatArray, GripperCommand
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.testing.faults import FaultyArm
from latentarm.testing.real_arms import StandIn


class WoodenServer(StandIn):
    """It moves kinematically, in real time, and serves one driver after the other."""

    def __init__(self, robot: Robot, state: FloatArray, firmware: str = "2.1") -> None:
        clock = MonotonicClock()
        self.robot = robot
        self.firmware = firmware
        self.requests: list[str] = []
        self._lock = threading.Lock()
        self._arm = FaultyArm(KinematicArm(robot, state, clock.now_s), clock.now_s)
        self._arm.connect()
        self._way = threading.Event()
        self._way.set()
        self._listening = socket.create_server(("127.0.0.1", 0))
        # Whatever else runs in this process may have set a timeout for all sockets.
        self._listening.settimeout(None)
        self.port = int(self._listening.getsockname()[1])
        self.guiding = False
        self.pause_s = 0.0  # how long it waits before each answer
        self.unreadable = False  # whether its joint positions are no numbers
        threading.Thread(target=self._serve, daemon=True).start()

    @property
    def address(self) -> str:
        return f"wooden://127.0.0.1:{self.port}"

    def close(self) -> None:
        self._listening.close()

    def positions(self) -> FloatArray:
        with self._lock:
            return self._arm.read().q.copy()

    def press_emergency_stop(self) -> None:
        with self._lock:
            self.guiding = False
            self._arm.press_emergency_stop()

    def release_emergency_stop(self) -> None:
        with self._lock:
            self._arm.release_emergency_stop()

    def break_down(self) -> None:
        with self._lock:
            self.guiding = False
            self._arm.break_down("The arm has hit something.", recoverable=True)

    def cut(self) -> None:
        self._way.clear()

    def repair(self) -> None:
        self._way.set()

    def push(self, by: FloatArray) -> None:
        """Somebody moves the arm by hand, where it lets them: (n,), rad."""
        if self.guiding:
            with self._lock:
                plant = self._arm.arm
                plant._state = np.clip(plant._state + by, self.robot.limits.lower, self.robot.limits.upper)

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._listening.accept()
            except OSError:
                return
            connection.settimeout(None)
            threading.Thread(target=self._talk, args=(connection,), daemon=True).start()

    def _talk(self, connection: socket.socket) -> None:
        lines = connection.makefile("rwb")
        try:
            for line in lines:
                if not self._way.is_set():
                    self._way.wait()  # what was on its way when the cable was cut is lost
                    continue
                request = json.loads(line)
                with self._lock:
                    self.requests.append(request["do"])
                    self._obey(request)
                    answer = self._state()
                time.sleep(self.pause_s)
                lines.write(json.dumps(answer).encode() + b"\n")
                lines.flush()
        except (OSError, ValueError):
            pass
        finally:
            with self._lock:
                self.guiding = False
                self._arm.disable()
            connection.close()

    def _obey(self, request: dict[str, Any]) -> None:
        arm = self._arm
        match request["do"]:
            case "enable" if not self.guiding:
                arm.enable()
            case "disable":
                self.guiding = False
                arm.disable()
            case "recover":
                arm.recover()
            case "stop":
                arm.stop()
            case "guide":
                self.guiding = arm.status().phase == "disabled"
            case "grip":
                arm.move_gripper(GripperCommand(*request["gripper"]))
            case "send":
                gripper = request["gripper"]
                arm.send(
                    Command(
                        np.array(request["velocity"]),
                        float(request["duration_s"]),
                        gripper=None if gripper is None else GripperCommand(*gripper),
                    )
                )
            case _:
                pass

    def _state(self) -> dict[str, Any]:
        reading, status = self._arm.read(), self._arm.status()
        gripper = reading.gripper
        return {
            "joints": list(self.robot.joint_names),
            "lower": self.robot.limits.lower.tolist(),
            "upper": self.robot.limits.upper.tolist(),
            "velocity": self.robot.limits.velocity.tolist(),
            "firmware": self.firmware,
            "q": [float("nan")] * self.robot.dof if self.unreadable else reading.q.tolist(),
            "dq": reading.dq.tolist(),
            "gripper": None if gripper is None else [gripper.width_m, gripper.holding],
            "phase": "guided" if self.guiding else status.phase,
            "reason": status.reason,
            "recoverable": status.recoverable,
        }


@contextmanager
def wooden_server(robot: Robot, firmware: str = "2.1") -> Iterator[WoodenServer]:
    server = WoodenServer(robot, robot.home, firmware)
    try:
        yield server
    finally:
        server.close()


if __name__ == "__main__":
    with wooden_server(load_robot(sys.argv[1] if len(sys.argv) > 1 else "panda")) as running:
        sys.stdout.write(f"{running.port}\n")
        sys.stdout.flush()
        sys.stdin.read()
