"""The thread that talks to a Franka, so that no other thread waits for it."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, final

import numpy as np

from latentarm.arms.contract import ArmPhase
from latentarm.arms.franka.guiding import Guiding
from latentarm.arms.franka.link import Link, library
from latentarm.arms.franka.pace import Pace
from latentarm.arms.franka.words import NETWORK, fault, plain
from latentarm.core.errors import UserError
from latentarm.core.punctuality import OwnPauses
from latentarm.core.types import FloatArray

if TYPE_CHECKING:
    import franky

POLL_S: Final = 0.004  # time between two readings, s
_BACK_S: Final = 0.5  # the arm's clock may seem to go back by so much: states may overtake each other
_CLOSE_S: Final = 3.0
_RECOVERS_S: Final = 0.2  # an error is gone so soon after recovery
_BUTTON: Final = (
    "The stop button of the arm is pressed (release it), or its enabling device is let go (hold it)."
)
_OTHER_MODES: Final[dict[str, tuple[ArmPhase, str]]] = {
    "UserStopped": ("emergency_stop", _BUTTON),
    "Guiding": ("fault", "Somebody is guiding the arm by hand: let go of its buttons."),
    "Other": ("fault", "The arm takes no commands: open its brakes and activate FCI in Desk."),
    "AutomaticErrorRecovery": ("fault", "The arm is recovering from an error."),
}
"""Modes in which the arm takes no commands, and that end without us."""


@final
@dataclass(frozen=True, eq=False)
class Trouble:
    """Why the arm takes no commands."""

    phase: ArmPhase  # *fault* or *emergency_stop*
    reason: str  # one sentence
    recoverable: bool  # whether the worker's `recover` can end it; else it ends by itself
    lost: bool = False  # whether the connection is gone, and recovering makes a new one


@final
@dataclass(frozen=True, eq=False)
class Measured:
    """A state of the arm."""

    q: FloatArray  # (7,), rad
    dq: FloatArray  # (7,), rad/s
    time_s: float  # of arrival, on our clock, s
    arm_s: float  # on the arm's clock, s
    external_torque: FloatArray  # (7,), what everything outside exerts on the joints, N m


@final
@dataclass(frozen=True, eq=False)
class Order:
    """An order to the arm."""

    velocity: FloatArray | None  # (7,), rad/s; None stops it
    until_s: float  # its end on our clock, s


@final
class Worker:
    """Carries out the newest order, and keeps the newest state.

    Franky's control thread bounds every motion, at 1 kHz: when an order has run out, a
    `JointVelocityStopMotion` takes over, whatever becomes of this thread or this process's Python.
    ``reconnect`` opens a new link in place of a lost one.

    Raises:
        Exception: of franky, where no state comes.
    """

    def __init__(self, link: Link, reconnect: Callable[[], Link], now_s: Callable[[], float]) -> None:
        self._franky: Any = library()
        if link.limits is None:
            raise ValueError("the limits of the arm are not known")
        self.limits = link.limits  # the arm's
        self._link, self._reconnect, self._now_s = link, reconnect, now_s
        self._lock = threading.Lock()
        self._order: Order | None = None
        self.trouble: Trouble | None = None  # why the arm takes no commands
        self._recover_asked = False
        self._wake = threading.Event()
        self._closing = threading.Event()
        self._running = False
        self._driven: Order | None = None
        self._guide = False
        self._guiding = Guiding(self._franky, link.limits)
        self._pace, self.pauses = Pace(), OwnPauses()
        self.measured = self._state()  # the newest
        self._thread = threading.Thread(target=self._run, name="franka-arm", daemon=True)
        self._thread.start()

    @property
    def running(self) -> bool:
        """Whether a motion is in progress or about to begin; without one the arm holds still."""
        order = self._order
        return self._running or (order is not None and order.velocity is not None)

    @property
    def guided(self) -> bool:
        """Whether a person can move the arm by hand, or it has not yet come to rest after that."""
        return self._guiding.phase != "no"

    @property
    def in_torque_control(self) -> bool:
        """Whether the arm is guided or about to be, so that it takes no velocities."""
        return self._guide or self.guided

    def give(self, order: Order) -> None:
        """Replace the order before."""
        with self._lock:
            if self.trouble is None:
                self._order = order
                self._guide = False
        self._wake.set()

    def guide(self) -> None:
        """Let an arm at rest be guided by hand, until the next order."""
        with self._lock:
            self._guide = self.trouble is None and not self.running
        self._wake.set()

    def recover(self) -> None:
        """End a recoverable trouble soon."""
        with self._lock:
            trouble = self.trouble
            self._recover_asked = trouble is not None and trouble.recoverable
        self._wake.set()

    def fail(self, trouble: Trouble) -> None:
        """Take no orders for this reason, unless there is one already."""
        with self._lock:
            self._order = Order(None, self._now_s())
            self._guide = False
            if self.trouble is None:
                self.trouble = trouble
        self._wake.set()

    def close(self) -> None:
        """Stop the arm, end the thread and the connection."""
        self._closing.set()
        self._wake.set()
        self._thread.join(_CLOSE_S)

    def _run(self) -> None:
        while not self._closing.is_set():
            self.pauses.wait(self._wake, POLL_S)
            self._wake.clear()
            self._pass()
        self._end()

    def _pass(self) -> None:
        with self._lock:
            order, self._order = self._order, None
            trouble = self.trouble
            recover, self._recover_asked = self._recover_asked, False
        try:
            if recover and trouble is not None:
                self._end_trouble(trouble)
            if self.trouble is not None and self.trouble.lost:
                return
            if order is not None:
                self._carry_out(order)
            self._guiding.follow(self._link, self.measured.q, self._now_s(), wanted=self._guide)
            self._observe()
            self._guard()
        # franky raises libfranka's exceptions, and those of the network as RuntimeError.
        except self._franky.ControlException as error:
            self._stopped_by_itself(error)
        except self._franky.CommandException as error:
            self._stopped_by_itself(error)
        except Exception as error:  # noqa: BLE001
            self._lose_link(error)

    def _carry_out(self, order: Order) -> None:
        if self._guiding.phase != "no":
            return
        left_ms = round(1000.0 * (order.until_s - self._now_s()))
        if order.velocity is None or left_ms < 1:
            self._halt()
            return
        stands = not order.velocity.any()
        # An arm at rest holds itself: it needs no stream of zeros.
        if stands and not self._drives:
            return
        motion = self._franky.JointVelocityMotion(order.velocity, self._franky.Duration(left_ms))
        runs_out = self._franky.Measure.REL_TIME >= left_ms / 1000.0  # noqa: SIM300 - a condition of franky's
        stop = self._franky.JointVelocityStopMotion()
        motion.add_reaction(self._franky.JointVelocityReaction(runs_out, stop))
        self._move(motion)
        self._driven = order

    @property
    def _drives(self) -> bool:
        """Whether the last order carried out moves the arm."""
        driven = self._driven
        return driven is not None and driven.velocity is not None and bool(driven.velocity.any())

    def _halt(self) -> None:
        if self._running and self._driven is not None:
            self._move(self._franky.JointVelocityStopMotion())
        self._driven = None

    def _move(self, motion: "franky.BaseJointVelocityMotion") -> None:
        self._link.arm.move(motion, asynchronous=True)
        self._running = True

    def _observe(self) -> None:
        # Raises what ended the motion, if that was an error.
        if self._running and self._link.arm.join_motion(timeout=0.0):
            self._running, self._driven = False, None
        if self._guiding.ended(self._link):
            self._guide = False
        before = self.measured
        state = self._state()
        if state.arm_s < before.arm_s - _BACK_S:
            self._lose("The arm's clock went back: its controller has restarted.")
        elif state.arm_s > before.arm_s:
            # A state that repeats is not new, and stays as old as it is.
            self.measured = state
        if reason := self._pace.strange(state.time_s, state.arm_s):
            self._halt()
            self._fault(reason)

    def _guard(self) -> None:
        """Stop an order that ran out before its motion began, or that comes too near the end of a joint."""
        driven = self._driven
        if driven is None or driven.velocity is None:
            return
        if self._now_s() > driven.until_s or self.limits.exceeds(driven.velocity, self.measured.q):
            self._halt()

    def _state(self) -> Measured:
        state = self._link.arm.state
        now_s = self._now_s()
        mode = str(state.robot_mode.name)
        self._see(mode, state)
        q, dq = np.array(state.q, dtype=np.float64), np.array(state.dq, dtype=np.float64)
        # The arm reports what it exerts itself: libfranka counts its forces on other things as positive.
        torque = -np.array(state.tau_ext_hat_filtered, dtype=np.float64).ravel()
        q.flags.writeable = dq.flags.writeable = torque.flags.writeable = False
        return Measured(q, dq, now_s, float(state.time.to_sec()), torque)

    def _see(self, mode: str, state: "franky.RobotState") -> None:
        if mode == "Reflex":
            self._fault(
                self._words(_names(state.current_errors) or _names(state.last_motion_errors), "a reflex")
            )
        elif mode in _OTHER_MODES:
            phase, reason = _OTHER_MODES[mode]
            self._set(Trouble(phase, reason, recoverable=False))
        elif self.trouble is not None and not self.trouble.recoverable:
            # The button was released, or guiding has ended.
            with self._lock:
                self.trouble = None

    def _stopped_by_itself(self, error: Exception) -> None:
        """The arm ended a motion: a reflex, a button, a refusal."""
        self._running, self._driven, self._guiding.phase = False, None, "no"
        try:
            state = self._link.arm.state
        except Exception as lost:  # noqa: BLE001 - the network, again
            self._lose_link(lost)
            return
        self._see(str(state.robot_mode.name), state)
        if self.trouble is None:
            self._fault(self._words(_names(state.last_motion_errors), plain(error)))

    def _words(self, errors: list[str], said: str) -> str:
        return fault(errors, said, self.pauses.or_else(NETWORK))

    def _fault(self, reason: str) -> None:
        if self.trouble is None or not self.trouble.recoverable:
            self._set(Trouble("fault", reason, recoverable=True))

    def _lose_link(self, error: Exception) -> None:
        advice = self.pauses.or_else("check its power and cable")
        self._lose(f"The connection to the arm was lost ({plain(error)}): {advice}.")

    def _lose(self, reason: str) -> None:
        self._running, self._driven, self._guiding.phase = False, None, "no"
        self._set(Trouble("fault", reason, recoverable=True, lost=True))

    def _set(self, trouble: Trouble) -> None:
        with self._lock:
            self._order, self._guide = None, False
            self.trouble = trouble

    def _end_trouble(self, trouble: Trouble) -> None:
        """Recover from errors, or connect again; nothing moves afterwards."""
        if trouble.lost:
            # Before a new connection, the arm needs to see the end of the old one.
            self._link.close()
            try:
                self._link = self._reconnect()
            except UserError as error:
                self._lose(str(error))
                return
            # The clock of a controller that has restarted begins again.
            self.measured, self._pace = self._state(), Pace()
        elif not (self._link.arm.recover_from_errors() or self._recovered()):
            reason = "The arm did not recover from its error: recover it in Desk."
            self._set(Trouble("fault", reason, recoverable=True))
            return
        with self._lock:
            self._order = None
            if self.trouble is trouble:
                self.trouble = None

    def _recovered(self) -> bool:
        """Whether the error is gone after all: franky's answer may come from an older state."""
        until_s = self._now_s() + _RECOVERS_S
        while (mode := self._link.arm.state.robot_mode.name) == "Reflex" and self._now_s() < until_s:
            time.sleep(POLL_S)
        return mode != "Reflex"

    def _end(self) -> None:
        try:
            if self._running:
                self._move(self._franky.JointVelocityStopMotion())
            self._guiding.follow(self._link, self.measured.q, self._now_s(), wanted=False)
            if self._running or self._guiding.phase != "no":
                self._link.arm.join_motion(timeout=_CLOSE_S / 2.0)
        except Exception:  # noqa: BLE001 - it is given up anyway, and then the arm stops by itself
            self._running = False
        self._link.close()


def _names(errors: "franky.Errors") -> list[str]:
    return [name for name in dir(errors) if not name.startswith("_") and getattr(errors, name) is True]
