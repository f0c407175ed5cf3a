"""The controller's reports: joint angles many times per second, everything else now and then."""

import contextlib
import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Literal, final

import numpy as np

from latentarm.arms.xarm.controller import LinkLostError
from latentarm.arms.xarm.sdk import Sdk
from latentarm.core.types import FloatArray

_DRIFT: Final = 2e-4  # largest relative drift between the clocks
_AHEAD_S: Final = 0.05  # a report that arrives this long before its measurement shows that a clock jumped
_BEHIND_S: Final = 0.5  # no report is so late without a fault
_OWN_JUMP_S: Final = 0.05


@final
class ReportClock:
    """Converts the controller's times, and finds clocks that jump; ``fault`` is one sentence, or "".

    The quickest report so far gives the least travel time; any further delay counts as the report's age. This
    reveals reports that were held up on the way.
    """

    def __init__(self) -> None:
        self.fault = ""
        self._quickest_s: float | None = None
        self._before: tuple[float, float] | None = None

    def measured_s(self, arrived_s: float, monotonic_s: float, controller_s: float | None) -> float:
        """Time of measurement on the driver's clock, s; without ``controller_s`` that of arrival."""
        elapsed_s = 0.0
        if self._before is not None:
            elapsed_s = monotonic_s - self._before[1]
            jumped_s = (arrived_s - self._before[0]) - elapsed_s
            if abs(jumped_s) > _OWN_JUMP_S:
                self._found(f"This computer's clock has jumped by {jumped_s:.2g} s")
        self._before = arrived_s, monotonic_s
        if controller_s is None:
            return arrived_s
        took_s = monotonic_s - controller_s
        if self._quickest_s is None:
            self._quickest_s = took_s
        late_s = took_s - (self._quickest_s + _DRIFT * elapsed_s)
        if late_s < -_AHEAD_S:
            self._found(f"The clock of the arm's controller has jumped forward by {-late_s:.2g} s")
        elif late_s > _BEHIND_S:
            self._found(
                f"The clock of the arm's controller has jumped back, or its reports are {late_s:.2g} s late"
            )
        self._quickest_s = min(self._quickest_s + _DRIFT * elapsed_s, took_s)
        return arrived_s - max(0.0, late_s)

    def _found(self, what: str) -> None:
        if not self.fault:
            self.fault = (
                f"{what}: check that nothing sets it while the arm is in use, then enable the arm again."
            )


TIMED_PORT: Final = 30000  # joint states with the controller's time, 200 per second; from firmware 2.1 on
PLAIN_PORT: Final = 30003  # joint angles without a time, 100 per second
STATUS_PORT: Final = 30002  # everything else, a few times per second
_LEAST: Final[dict[int, int]] = {TIMED_PORT: 172, PLAIN_PORT: 87, STATUS_PORT: 245}
"""A frame with fewer bytes does not hold what is read from it."""

_LARGEST: Final = 4096
_DIFFERENCED_S: Final = 0.04  # span of the angles' change where velocities are not reported


@final
@dataclass(frozen=True)
class JointReport:
    """One report of the joints."""

    q: FloatArray  # (n,), rad; as received, NaN included
    dq: FloatArray  # (n,), rad/s
    mode: int  # kind of commands that the controller takes
    state: int  # 0 to 2 take commands
    measured_s: float  # on the driver's clock
    arrived_s: float  # on the machine's monotonic clock
    controller_s: float | None  # time of measurement on the controller's clock, if reported
    number: int  # grows by one with every report


@final
@dataclass(frozen=True)
class StatusReport:
    """One report of everything else."""

    axes: int  # number of joints
    kind: int  # the manufacturer's number of the type
    q: tuple[float, ...]  # joint angles, rad
    tool: tuple[float, ...]  # pose of the tool at these: x, y, z, mm, and roll, pitch, yaw, rad
    tool_offset: tuple[float, ...]  # the tool that is set, from the flange: the same
    base_offset: tuple[float, ...]  # of the frame of these poses from the arm's base: the same
    error: int  # of the controller, 0 for none
    warning: int  # of the controller, 0 for none
    mode: int  # kind of commands that the controller takes
    state: int  # 0 to 2 take commands
    load_kg: float  # set mass of the arm's load
    load_centre_mm: tuple[float, ...]  # set centre of mass
    collision_sensitivity: int  # 0 is off, 5 the most sensitive
    gravity: tuple[float, ...]  # its direction in the base frame
    speed_rad_s: float  # largest of the joints
    acceleration_rad_s2: float  # largest of the joints
    jerk_rad_s3: float  # of the motions that the controller plans for the joints; a setting
    reduced: bool  # whether the reduced mode limits speeds
    fenced: bool  # whether a safety boundary is set
    simulated: bool  # whether the controller simulates its arm


