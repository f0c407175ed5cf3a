"""The fixed-rate loop: input in, one step, command out."""

import math
import queue
import threading
from collections.abc import Callable, Sequence
from typing import final

from latentarm.arms.contract import Arm, check_limits
from latentarm.control.clock import Clock
from latentarm.control.deadlines import DeadlineLog, DeadlineStatistics
from latentarm.control.input_port import InputSource
from latentarm.control.step import Step
from latentarm.types import StepRecord


@final
class ControlLoop:
    """Runs a `Step` at a fixed rate, in the thread that calls `run`.

    Tick k is due at ``start + k period``: a late tick does not shift the ones after it. A tick that begins
    after the last command has run out, or is done only then, finds an arm that has already stopped by
    itself: the watchdog stops it for good, until the person enables it again. Missed ticks are skipped; the
    loop never catches up on them.

    The command is sent before observers see the record, so that a slow recorder costs slack, not lag.

    `enable`, `stop` and `finish` may be called from any thread. They never block. The next tick handles a
    stop before anything else in the queue.

    Args:
        step: Algorithm 1.
        arm: what is driven.
        source: where inputs come from.
        clock: the time.
        observers: called with every record, in the loop's thread.

    Raises:
        UserError: the arm is a real one whose limits are assumed.
    """

    def __init__(
        self,
        step: Step,
        arm: Arm,
        source: InputSource,
        clock: Clock,
        observers: Sequence[Callable[[StepRecord], None]] = (),
    ) -> None:
        check_limits(arm, step.robot)
        self._step = step
        self._arm = arm
        self._source = source
        self._clock = clock
        self._observers = tuple(observers)
        self._period_s = step.dt_s
        self._log = DeadlineLog(self._period_s)
        self._start_s = self._sent_s = 0.0
        self._next = 0
        self._finished = threading.Event()
        self._stop_reasons: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._enable_asked = threading.Event()
        self._ending = False

    def enable(self) -> None:
        """The person's explicit action, carried out once the next tick's input is known."""
        self._enable_asked.set()

    def stop(self, reason: str) -> None:
        """Stop the arm, from the next tick on.

        Args:
            reason: one short sentence for the person.
        """
        self._enable_asked.clear()
        self._stop_reasons.put(reason)

    def finish(self) -> None:
        """Stop the arm, and return from `run` once it is at rest."""
        self._finished.set()

    def statistics(self) -> DeadlineStatistics:
        """How punctual the loop has been."""
        return self._log.statistics()

    def run(self, ticks: int | None = None) -> DeadlineStatistics:
        """Run for so many ticks, or until `finish`; then bring the arm to rest.

        Args:
            ticks: how many, or None for no end.

        Returns:
            How punctual the loop was.
        """
        self._step.reset(self._arm.state())
        self._start_s = self._sent_s = self._clock.now_s()
        self._next = 0
        self._ending = False
        try:
            while not self._finished.is_set() and (ticks is None or self._log.ticks < ticks):
                self._tick(self._observers)
            self._come_to_rest(self._observers)
        finally:
            # Ramp down even after an observer's exception or Ctrl-C; never jump to zero.
            try:
                self._come_to_rest(())
            finally:
                self._arm.stop()
        return self.statistics()

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
        self._step.halted("The loop was too late; the arm has stopped by itself.")
        return True

    def _await_tick(self) -> tuple[float, float]:
        """Wait for the next tick.

        Returns:
            When it was due, and the time now, s.
        """
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
        overrun = self._ran_out(now_s)
        stopped = False
        while not self._stop_reasons.empty():
            self._step.stop(self._stop_reasons.get())
            stopped = True
        given, age_s = self._source.latest(now_s)
        record = self._step(given, age_s, self._arm.state(), now_s)
        ready_s = self._clock.now_s()
        if not overrun and self._ran_out(ready_s):
            # The step itself took too long: it decided for an arm that was still moving.
            overrun = True
            record = self._step(given, math.inf, self._arm.state(), ready_s)
            ready_s = self._clock.now_s()
        # Counted from before it is sent: the arm's own count begins no earlier.
        self._sent_s = ready_s
        self._step.sent(ready_s)
        self._arm.send(record.command)
        self._log.add(now_s - due_s, self._clock.now_s() - due_s, overrun=overrun)
        if self._enable_asked.is_set():
            self._enable_asked.clear()
            # Not if the arm was stopped in the same tick, or the loop is ending.
            if not (stopped or self._ending):
                self._step.enable()
        # Before observers: if one fails, this tick must not run twice.
        self._next += 1
        for observe in observers:
            observe(record)
        # The next tick whose due time lies ahead.
        elapsed_s = self._clock.now_s() - self._start_s
        self._next = max(self._next, math.ceil(elapsed_s / self._period_s - 1e-9))
