"""The driver's co-pilot: who asks, who was accepted, and the share of the driver's speed that they allow."""

from typing import Final, final

from latentarm.web.protocol.orders import Paced

FULL_PACE: Final = 1.0


@final
class Copilot:
    """At most one page is the driver's co-pilot, after it has asked and the driver has accepted."""

    def __init__(self) -> None:
        self.page: str | None = None  # id of the co-pilot's page; None without one
        self.asking: str | None = None  # id of the page that asks; None for none
        self.paced: Paced | None = None  # the co-pilot's newest pace; None without one
        self._count = 0

    def ask(self, page: str) -> None:
        """Note that a page asks; only the first counts, and none while there is a co-pilot."""
        if self.page is None and self.asking is None:
            self.asking = page

    def accept(self, to: str) -> bool:
        """Make the page that asks the co-pilot; returns whether ``to`` is that page."""
        if self.asking is None or self.asking != to:
            return False
        self.page, self.asking = to, None
        self._count += 1
        # Without a nonce it is too old: the arm moves once the co-pilot's page has said something itself.
        self.paced = Paced(copilot=self._count, pace=FULL_PACE, nonce="")
        return True

    def says(self, page: str, pace: float, nonce: str) -> None:
        """Set the pace; pages other than the co-pilot's are ignored."""
        if page == self.page:
            self.paced = Paced(copilot=self._count, pace=pace, nonce=nonce)

    def leaves(self, page: str) -> bool:
        """Withdraw a page's request or role; returns whether it was the co-pilot's."""
        if page == self.asking:
            self.asking = None
        return page == self.page and self.end()

    def end(self) -> bool:
        """Remove the co-pilot and any request; returns whether there was a co-pilot."""
        was = self.page is not None
        self.page = self.asking = self.paced = None
        return was
