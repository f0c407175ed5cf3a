"""Requests to the arm's controller, and its answers."""

import statistics
import time
from collections.abc import Callable
from typing import Final, TypeVar, final

import numpy as np

from latentarm.arms.xarm.control_socket import ControlSocket
from latentarm.arms.xarm.sdk import Sdk
from latentarm.core.types import FloatArray

ANSWER_S: Final = 0.08  # a later answer to a motion ends the connection and drops undelivered data
_QUERY_S: Final = 0.5  # the same for requests that move nothing
_SLOW_S: Final = 5.0  # the same for changes, such as switching on the motors, s
ALL_JOINTS: Final = 8
JOINT_VELOCITY: Final = 4  # the mode that takes joint velocities
MANUAL: Final = 2  # the mode in which a person moves the arm by hand
STATES_THAT_MOVE: Final = (0, 1, 2)  # states of an arm that takes commands: ready or moving
_READY, _STOP = 0, 4
_TIMEOUT, _INVALID = 3, 10
_ANSWERED: Final = (0, 1, 2, 9)  # valid codes: fine, an error is set, a warning is set, not ready to move
T = TypeVar("T", int, float)


class LinkLostError(Exception):
    """The controller is unreachable or answers nonsense; one sentence for the person."""


class RefusedError(Exception):
    """The controller refused a request; one sentence for the person."""


@final
class Controller:
    """Requests to the controller, one at a time; for a single thread.

    ``has_error`` says whether the newest answer had an error or a warning set. Raises LinkLostError if nobody
    answers there.
    """

    def __init__(self, sdk: Sdk, host: str, port: int) -> None:
        try:
            self._socket = ControlSocket(host, port, timeout_s=2.0, undelivered_s=ANSWER_S)
        except OSError as error:
            raise LinkLostError(
                f"Nobody answers at {host}, port {port}: check that the controller is switched on, its"
                f" address and the network cable ({error})."
            ) from error
        self._where = host
        self._commands = sdk.commands(self._socket)
        self.has_error = False

    def close(self) -> None:
        """End the connection and drop undelivered requests."""
        self._socket.abort()

    def version(self) -> str:
        """Axes, type, serial numbers and firmware in one line."""
        told = bytes(self._ask(self._commands.get_version, 1, within_s=_SLOW_S)[1:])
        return told.split(b"\0")[0].decode("ascii", "replace")

    def state(self) -> int:
        """The state: 0 to 2 take commands, from 3 on the arm is stopped."""
        return self._ask(self._commands.get_state, 1)[1]

    def errors(self) -> tuple[int, int]:
        """The error and the warning; 0 for none."""
        answer = self._ask(self._commands.get_err_code, 2)
        return answer[1], answer[2]

    def joints(self, dof: int) -> FloatArray:
        """(n,), joint angles in the frame of commands, rad."""
        return np.array(self._ask(self._commands.get_joint_pos, dof)[1 : dof + 1], dtype=np.float64)

    def forward(self, q: FloatArray) -> FloatArray:
        """(6,), the tool's pose at joint angles (n,), rad, as the controller reckons it: mm and rad."""
        angles = [*q.tolist(), *[0.0] * (7 - len(q))]
        return np.array(self._ask(lambda: self._commands.get_fk(angles), 6)[1:7], dtype=np.float64)

    def switch_on_motors(self) -> None:
        """Release the brakes."""
        self._done(
            self._ask(lambda: self._commands.motion_en(ALL_JOINTS, 1), within_s=_SLOW_S),
            "to switch on the motors",
        )

    def set_mode(self, mode: int) -> None:
        """Choose the kind of commands."""
        self._done(
            self._ask(lambda: self._commands.set_mode(mode), within_s=_SLOW_S), f"to go to mode {mode}"
        )

    def take_commands(self) -> None:
        """Let the arm take commands."""
        self._done(self._ask(lambda: self._commands.set_state(_READY), within_s=_SLOW_S), "to take commands")

    def stop(self) -> None:
        """Stop the arm, and take no more commands."""
        self._ask(lambda: self._commands.set_state(_STOP))

    def clear(self) -> None:
        """Clear error and warning."""
        self._ask(self._commands.clean_err, within_s=_SLOW_S)
        self._ask(self._commands.clean_war, within_s=_SLOW_S)

    def move(self, velocity: FloatArray, duration_s: float) -> None:
        """Move at a velocity (n,), rad/s, for a time above zero, s: 0 means forever to the controller."""
        if not duration_s > 0.0:
            raise ValueError(f"the duration {duration_s} s would mean no end")
        speeds = [*velocity.tolist(), *[0.0] * (7 - len(velocity))]
        self._ask(lambda: self._commands.vc_set_jointv(speeds, 1, duration_s), within_s=ANSWER_S)

    def round_trips(self) -> tuple[float, float]:
        """Median and longest time from a request to its answer, s."""
        spans: list[float] = []
        for _ in range(20):
            begun_s = time.monotonic()
            self.state()
            spans.append(time.monotonic() - begun_s)
        return statistics.median(spans), max(spans)

    def _ask(self, query: Callable[[], list[T]], figures: int = 0, *, within_s: float = _QUERY_S) -> list[T]:
        """Ask, and check the answer, which has at least ``figures`` figures and comes within ``within_s``.

        Raises LinkLostError if no answer comes in time, or one that cannot be read, and RefusedError if the
        controller says that the request is invalid.
        """
        self._commands.set_timeout(within_s)
        try:
            answer = query()
            code = int(answer[0])
        except (IndexError, TypeError, ValueError, OverflowError) as error:
            self.close()
            raise LinkLostError(
                f"What answers at {self._where} is no xArm ({error}): check the address and the port."
            ) from error
        if code == _INVALID:
            raise RefusedError(
                "The arm's controller refuses a request: update its firmware in UFACTORY Studio."
            )
        if not self._socket.connected:
            raise LinkLostError(
                "The arm's controller has ended the connection: check its power and the network cable."
            )
        if code == _TIMEOUT:
            self.close()
            raise LinkLostError(
                f"The arm's controller has not answered for {1000 * within_s:.0f} ms: check its power and the"
                " network cable."
            )
        if code not in _ANSWERED or len(answer) <= figures:
            self.close()
            raise LinkLostError(
                f"What answers at {self._where} is no xArm (code {code}): check the address and the port."
            )
        self.has_error = code in (1, 2)
        return answer

    def _done(self, answer: list[int], what: str) -> None:
        if answer[0] == 1:
            raise RefusedError(f"The arm's controller has an error set and refuses {what}: enable again.")
