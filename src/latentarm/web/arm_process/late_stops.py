"""How often the arm had to stop because a page's inputs came too late."""

from typing import final

from latentarm.core.types import Stop


@final
class LateStops:
    """Counts them for one driver.

    Attributes:
        count: so many since this driver began.
    """

    def __init__(self) -> None:
        self.count = 0
        self._enabled = False
        self._driver = -1

    def look(self, stopped: Stop | None, driver: int) -> None:
        """Look once in every tick.

        Args:
            stopped: why the arm may not move, or None where it may.
            driver: whose inputs are taken; another one is counted anew.
        """
        if driver != self._driver:
            self.count, self._driver = 0, driver
        if self._enabled and stopped is not None and stopped.code == "input_late":
            self.count += 1
        self._enabled = stopped is None
