"""How often the arm had to stop because a page's inputs came too late."""

from typing import final

from latentarm.core.types import Stop


@final
class LateStops:
    """Counts, for one driver, the stops because a page's input was late."""

    def __init__(self) -> None:
        self.count = 0
        self._enabled = False
        self._driver = -1

    def look(self, stopped: Stop | None, driver: int) -> None:
        """Call once a tick; ``stopped`` is None while the arm is enabled. A new driver restarts the count."""
        if driver != self._driver:
            self.count, self._driver = 0, driver
        if self._enabled and stopped is not None and stopped.code == "input_late":
            self.count += 1
        self._enabled = stopped is None
