"""The manufacturer's gripper, over a separate connection, so that it never delays the arm's commands."""

import threading
import time
from collections.abc import Callable
from typing import Final, final

from latentarm.arms.xarm.control_socket import ControlSocket
from latentarm.arms.xarm.controller import LinkLostError
from latentarm.arms.xarm.sdk import Sdk
from latentarm.arms.xarm.words import gripper_error
from latentarm.core.types import GripperCommand, GripperReading
from latentarm.robots.gripper import Gripper

PORT: Final = 503
OPEN_UNITS: Final = 850  # position of the open gripper; 0 is closed
FASTEST_UNITS: Final = 5000  # its largest speed
_SLOWEST_UNITS: Final = 300
_ANSWER_S: Final = 0.5
_POLL_S: Final = 0.1
_STATUS_REGISTER: Final = 0x0000
_HOLDS: Final = 2


def units_of(width_m: float, gripper: Gripper) -> int:
    """An opening, m, in the manufacturer's units."""
    return round(OPEN_UNITS * min(max(width_m / gripper.width_m, 0.0), 1.0))


def width_of(units: int, gripper: Gripper) -> float:
    """The manufacturer's units as an opening, m."""
    return gripper.width_m * min(max(units / OPEN_UNITS, 0.0), 1.0)


@final
class GripperLink:
    """Drives and reads the gripper in a separate thread.

    Its opening is assumed proportional to its position, and its speed to the manufacturer's fastest. Its
    force cannot be set. Raises LinkLostError if nobody answers there, or no gripper does.
    """

    def __init__(self, sdk: Sdk, host: str, port: int | None, gripper: Gripper) -> None:
        try:
            self._socket = ControlSocket(host, port or PORT, timeout_s=2.0, undelivered_s=_ANSWER_S)
        except OSError as error:
            raise LinkLostError(
                f"The controller at {host} does not answer on port {port or PORT}, which the gripper"
                f" needs: check that no firewall is in between ({error})."
            ) from error
        self._sdk, self._gripper = sdk, gripper
        self._commands = sdk.commands(self._socket)
        self._commands.set_timeout(_ANSWER_S)
        self._lock = threading.Condition()
        self._target: tuple[int, int] | None = None
        self._enable = self._on = False
        self._ended = False
        self.fault = ""  # one sentence, or ""
        try:
            self.reading = self._read()
        except LinkLostError:
            self._socket.abort()
            raise
        self._thread = threading.Thread(target=self._run, name="xarm gripper", daemon=True)
        self._thread.start()

    def enable(self) -> None:
        """Switch it on; it stays in place."""
        with self._lock:
            self._target = None
            self._enable = True
            self._lock.notify()

    def send(self, command: GripperCommand) -> None:
        """Go to an opening, no slower than it can; repeating this changes nothing."""
        speed = round(FASTEST_UNITS * command.speed_m_s / self._gripper.speed_m_s)
        speed = min(max(speed, _SLOWEST_UNITS), FASTEST_UNITS) if command.speed_m_s > 0.0 else 0
        target = units_of(command.width_m, self._gripper), speed
        with self._lock:
            if target != self._target:
                self._target = target
                self._lock.notify()

    def close(self) -> None:
        """End the connection; a hold persists."""
        with self._lock:
            self._ended = True
            self._lock.notify()
        self._thread.join(1.5)
        self._socket.abort()

    def _run(self) -> None:
        sent: tuple[int, int] | None = None
        try:
            while True:
                with self._lock:
                    if self._target == sent and not self._enable and not self._ended:
                        self._lock.wait(_POLL_S)
                    if self._ended:
                        return
                    target, enable, self._enable = self._target, self._enable, False
                # An order to open may come before the arm was ever enabled.
                if enable or (target is not None and target[1] > 0 and not self._on):
                    self._on = True
                    self._ask(lambda: self._commands.gripper_modbus_set_en(1))
                    self._ask(lambda: self._commands.gripper_modbus_set_mode(0))
                    sent = None
                if target is not None and target != sent and self._on:
                    self._move(*target)
                    sent = target
                self.reading = self._read()
                error = self._ask(self._commands.gripper_modbus_get_errcode, 1)[1]
                if error:
                    self.fault = gripper_error(self._sdk, error)
                    return
        except LinkLostError as error:
            self.fault = str(error)

    def _move(self, units: int, speed: int) -> None:
        if speed == 0:
            # Read anew: the newest reading may be so old that the fingers would go back to it.
            at = self._read()
            if not at.holding:
                units = units_of(at.width_m, self._gripper)
                self._ask(lambda: self._commands.gripper_modbus_set_pos(units))
            return
        self._ask(lambda: self._commands.gripper_modbus_set_posspd(speed))
        self._ask(lambda: self._commands.gripper_modbus_set_pos(units))

    def _read(self) -> GripperReading:
        position = self._ask(self._commands.gripper_modbus_get_pos, 1)[1]
        status = self._ask(lambda: self._commands.gripper_modbus_r16s(_STATUS_REGISTER, 1), 6)
        return GripperReading(width_of(position, self._gripper), holding=status[6] & 3 == _HOLDS)

    def _ask(self, request: Callable[[], list[int]], figures: int = 0) -> list[int]:
        begun_s = time.monotonic()
        try:
            answer = request()
            code = int(answer[0])
        except (IndexError, TypeError, ValueError, OverflowError):
            code, answer = -1, []
        if code not in (0, 1, 2) or len(answer) <= figures or not self._socket.connected:
            self._socket.abort()
            raise LinkLostError(
                f"The gripper has not answered for {1000 * (time.monotonic() - begun_s):.0f} ms: check"
                " that it is an xArm gripper, its cable at the tool and its baud rate in UFACTORY Studio,"
                " then enable the arm again."
            )
        return answer
