"""Drive until the other end is gone; then bring the arm to rest."""

import signal
from collections.abc import Mapping
from typing import Any, Final, final

import numpy as np
from threadpoolctl import threadpool_limits

from latentarm.arms.catalogue import make_arm
from latentarm.arms.contract import Arm
from latentarm.arms.helper_process import MessagePort
from latentarm.control.clock import MonotonicClock
from latentarm.control.loop import ControlLoop
from latentarm.core.errors import UserError
from latentarm.core.punctuality import ask_for_priority, short_collections
from latentarm.core.types import StepRecord, StopCode
from latentarm.robots.kinematics.rotations import quaternion
from latentarm_process.driven import INPUT_TIMEOUT_S, Driven, Wanted, load
from latentarm_process.inputs import PortInputs

LET_GO_ENABLES: Final[frozenset[StopCode | None]] = frozenset({"input_late", "loop_late"})
"""Stops after which nothing is wrong with the arm: letting go enables it again. After any other one a person
has to look at the arm and connect again."""


@final
class Drive:
    """One connection's drive.

    Args:
        port: to the process that asks.
        driven: what is driven.
        arm: what moves; connected.
    """

    def __init__(self, port: MessagePort, driven: Driven, arm: Arm) -> None:
        self._port, self._driven = port, driven
        self._step = driven.step()
        self._inputs = PortInputs(port, driven.controller.input_dim, self._heard, self._gone)
        self._loop = ControlLoop(self._step, arm, self._inputs, MonotonicClock(), [self._observe])
        self._looks: list[int] = []

    def run(self) -> None:
        """Drive until the other end is gone."""
        # A LeRobot robot is expected to move once it is connected: connecting is what enables it.
        self._loop.enable()
        self._loop.run()

    def _gone(self) -> None:
        self._loop.finish()

    def _heard(self, message: Mapping[str, Any]) -> None:
        if "look" in message:
            self._looks.append(int(message["look"]))

    def _observe(self, record: StepRecord) -> None:
        stop = self._step.stopped
        let_go = self._inputs.let_go(record.time_s, self._step.dead_zone, INPUT_TIMEOUT_S)
        if stop is not None and stop.code in LET_GO_ENABLES and let_go:
            self._loop.enable()
        for number in self._looks:
            self._port.send({"seen": number, **self._seen(record)})
        self._looks.clear()

    def _seen(self, record: StepRecord) -> dict[str, object]:
        stop = self._step.stopped
        pose = self._driven.robot.chain.forward(np.nan_to_num(record.state))
        return {
            "q": record.state.tolist(),
            "tool": [*pose.position.tolist(), *quaternion(pose.rotation).tolist()],
            "width_m": None if record.gripper is None else record.gripper.width_m,
            "u": record.input.tolist(),
            "stopped": "" if stop is None else stop.reason,
            "ticks": self._loop.ticks,
            "met_share": self._loop.met_share,
        }


def main() -> None:
    """Load what the first message says, say what it is, and drive."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    port = MessagePort.of_helper()
    message = port.receive(wait_s=60.0)
    if message is None:
        return
    try:
        with threadpool_limits(1):
            driven = load(Wanted.of_message(message))
            arm = make_arm(message["arm"], driven.robot, driven.start, MonotonicClock().now_s)
            with arm:
                drive = Drive(port, driven, arm)
                ask_for_priority()
                with short_collections():
                    port.send({"ready": True})
                    drive.run()
    except UserError as error:
        port.send({"refused": str(error)})


if __name__ == "__main__":
    main()
