"""A limit on requests: for each participant, and for all others by their address.

Addresses are held in memory alone. Behind a proxy all strangers have one: participants do not share it.
"""

import logging
from typing import Final, final

from starlette.requests import HTTPConnection

from latentarm.web.server.rate_limit import Allowance

RATE: Final = 10.0  # requests per second
BURST: Final = 600.0  # requests that may come at once, such as everything that a Drive page loads
MOST: Final = 1000  # participants and addresses that are remembered

_LOG: Final = logging.getLogger(__name__)


@final
class RequestLimit:
    """Counts requests."""

    def __init__(self) -> None:
        self._left: dict[str, Allowance] = {}  # by key or address, the oldest first
        self._refused = 0

    def allows(self, connection: HTTPConnection, key: str) -> bool:
        """Count a request; ``key`` is the participant's, "" for strangers. False if it is one too many."""
        who = key or ("" if connection.client is None else connection.client.host)
        if who not in self._left and len(self._left) >= MOST:
            del self._left[next(iter(self._left))]
        if self._left.setdefault(who, Allowance(rate=RATE, burst=BURST)).spend():
            return True
        self._refused += 1
        if str(self._refused).strip("0") == "1":  # 1, 10, 100, ...: a flood does not flood the terminal
            _LOG.warning("Too many requests came at once; refused so far: %d.", self._refused)
        return False
