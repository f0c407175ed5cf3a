"""The process that owns the arm: it drives at its own rate on its own clock, whatever the web server does.

`run_control` runs in it. `ControlProcess` is the web server's side.
"""

import logging
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable
from multiprocessing.connection import Connection
from types import FrameType
from typing import Final, final

from threadpoolctl import threadpool_limits

from latentarm.arms.contract import SceneArm
from latentarm.control.clock import MonotonicClock
from latentarm.core.child_processes import start_child
from latentarm.core.errors import UserError
from latentarm.core.logs import LogSettings, log_settings, logging_as
from latentarm.core.punctuality import ask_for_priority, short_collections
from latentarm.core.types import StepRecord
from latentarm.core.untrusted.terminal import one_line
from latentarm.web.arm_process.arm_lifecycle import first_arm, from_where_it_stands
from latentarm.web.arm_process.drive import Drive
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.arm_process.driven import Driven, drive_in_turn
from latentarm.web.arm_process.episode_writer import EpisodeWriter
from latentarm.web.arm_process.help import USUAL_HELP
from latentarm.web.arm_process.incident import begin_incident
from latentarm.web.arm_process.steering import Steering
from latentarm.web.protocol import orders
from latentarm.web.protocol.channel import ORDER_LIMIT, Channel
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.report import Report

_LOG: Final = logging.getLogger(__name__)


def run_control(spec: Spec, channel: Channel, server: int, logs: LogSettings) -> None:
    """Drive until the server, a process id, says so or is gone; then bring the arm to rest and return.

    Raises UserError if something that the spec names cannot be loaded.
    """

    def end(number: int, frame: FrameType | None) -> None:
        channel.ending.raise_()

    def orphaned() -> bool:
        return os.getppid() != server

    signal.signal(signal.SIGTERM, end)
    with threadpool_limits(1), logging_as(logs):
        # Loading takes half a second, which must not come before the steps of other arms.
        setup = load_setup(spec)
        privileged = ask_for_priority()
        _LOG.info("The arm's process begins %s real-time priority.", "with" if privileged else "without")
        clock = MonotonicClock()
        writer = EpisodeWriter(spec.out, spec.journal)
        steering = Steering(setup.first_mode(USUAL_HELP))
        try:
            arm = first_arm(setup, clock)
        except UserError as error:
            # It may have gone since the server looked at it; pages hear that this process has ended.
            sys.stderr.write(f"latentarm: {one_line(str(error))}\n")
            raise SystemExit(2) from error
        driven = Driven(from_where_it_stands(setup, arm), arm, steering)

        def drive(driven: Driven, note: Notice | None) -> orders.Change | None:
            calls = begin_incident(driven.setup)
            given = (driven.setup, driven.arm, channel, clock, writer, orphaned, driven.steering, note)
            fixed, arm = driven.setup.spec.fixed, driven.arm
            observers: list[Callable[[StepRecord], None]] = []
            if fixed is not None and isinstance(arm, SceneArm):
                observers.append(fixed.watch(arm, lambda: begun.device))
            begun = Drive(*given, observers=observers, calls=calls)
            try:
                return begun.run()
            finally:
                if calls is not None:
                    calls.close()

        try:
            with short_collections():
                drive_in_turn(driven, drive, clock)
        except BaseException:
            _LOG.info("The arm's process has broken off.", exc_info=True)
            raise
        finally:
            writer.close()


@final
class ControlProcess:
    """A running control process. Every method but `end` returns at once."""

    def __init__(self, spec: Spec, sightings: Connection | None = None) -> None:
        reading, self._orders = multiprocessing.Pipe(duplex=False)
        # Writing never waits, and an order is short enough to fit whole or not at all.
        os.set_blocking(self._orders.fileno(), False)
        self._channel = Channel(reading, sightings)
        self._seen = 0
        given = (spec, self._channel, os.getpid(), log_settings())
        self._process = start_child(run_control, given, "latentarm control")
        # Else nobody would notice when the control process has closed its end.
        reading.close()

    @property
    def alive(self) -> bool:
        return self._process.is_alive()

    @property
    def stops(self) -> int:
        """Version of the newest stop, for `Enable`."""
        return self._channel.stop.version

    def give(self, given: orders.Given) -> None:
        self._channel.given.write(given.model_dump_json().encode())

    def stop(self, reason: Notice) -> None:
        """Stop the arm; names in the reason have 40 characters at most."""
        self._channel.stop.write(reason.model_dump_json().encode())

    def order(self, order: orders.Order) -> bool:
        """Send an order; returns False if too many are waiting, or the control process has ended."""
        message = order.model_dump_json().encode()
        if len(message) > ORDER_LIMIT:
            return False
        try:
            self._orders.send_bytes(message)
        except OSError:
            return False
        return True

    def newest(self) -> Report | None:
        """The newest report, if it was not read yet."""
        if self._channel.report.version == self._seen or (found := self._channel.report.read()) is None:
            return None
        self._seen, message = found
        return Report.parse(message)

    def end(self, within_s: float = 2.0) -> None:
        """Let it bring the arm to rest and end; kill it after ``within_s``."""
        self._channel.ending.raise_()
        self._process.join(within_s)
        if self._process.is_alive():
            self._process.terminate()
            self._process.join(within_s)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._orders.close()
