"""The messages between the page's server and the control process, in shared memory and a pipe.

Neither ever waits for the other. Inputs and reports are latest-wins; a stop has a separate slot, so that it
arrives however full the pipe of orders is. Nothing is unpickled: everything is JSON of a strict schema.
"""

from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from typing import Final, final

from latentarm.web.protocol.orders import Order, parse_order
from latentarm.web.protocol.shared_memory import Flag, LatestSlot

ORDER_LIMIT: Final = 4096  # the longest order, bytes; short enough that the pipe takes it whole or not at all
_REPORT_LIMIT: Final = 262144
_GIVEN_LIMIT: Final = 1024
_REASON_LIMIT: Final = 512


@final
@dataclass(frozen=True)
class Channel:
    """The control process's side; the slots and the flag of a new one are empty."""

    orders: Connection  # bounded, so that a slow reader loses orders and never blocks the writer
    sightings: Connection | None = None  # from a `latentarm.surroundings.process.SourceProcess`
    given: LatestSlot = field(default_factory=lambda: LatestSlot(_GIVEN_LIMIT))
    report: LatestSlot = field(default_factory=lambda: LatestSlot(_REPORT_LIMIT))
    # the newest reason to stop, a `Notice`; every new one stops the arm
    stop: LatestSlot = field(default_factory=lambda: LatestSlot(_REASON_LIMIT))
    # raised to make the control process bring the arm to rest and end
    ending: Flag = field(default_factory=Flag)

    def read_orders(self, most: int) -> list[Order]:
        """New orders, oldest first; invalid ones are skipped. Raises EOFError if the other side is gone."""
        found: list[Order] = []
        while len(found) < most and self.orders.poll(0):
            try:
                order = parse_order(self.orders.recv_bytes(ORDER_LIMIT))
            except OSError as error:
                raise EOFError from error
            if order is not None:
                found.append(order)
        return found
