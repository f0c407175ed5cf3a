"""The thread that talks to the arm, so that no other thread waits for it."""

import threading
import time
from collections.abc import Callable
from typing import Final, final

import numpy as np

from latentarm.arms.xarm.controller import (
    JOINT_VELOCITY,
    MANUAL,
    STATES_THAT_MOVE,
    LinkLostError,
    RefusedError,
)
from latentarm.arms.xarm.findings import unfit
from latentarm.arms.xarm.sdk import Sdk
from latentarm.arms.xarm.session import Session
from latentarm.arms.xarm.state import Condition, Ordered, Request, Shared
from latentarm.arms.xarm.watch import Watch
from latentarm.arms.xarm.words import EMERGENCY_STOPS, controller_error, emergency_stop
from latentarm.core.errors import UserError
from latentarm.core.punctuality import OwnPauses
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.robot import Robot

_ORDER: Final[tuple[Request, ...]] = ("halt", "stop", "recover", "guide", "enable")
_LOOK_S: Final = 0.01
_ERRORS_S: Final = 0.1  # least time between questions about errors
_RELEASED_S: Final = 0.3  # a cleared emergency stop that does not come back for so long is over
_SILENT_S: Final = 0.25  # without a new report for so long, the connection counts as lost, s
_SHORTEST_S: Final = 0.002  # a command that ends sooner is not worth sending, s
_READY_S: Final = 2.0
_RESTING_S: Final = 1.0


