"""The fixed-rate loop: input in, one step, command out; and how well it met its deadlines."""

import math
import queue
import threading
from collections.abc import Callable, Sequence
from typing import Final, final

from latentarm.arms.contract import Arm, ArmStatus, check_arm, check_rate
from latentarm.control.clock import Clock
from latentarm.control.engagement import stop_of
from latentarm.control.input_port import InputSource
from latentarm.control.step import Step
from latentarm.core.types import StepRecord, Stop

ENABLING_S: Final = 5.0
"""An arm that has not become ready for so long after it was asked to is left disabled, s."""


@final
class ControlLoop:
    """Runs a `Step` at a fixed rate, in the thread that calls `run`.

    Tick k is due at ``start + k period``: a late tick does not shift the ones after it. A tick that begins
    after the last command has run out, or is done only then, finds an arm that has already stopped by
    itself: the watchdog stops it for good, until the person enables it again. Missed ticks are skipped; the
    loop never catches up on them.

    An arm that takes no commands any more (a fault, an emergency stop, a lost connection) disengages `Step`,
    and moves again only after the person has enabled it. `enable` then also recovers the arm and enables it,
    which may take it some seconds; an arm that is guided by hand holds still first. When the loop ends, it
    disables the arm.

    The command is sent before observers see the record, so that a slow recorder costs slack, not lag.

    `enable`, `stop` and `finish` may be called from any thread. They never block. The next tick handles a
    stop before anything else in the queue.

    Args:
        step: Algorithm 1.
        arm: a connected arm.
        source: of inputs.
        clock: the time.
        observers: called with every record, in the loop's thread.

    Raises:
        UserError: the arm cannot be driven safely, see `check_arm`; or it takes fewer commands per second.
    """

    def __init__(
        self,
        step: Step,
        arm: Arm,
        source: InputSource,
        clock: Clock,
        observers: Sequence[Callable[[StepRecord], None]] = (),
    ) -> None:
        check_arm(arm.spec, step.robot)
        check_rate(arm.spec, step.dt_s)
        if arm.spec.follows != step.follows:
            raise ValueError("an arm that follows its commands needs a step that compares it with them")
        self._step, self._arm, self._source = step, arm, source
        self._clock = clock
        self._observers = tuple(observers)
        self._period_s = step.dt_s
        self._ticks = self._met = 0
        self._start_s = self._sent_s = 0.0
        self._next = 0
        self._finished = threading.Event()
        self._stop_reasons: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._enable_asked = threading.Event()
        self._enabling_since_s: float | None = None
        self._ending = False

    def enable(self) -> None:
        """The person's explicit action, carried out once the next tick's input is known."""
        self._enable_asked.set()

    def stop(self, reason: str) -> None:
        """Stop the arm from the next tick on; ``reason`` is one short sentence for the person."""
        self._enable_asked.clear()
        self._stop_reasons.put(reason)

    def finish(self) -> None:
        """Stop the arm, and return from `run` once it is at rest."""
        self._finished.set()

    @property
    def ticks(self) -> int:
        """How many ticks there were."""
        return self._ticks

    @property
    def met_share(self) -> float:
        """Share of ticks that were done before the next one was due; 1 before the first tick."""
        return self._met / self._ticks if self._ticks else 1.0

    def run(self, ticks: int | None = None, mode: int = 0) -> None:
        """Run for a number of ticks, or until `finish`; then bring the arm to rest.

        The controller begins in the mode with this index. Raises UserError where it has no such mode.
        """
        self._step.reset(self._arm.read().q)
        self._step.choose_mode(mode)
        self._start_s = self._sent_s = self._clock.now_s()
        self._next = 0
        self._ending = False
        try:
            while not self._finished.is_set() and (ticks is None or self._ticks < ticks):
                self._tick(self._observers)
            self._come_to_rest(self._observers)
        finally:
            # Ramp down even after an observer's exception or Ctrl-C; never jump to zero.
            try:
                self._come_to_rest(())
            finally:
                self._arm.disable()

    def _come_to_rest(self, observers: Sequence[Callable[[StepRecord], None]]) -> None:
        self._ending = True
        self._step.stop("The loop has ended.")
        while not self._step.at_rest:
            self._tick(observers)

    def _ran_out(self, now_s: float) -> bool:
        """Whether the last command has run out; if so, the arm stays stopped."""
        if now_s - self._sent_s <= self._step.hold_s:
            return False
        self._arm.stop()
        self._step.halted(Stop("The loop was too late; the arm has stopped by itself.", code="loop_late"))
        return True

    def _heed(self, status: ArmStatus) -> None:
        """Disengage where the arm takes no commands, because it or somebody has stopped it."""
        if not status.takes_commands and (self._step.stopped is None or self._step.yielding):
            self._step.halted(stop_of(status))

    def _try_to_enable(self, now_s: float) -> bool:
        """Enable the arm and then the step; whether that has ended, in success or refusal."""
        status = self._arm.status()
        if status.phase == "fault" and status.recoverable:
            self._arm.recover()
            status = self._arm.status()
        if status.phase == "guided":
            self._arm.disable()
            status = self._arm.status()
        if status.phase == "disabled":
            self._arm.enable()
            status = self._arm.status()
        if status.takes_commands:
            self._step.enable()
            return True
        if self._enabling_since_s is None:
            self._enabling_since_s = now_s
        waiting = status.phase in ("disabled", "guided") or (status.phase == "fault" and status.recoverable)
        if waiting and now_s - self._enabling_since_s <= ENABLING_S:
            return False
        self._step.refuse(stop_of(status))
        return True

    def _await_tick(self) -> tuple[float, float]:
        """Wait for the next tick; when it was due, and the time now, s."""
        due_s = self._start_s + self._next * self._period_s
        # The next tick is never more than a period away, unless the clock has gone back.
        if due_s - self._clock.now_s() < 1.5 * self._period_s:
            self._clock.wait_until(due_s)
            now_s = self._clock.now_s()
            if due_s - now_s < 0.5 * self._period_s:
                return due_s, now_s
        # `Step` stops the arm in that case. Keeping the old schedule could mean waiting for ever.
        now_s = self._clock.now_s()
        self._start_s, self._next = now_s, 0
        return now_s, now_s

    def _tick(self, observers: Sequence[Callable[[StepRecord], None]]) -> None:
        """Wait for the next tick, and do it."""
        due_s, now_s = self._await_tick()
        ran_out = self._ran_out(now_s)
        stopped = False
        while not self._stop_reasons.empty():
            self._step.stop(self._stop_reasons.get())
            stopped = True
        given, age_s = self._source.latest(now_s)
        status = self._arm.status()
        self._heed(status)
        record = self._step(given, age_s, self._arm.read(), now_s)
        ready_s = self._clock.now_s()
        if not ran_out and self._ran_out(ready_s):
            # The step itself took too long: it decided for an arm that was still moving.
            record = self._step(given, math.inf, self._arm.read(), ready_s)
            ready_s = self._clock.now_s()
        # Counted from before it is sent: the arm's own count begins no earlier.
        self._sent_s = ready_s
        self._step.sent(ready_s)
        self._arm.send(record.command)
        if record.command.gripper is not None and not status.takes_commands:
            self._arm.move_gripper(record.command.gripper)
        self._ticks += 1
        self._met += self._clock.now_s() - due_s <= self._period_s
        # Nobody is enabled in the tick of a stop, or while the loop is ending.
        if self._enable_asked.is_set() and (stopped or self._ending or self._try_to_enable(now_s)):
            self._enable_asked.clear()
            self._enabling_since_s = None
        # Before observers: if one fails, this tick must not run twice.
        self._next += 1
        for observe in observers:
            observe(record)
        # The next tick whose due time lies ahead.
        elapsed_s = self._clock.now_s() - self._start_s
        self._next = max(self._next, math.ceil(elapsed_s / self._period_s - 1e-9))
