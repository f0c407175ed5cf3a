"""The driver of the wooden arm: a thread talks to it, so that no call ever waits."""

import json
import math
import socket
import threading
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from latentarm.arms.address import ArmAddress
from latentarm.arms.contract import ArmSpec, ArmStatus
from latentarm.arms.real import Fact, Findings, FoundLimits, GuidableArm
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand, GripperReading, Reading
from latentarm.robots.robot import Robot

PERIOD_S = 0.005
OPENING_S = 10.0
"""How long the arm may take to answer at first, s: nothing moves yet, and a busy machine is no fault."""
TIMEOUT_S = 0.5
"""How long it may take from then on, s."""
LOST = "The connection to the arm is lost: check its cable, and connect again."


class WoodenArm(GuidableArm):
    def __init__(self, robot: Robot, address: ArmAddress, now_s: Callable[[], float]) -> None:
        options = address.only("rate", "stops_after")
        self._where = (address.host, address.port or 7000)
        self._spec = ArmSpec(
            robot.joint_names,
            rate_hz=float(options.get("rate", "200")),
            stops_after_s=float(options.get("stops_after", "0.02")),
            simulated=False,
            gripper=robot.gripper,
        )
        self._now_s = now_s
        self._lock = threading.Lock()
        self._todo: deque[dict[str, Any]] = deque()
        self._status = ArmStatus("off", "The arm is not connected.")
        self._newest: Reading | None = None
        self._thread: threading.Thread | None = None
        self._ending = threading.Event()
        self._first = "disable"

    @property
    def spec(self) -> ArmSpec:
        return self._spec

    def look(self) -> Findings:
        began_s = self._now_s()
        lines, state = self._open()
        lines.close()
        refusals = self._refusals(state)
        facts = (
            Fact("firmware", state["firmware"]),
            Fact("joints", str(len(state["q"]))),
            Fact("round trip", f"{1000 * (self._now_s() - began_s):.1f} ms"),
        )
        limits = FoundLimits(*(np.array(state[name]) for name in ("lower", "upper", "velocity")))
        return Findings(facts, refusals, limits)

    def connect(self) -> None:
        self._begin("disable")

    def watch(self) -> None:
        self._begin("read")

    def _begin(self, first: str) -> None:
        self.close()
        lines, state = self._open()
        self._first = first
        try:
            for sentence in self._refusals(state):
                raise UserError(sentence)
            self._take(_ask(lines, {"do": first}))
        except BaseException:
            lines.close()
            raise
        self._todo.clear()
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._talk, args=(lines, self._ending), daemon=True)
        self._thread.start()

    def close(self) -> None:
        if self._thread is not None:
            self._ending.set()
            self._thread.join(2 * TIMEOUT_S)
            self._thread = None
        self._status = ArmStatus("off", "The arm is not connected.")

    def read(self) -> Reading:
        if self._newest is None:
            raise RuntimeError("an arm has no reading before it is connected")
        return self._newest

    def status(self) -> ArmStatus:
        return self._status

    def enable(self) -> None:
        self._ask_for("enable")

    def disable(self) -> None:
        self._drop_commands()
        self._ask_for("disable")
        if self._status.takes_commands or self._status.phase == "guided":
            self._status = ArmStatus("disabled", "The arm is not enabled yet.")

    def guide(self) -> None:
        self._ask_for("guide")

    def move_gripper(self, command: GripperCommand) -> None:
        if not self._status.takes_commands:
            self._ask_for("grip", gripper=_figures(command))

    def recover(self) -> None:
        self._ask_for("recover")

    def stop(self) -> None:
        self._drop_commands()
        self._ask_for("stop")

    def send(self, command: Command) -> None:
        velocity = np.array(command.velocity, dtype=np.float64)
        n = len(self._spec.joint_names)
        if velocity.shape != (n,) or not np.isfinite(velocity).all():
            raise ValueError(f"a command needs {n} finite joint velocities")
        if not self._status.takes_commands:
            return
        gripper = command.gripper
        self._drop_commands()
        self._ask_for(
            "send",
            velocity=velocity.tolist(),
            duration_s=command.duration_s,
            gripper=None if gripper is None else _figures(gripper),
            until_s=self._now_s() + command.duration_s,
        )

    def _ask_for(self, what: str, **more: Any) -> None:
        with self._lock:
            if self._thread is not None and len(self._todo) < 100:
                self._todo.append({"do": what, **more})

    def _drop_commands(self) -> None:
        with self._lock:
            kept = [one for one in self._todo if one["do"] != "send"]
            self._todo.clear()
            self._todo.extend(kept)

    def _open(self) -> tuple[Any, dict[str, Any]]:
        try:
            connection = socket.create_connection(self._where, OPENING_S)
        except OSError as error:
            raise UserError(f"There is no wooden arm at {self._where[0]}:{self._where[1]}.") from error
        with connection:  # the file keeps it open
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            lines = connection.makefile("rwb")
            try:
                state = _ask(lines, {"do": "hello"})
            except BaseException:
                lines.close()
                raise
            connection.settimeout(TIMEOUT_S)
        return lines, state

    def _refusals(self, state: dict[str, Any]) -> tuple[str, ...]:
        found: list[str] = []
        if state["firmware"] < "2.0":
            found.append(f"The firmware {state['firmware']} is too old: update it to 2.0 or newer.")
        if len(state["q"]) != len(self._spec.joint_names):
            found.append(f"The arm has {len(state['q'])} joints: choose the robot that it is.")
        return tuple(found)

    def _talk(self, lines: Any, ending: threading.Event) -> None:
        try:
            with lines:
                while not ending.wait(PERIOD_S):
                    with self._lock:
                        todo = list(self._todo) or [{"do": "read"}]
                        self._todo.clear()
                    for one in todo:
                        if one.pop("until_s", math.inf) >= self._now_s():
                            self._take(_ask(lines, one))
                _ask(lines, {"do": self._first})
        except (OSError, ValueError, UserError):
            self._status = ArmStatus("off", LOST, lost=True)

    def _take(self, state: dict[str, Any]) -> None:
        gripper = state["gripper"]
        self._newest = Reading(
            np.array(state["q"]),
            np.array(state["dq"]),
            self._now_s(),
            0 if self._newest is None else self._newest.sequence + 1,
            None if gripper is None else GripperReading(*gripper),
        )
        self._status = ArmStatus(state["phase"], state["reason"], state["recoverable"])


def _figures(command: GripperCommand) -> list[float]:
    return [command.width_m, command.speed_m_s, command.force_n]


def _ask(lines: Any, request: dict[str, Any]) -> dict[str, Any]:
    try:
        lines.write(json.dumps(request).encode() + b"\n")
        lines.flush()
        answer = lines.readline()
    except OSError as error:
        raise UserError("The wooden arm does not answer.") from error
    if not answer:
        raise UserError("The wooden arm has closed the connection.")
    return json.loads(answer)