@final
class Driver(threading.Thread):
    """Carries out the requests in `Shared`, and checks the arm's reports.

    ``session`` is the open one; ``reopen`` opens another after a lost one, numbering reports from a number
    on. ``clears``: whether it may clear the error of an emergency stop, to see whether that comes back.
    """

    def __init__(
        self,
        sdk: Sdk,
        robot: Robot,
        shared: Shared,
        session: Session,
        reopen: Callable[[int], Session],
        *,
        clears: bool,
    ) -> None:
        super().__init__(name="xarm driver", daemon=True)
        self._sdk, self._robot, self._shared = sdk, robot, shared
        self.session = session
        self._reopen, self._clears = reopen, clears
        self._watch, self._pauses = Watch(robot.joint_names), OwnPauses()
        self._drives = False
        self._stopped_s = 0.0
        self._resumed_s: float | None = None
        self._asked_errors_s = 0.0

    def run(self) -> None:
        """Run until the arm is closed."""
        try:
            while self._turn():
                pass
        finally:
            self._halt()
            self.session.close()
            # Whatever ends this thread, nobody may take the arm for enabled.
            with self._shared.changed:
                if not self._shared.ending:
                    self._shared.become("fault", "The driver of the arm has failed: start again.")

    def _turn(self) -> bool:
        shared = self._shared
        request: Request | None = None
        command: Ordered | None = None
        with shared.changed:
            if not self._is_asked():
                self._pauses.wait(shared.changed, _LOOK_S)
            if shared.ending:
                return False
            request = next((one for one in _ORDER if one in shared.requests), None)
            if request is not None:
                shared.requests.discard(request)
            elif shared.condition == "enabled":
                command, shared.command = shared.command, None
        try:
            if request is not None:
                self._carry_out(request)
            elif command is not None:
                self._move(command)
            self._look()
        except LinkLostError as error:
            self._lost(str(error))
        except RefusedError as error:
            self._fault(str(error))
        return True

    def _is_asked(self) -> bool:
        shared = self._shared
        waiting = shared.command is not None and shared.condition == "enabled"
        return bool(shared.requests) or waiting or shared.ending

    def _carry_out(self, request: Request) -> None:
        match request:
            case "halt":
                self._halt()
            case "stop":
                self.session.controller.stop()
                self._stopped_s, self._resumed_s = time.monotonic(), None
            case "enable" if self._shared.condition == "enabling":
                if self._become_ready(JOINT_VELOCITY, "enabling"):
                    self._watch.reset(time.monotonic())
                    self._is_now("enabled", after="enabling")
            case "guide" if self._shared.condition == "releasing":
                if self._become_ready(MANUAL, "releasing"):
                    self._is_now("guided", after="releasing")
            case "recover":
                self._recover()
            case _:  # taken back meanwhile
                pass

    def _move(self, command: Ordered) -> None:
        left_s = command.ends_s - time.monotonic()
        if left_s < _SHORTEST_S:
            return
        self._watch.commanded(command.velocity, command.ends_s)
        self.session.controller.move(command.velocity, left_s)

    def _become_ready(self, mode: int, while_: Condition) -> bool:
        """Switch the arm to a mode and wait until it is ready; False once ``while_`` has changed."""
        shared, controller = self._shared, self.session.controller
        if reason := unfit(self._sdk, self.session, self._robot):
            self._fault(reason)
            return False
        controller.switch_on_motors()
        controller.set_mode(mode)
        self._drives = True
        controller.take_commands()
        if not self._ready_within(_READY_S, mode, while_):
            if shared.condition == while_:
                self._fault(
                    "The arm does not become ready: check in UFACTORY Studio that it can be enabled there,"
                    " then try again."
                )
            return False
        if self.session.gripper is not None:
            self.session.gripper.enable()
        return True

    def _is_now(self, condition: Condition, *, after: Condition) -> None:
        with self._shared.changed:
            if self._shared.condition == after:
                self._shared.become(condition)

    def _ready_within(self, span_s: float, mode: int, while_: Condition) -> bool:
        joints, shared = self.session.joints, self._shared
        with joints.came:
            return joints.came.wait_for(
                lambda: self._accepts(mode) or shared.condition != while_ or shared.ending, span_s
            ) and self._accepts(mode)

    def _accepts(self, mode: int) -> bool:
        report = self.session.report
        return report.mode == mode and report.state in STATES_THAT_MOVE

    def _recover(self) -> None:
        shared = self._shared
        condition = shared.condition
        if condition not in ("fault", "lost"):
            return
        if condition == "lost":
            self.session.close()
            try:
                self.session = self._reopen(self.session.report.number)
            except UserError as error:
                self._lost(str(error))
                return
        else:
            self.session.controller.clear()
            if self._error(self.session.controller.errors()[0]):
                return
        self._halt()
        with shared.changed:
            if shared.condition == condition:
                shared.become("disabled")

    def _look(self) -> None:
        shared, session = self._shared, self.session
        condition = shared.condition
        if condition in ("off", "lost"):
            return
        now_s = time.monotonic()
        report = session.report
        if session.fault:
            self._halt()
            self._lost(session.fault)
        elif now_s - report.arrived_s > _SILENT_S:
            self._halt()
            silent_ms = 1000 * (now_s - report.arrived_s)
            self._lost(
                f"The arm has reported no new joint angles for {silent_ms:.0f} ms:"
                f" {self._pauses.or_else('check its controller and the network cable')}."
            )
        elif condition == "emergency_stop":
            self._await_release(now_s)
        elif condition == "fault" or self._has_error(now_s):
            return
        elif condition == "guided" and not self._accepts(MANUAL):
            if not self._error(session.controller.errors()[0]):
                self._fault(
                    "The arm has left its manual mode: close UFACTORY Studio's control page, then guide it"
                    " again."
                )
        elif condition == "enabled" and (reason := self._watch.fault(report)):
            if not self._error(session.controller.errors()[0]):
                self._fault(reason)
        elif condition == "stopping":
            self._go_on(now_s)

    def _has_error(self, now_s: float) -> bool:
        hinted = self.session.status.error != 0 or self.session.controller.has_error
        if not hinted or now_s - self._asked_errors_s < _ERRORS_S:
            return False
        self._asked_errors_s = now_s
        return self._error(self.session.controller.errors()[0])

    def _await_release(self, now_s: float) -> None:
        """Whether the button is still pressed: an error that is cleared comes back as long as it is.

        The controller keeps its error after the release. Clearing it neither switches on the motors nor lets
        the arm take commands.
        """
        if now_s - self._asked_errors_s < _RELEASED_S:
            return
        self._asked_errors_s = now_s
        error, _ = self.session.controller.errors()
        if error in EMERGENCY_STOPS:
            if self._clears:
                self.session.controller.clear()
        else:
            self._fault("The emergency stop was released: enable the arm again when it is safe.")

    def _error(self, code: int) -> bool:
        """Whether the controller has an error; then the arm takes no more commands."""
        if code == 0:
            return False
        if code in EMERGENCY_STOPS:
            self._halt()
            self._asked_errors_s = time.monotonic()
            self._shared.become("emergency_stop", emergency_stop(code))
        else:
            self._fault(controller_error(self._sdk, code))
        return True

    def _go_on(self, now_s: float) -> None:
        """Take commands again after a stop, once the arm is at rest."""
        report, controller = self.session.report, self.session.controller
        if self._resumed_s is None:
            rests = np.abs(report.dq).max() <= STILL_RAD_S and report.state not in STATES_THAT_MOVE
            if rests and report.arrived_s > self._stopped_s:
                controller.set_mode(JOINT_VELOCITY)
                controller.take_commands()
                self._drives, self._resumed_s = True, now_s
        elif self._accepts(JOINT_VELOCITY):
            self._watch.reset(now_s)
            with self._shared.changed:
                if self._shared.condition == "stopping" and "stop" not in self._shared.requests:
                    self._shared.become("enabled")
            return
        if now_s - self._stopped_s > _RESTING_S:
            self._fault("The arm does not come to rest: press its emergency stop, and check its controller.")

    def _fault(self, reason: str) -> None:
        self._halt()
        self._shared.become("fault", reason, recoverable=True)

    def _lost(self, reason: str) -> None:
        self._drives = False
        self.session.controller.close()
        self._shared.become("lost", reason, recoverable=True)

    def _halt(self) -> None:
        """Stop the arm for good, if reachable; else its last command ends by itself."""
        if not self._drives:
            return
        self._drives = False
        try:
            self.session.controller.stop()
        except (LinkLostError, RefusedError) as error:
            if self._shared.condition not in ("off", "fault", "emergency_stop"):
                self._lost(str(error))
