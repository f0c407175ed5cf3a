"""The calendar that dates records."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from typing import Final, final


@final
@dataclass(frozen=True)
class Calendar:
    """Dates records; ``now`` is the time with its zone. Durations are measured by monotonic clocks."""

    now: Callable[[], datetime]

    def stamp(self) -> str:
        """The time as records keep it: ISO 8601 in UTC, to the second."""
        return self.now().astimezone(UTC).isoformat(timespec="seconds")


SYSTEM_CALENDAR: Final = Calendar(partial(datetime.now, UTC))
"""The computer's own."""
