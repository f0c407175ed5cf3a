"""The messages between the page's server and the control process, in shared memory and a pipe.

Neither ever waits for the other. Inputs and reports are latest-wins; a stop has a separate slot, so that it
arrives however full the pipe of orders is. Nothing is unpickled: everything is JSON of a strict schema.
"""

from dataclasses import dataclass
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
    """The control process's side."""

    given: LatestSlot
    report: LatestSlot
    stop: LatestSlot  # the newest reason to stop, a `Notice`; every new one stops the arm
    ending: Flag  # raised to make the control process bring the arm to rest and end
    orders: Connection  # bounded, so that a slow reader loses orders and never blocks the writer
    sightings: Connection | None = None  # from a `latentarm.surroundings.process.SourceProcess`

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


def new_channel(orders: Connection, sightings: Connection | None = None) -> Channel:
    """Slots and flags for a new control process that reads its orders from ``orders``."""
    return Channel(
        given=LatestSlot(_GIVEN_LIMIT),
        report=LatestSlot(_REPORT_LIMIT),
        stop=LatestSlot(_REASON_LIMIT),
        ending=Flag(),
        orders=orders,
        sightings=sightings,
    )
