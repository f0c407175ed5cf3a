"""The driver's co-pilot: who asks, who was accepted, and what they leave of the driver's speed."""

from typing import Final, final

from latentarm.web.protocol.orders import Paced

FULL_PACE: Final = 1.0
"""A new co-pilot slows nobody down yet."""


@final
class Copilot:
    """At most one page is the driver's co-pilot, after it has asked and the driver has accepted.

    Attributes:
        page: id of the co-pilot's page, or None.
        asking: id of the page that asks, or None.
        paced: what the co-pilot has said last; None without one.
    """

    def __init__(self) -> None:
        self.page: str | None = None
        self.asking: str | None = None
        self.paced: Paced | None = None
        self._count = 0

    def ask(self, page: str) -> None:
        """A page asks; only the first to ask is remembered, and nobody is while there is a co-pilot."""
        if self.page is None and self.asking is None:
            self.asking = page

    def accept(self, to: str) -> bool:
        """The driver accepts the page that asks.

        Returns:
            Whether that page is the co-pilot now.
        """
        if self.asking is None or self.asking != to:
            return False
        self.page, self.asking = to, None
        self._count += 1
        # Without a nonce it is too old: the arm moves once the co-pilot's page has said something itself.
        self.paced = Paced(copilot=self._count, pace=FULL_PACE, nonce="")
        return True

    def says(self, page: str, pace: float, nonce: str) -> None:
        """The co-pilot's page says what it leaves of the driver's speed; others are ignored."""
        if page == self.page:
            self.paced = Paced(copilot=self._count, pace=pace, nonce=nonce)

    def leaves(self, page: str) -> bool:
        """A page ends what it is or what it asks for.

        Returns:
            Whether it was the co-pilot's.
        """
        if page == self.asking:
            self.asking = None
        return page == self.page and self.end()

    def end(self) -> bool:
        """Nobody is the co-pilot, or asks to be.

        Returns:
            Whether there was a co-pilot.
        """
        was = self.page is not None
        self.page = self.asking = self.paced = None
        return was