@final
class ReportStream:
    """Reads one of the controller's report ports, and calls ``take`` with each frame in its own thread."""

    def __init__(
        self, host: str, port: int, kind: Literal[30000, 30002, 30003], take: Callable[[bytes], None]
    ) -> None:
        self._least = _LEAST[kind]
        self._take = take
        self._ended = threading.Event()
        self.fault = ""
        try:
            self._socket = socket.create_connection((host, port), 2.0)
        except OSError as error:
            raise LinkLostError(
                f"The controller at {host} does not report on port {port}: check the port in the"
                f" address, firewalls, and whether its firmware is as old as it says ({error})."
            ) from error
        self._socket.settimeout(0.2)
        self._thread = threading.Thread(target=self._run, name=f"xarm reports {kind}", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the connection and the thread."""
        self._ended.set()
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        if self._thread is not threading.current_thread():
            self._thread.join(2.0)
        self._socket.close()

    def _run(self) -> None:
        received = bytearray()
        while not self._ended.is_set():
            try:
                data = self._socket.recv(8192)
            except TimeoutError:
                continue
            except OSError:
                data = b""
            if not data:
                self.fault = (
                    "The arm's controller has ended the connection: check its power and the network cable."
                )
                return
            received += data
            if not self._frames(received):
                self.fault = "The arm's controller reports in no known form: check the address and its ports."
                return

    def _frames(self, received: bytearray) -> bool:
        """Hand on all complete frames; False where this is no stream of reports."""
        while len(received) >= 4:
            size = int.from_bytes(received[:4], "big")
            if not self._least <= size <= _LARGEST:
                return False
            if len(received) < size:
                return True
            frame = bytes(received[:size])
            del received[:size]
            self._take(frame)
        return True


@final
class JointReports:
    """The newest joint states.

    ``port`` None is the manufacturer's; ``timed`` says whether the firmware reports on the port with times;
    ``number`` is that of the last report of the connection before.
    """

    def __init__(
        self,
        sdk: Sdk,
        host: str,
        port: int | None,
        dof: int,
        *,
        timed: bool,
        now_s: Callable[[], float],
        number: int,
    ) -> None:
        kind: Literal[30000, 30003] = TIMED_PORT if timed else PLAIN_PORT
        self._report: Any = sdk.report(kind)
        self._dof, self._timed, self._now_s = dof, timed, now_s
        self.clock = ReportClock()
        self._earlier: deque[tuple[float, FloatArray]] = deque()
        # None before the first; a report that repeats the controller's time does not count
        self.newest: JointReport | None = None
        self._number = number
        self.came = threading.Condition()  # notified at each report
        self.stream = ReportStream(host, port or kind, kind, self._take)

    def _take(self, frame: bytes) -> None:
        report, n = self._report, self._dof
        report.update(frame)
        controller_s = report.timestamp / 1e6 if self._timed else None
        before = self.newest
        if before is not None and controller_s is not None and controller_s == before.controller_s:
            return
        arrived_s = time.monotonic()
        measured_s = self.clock.measured_s(self._now_s(), arrived_s, controller_s)
        q = np.array(report.actual_joint_angle[:n], dtype=np.float64)
        if self._timed:
            dq = np.array(report.actual_joint_velocity[:n], dtype=np.float64)
        else:
            dq = self._difference(q, arrived_s)
        self._number += 1
        with self.came:
            self.newest = JointReport(
                q, dq, report.mode, report.state, measured_s, arrived_s, controller_s, self._number
            )
            self.came.notify_all()

    def _difference(self, q: FloatArray, arrived_s: float) -> FloatArray:
        """(n,), rad/s, from angles (n,), rad, of now and of a moment ago."""
        self._earlier.append((arrived_s, q))
        while arrived_s - self._earlier[1 if len(self._earlier) > 1 else 0][0] >= _DIFFERENCED_S:
            self._earlier.popleft()
        since_s, earlier = self._earlier[0]
        return (q - earlier) / max(arrived_s - since_s, 0.5 * _DIFFERENCED_S)


@final
class StatusReports:
    """The newest report of everything else, in ``newest``; None before the first."""

    def __init__(self, sdk: Sdk, host: str, port: int | None) -> None:
        self._report: Any = sdk.report(STATUS_PORT)
        self.newest: StatusReport | None = None
        self.came = threading.Event()
        self.stream = ReportStream(host, port or STATUS_PORT, STATUS_PORT, self._take)

    def _take(self, frame: bytes) -> None:
        report = self._report
        report.update(frame)
        payload = report.tcp_payload
        self.newest = StatusReport(
            axes=int(report.robot_axis),
            kind=int(report.robot_type),
            q=tuple(float(figure) for figure in report.actual_joint_angle),
            tool=tuple(float(figure) for figure in report.actual_tcp_pose),
            tool_offset=tuple(float(figure) for figure in report.tcp_offset),
            base_offset=tuple(float(figure) for figure in report.world_offset),
            error=int(report.error_code),
            warning=int(report.warn_code),
            mode=int(report.mode),
            state=int(report.state),
            load_kg=float(payload[0]),
            load_centre_mm=tuple(float(figure) for figure in payload[1:4]),
            collision_sensitivity=int(report.collision_sens),
            gravity=tuple(float(figure) for figure in report.gravity_direction),
            speed_rad_s=float(report.joint_max_speed),
            acceleration_rad_s2=float(report.joint_max_acc),
            jerk_rad_s3=float(report.joint_jerk),
            reduced=bool(report.is_reduced_mode),
            fenced=bool(report.is_fence_mode),
            simulated=bool(report.is_simulation_robot),
        )
        self.came.set()
