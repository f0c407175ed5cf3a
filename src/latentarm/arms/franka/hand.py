"""The Franka Hand, in a thread of its own because its commands wait until the fingers are there."""

import threading
from typing import TYPE_CHECKING, Final, final

from latentarm.arms.franka.words import plain
from latentarm.core.types import GripperCommand, GripperReading
from latentarm.robots.gripper import Gripper

if TYPE_CHECKING:
    import franky

POLL_S: Final = 0.02  # between two readings; the hand has some thirty a second
_ANSWER_S: Final = 3.0  # a hand confirms a stop within this time
_CLOSED_M: Final = 0.001  # a command to a smaller width closes the hand
_NOTHING_M: Final = 0.002  # fingers this close hold nothing
_ALIKE_M: Final = 5e-4
_ABANDONED: Final[list["franky.Gripper"]] = []
"""Hands that never answered: a thread of franky still waits for each."""

_LEAST_SPEED: Final = 0.001
_LEAST_FORCE: Final = 1.0


@final
class Hand:
    """Drives a connected hand.

    A command to close grasps, and keeps the force; any other moves to a width. A new command stops the one
    before, and one with speed 0 only stops: a grasp persists. Neither the end of commands nor `close` lets go
    of anything.

    Raises:
        Exception: of franky, where no reading comes.
    """

    def __init__(self, hand: "franky.Gripper", gripper: Gripper) -> None:
        self._hand, self._gripper = hand, gripper
        self._lock = threading.Lock()
        self._asked: GripperCommand | None = None
        self._carried_out: GripperCommand | None = None
        self._motion: franky.BoolFuture | None = None
        self._told: tuple[float, float] | None = None
        self._reached: tuple[float, float] | None = None
        self.lost = ""  # why readings have ended, or ""
        self._closing = threading.Event()
        self._wake = threading.Event()
        self.reading = self._measure()  # the newest
        self._thread = threading.Thread(target=self._run, name="franka-hand", daemon=True)
        self._thread.start()

    def ask(self, command: GripperCommand) -> None:
        """Take a command without waiting; repeating the last changes nothing."""
        with self._lock:
            if _alike(command, self._asked):
                return
            self._asked = command
        self._wake.set()

    def close(self) -> None:
        """End the thread; moving fingers stop, and keep their grasp."""
        self._closing.set()
        self._wake.set()
        self._thread.join(_ANSWER_S)

    def _run(self) -> None:
        try:
            while not self._closing.is_set():
                self._wake.wait(POLL_S)
                self._wake.clear()
                with self._lock:
                    asked = self._asked
                if asked is not None and not _alike(asked, self._carried_out):
                    self._carry_out(asked)
                self.reading = self._measure()
            self._end_motion()
        # franky raises whatever libfranka and the network do.
        except Exception as error:  # noqa: BLE001
            self.lost = plain(error)
            self._give_up_motion()

    def _give_up_motion(self) -> None:
        """Wait for a motion that has lost its hand; franky's gripper must not go before it."""
        if self._motion is not None and not self._motion.wait(_ANSWER_S):
            _ABANDONED.append(self._hand)

    def _carry_out(self, command: GripperCommand) -> None:
        if self._end_motion():
            self._reached = self._told
        self._carried_out = command
        told = command.width_m, command.force_n
        if command.speed_m_s <= 0.0 or told == self._reached:
            return
        self._told, self._reached = told, None
        speed = min(max(command.speed_m_s, _LEAST_SPEED), self._gripper.speed_m_s)
        force = min(max(command.force_n, _LEAST_FORCE), self._gripper.force_n)
        width = min(max(command.width_m, 0.0), self._gripper.width_m)
        if width <= _CLOSED_M:
            self._motion = self._hand.grasp_async(0.0, speed, force, 0.0, self._gripper.width_m)
        else:
            self._motion = self._hand.move_async(width, speed)

    def _end_motion(self) -> bool:
        """Stop moving fingers and await the hand's answer; returns whether a motion had ended by itself."""
        if self._motion is None or self._motion.wait(0.0):
            ended, self._motion = self._motion is not None, None
            return ended
        self._hand.stop()
        if not self._motion.wait(_ANSWER_S):
            raise TimeoutError("the hand did not say that it has stopped")
        self._motion = None
        return False

    def _measure(self) -> GripperReading:
        state = self._hand.state
        grasps = self._carried_out is not None and self._carried_out.width_m <= _CLOSED_M
        holding = bool(state.is_grasped) and state.width > _NOTHING_M
        return GripperReading(float(state.width), holding and (grasps or self._carried_out is None))


def _alike(one: GripperCommand, other: GripperCommand | None) -> bool:
    return (
        other is not None
        and abs(one.width_m - other.width_m) < _ALIKE_M
        and abs(one.force_n - other.force_n) < 1e-3
        and abs(one.speed_m_s - other.speed_m_s) < 1e-4
    )
