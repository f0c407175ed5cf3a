"""The web server's side of the control process: it starts it, talks to it, and sees whether it lives."""

import multiprocessing
import os
from multiprocessing.connection import Connection
from typing import final

from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.arm_process.process import run_control
from latentarm.web.protocol.channel import ORDER_LIMIT, Given, Order, Report, new_channel, parse_report
from latentarm.web.protocol.notice import Notice


@final
class ControlProcess:
    """A running control process.

    Everything here returns at once, save `end`.

    Args:
        spec: what it drives.
    """

    def __init__(self, spec: Spec) -> None:
        context = multiprocessing.get_context("spawn")
        reading, self._orders = _order_pipe()
        self._channel = new_channel(reading)
        self._seen = 0
        self._process = context.Process(
            target=run_control, args=(spec, self._channel, os.getpid()), name="latentarm control", daemon=True
        )
        self._process.start()
        # Else nobody would notice when the control process has closed its end.
        reading.close()

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid or 0

    @property
    def alive(self) -> bool:
        """Whether it still runs."""
        return self._process.is_alive()

    @property
    def stops(self) -> int:
        """Version of the newest stop, for `Enable`."""
        return self._channel.stop.version

    def give(self, given: Given) -> None:
        """Hand over the newest input."""
        self._channel.given.write(given.model_dump_json().encode())

    def stop(self, reason: Notice) -> None:
        """Stop the arm.

        Args:
            reason: why; names in it have 40 characters at most.
        """
        self._channel.stop.write(reason.model_dump_json().encode())

    def order(self, order: Order) -> bool:
        """Send an order.

        Returns:
            Whether it was taken: not where too many are waiting, or the control process has ended.
        """
        message = order.model_dump_json().encode()
        if len(message) > ORDER_LIMIT:
            return False
        try:
            self._orders.send_bytes(message)
        except OSError:
            return False
        return True

    def newest(self) -> Report | None:
        """The newest report, if it was not seen yet."""
        if self._channel.report.version == self._seen:
            return None
        found = self._channel.report.read()
        if found is None:
            return None
        self._seen, message = found
        return parse_report(message)

    def end(self, within_s: float = 2.0) -> None:
        """Let it bring the arm to rest and end; after ``within_s`` it is ended by force."""
        self._channel.ending.raise_()
        self._process.join(within_s)
        if self._process.is_alive():
            self._process.terminate()
            self._process.join(within_s)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._orders.close()


def _order_pipe() -> tuple[Connection, Connection]:
    """Both ends of a pipe; writing never waits, and an order is short enough to go in whole or not at all."""
    reading, writing = multiprocessing.Pipe(duplex=False)
    os.set_blocking(writing.fileno(), False)
    return reading, writing
