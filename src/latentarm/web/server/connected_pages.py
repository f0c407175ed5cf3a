"""Who is connected, who drives, and who asks to drive."""

import secrets
from dataclasses import dataclass
from typing import Final, final

from latentarm.web.protocol.notice import PersonName
from latentarm.web.server.copilot import Copilot

MOST: Final = 16  # pages that may be connected at once


@final
@dataclass(frozen=True)
class Page:
    """A connected page."""

    id: str  # of this connection
    name: PersonName  # a guest without a name is called by the first number that is free
    person: str | None = None  # id of their record; None for a guest


@final
class ConnectedPages:
    """At most one page drives; handing over is explicit on both sides.

    The first page drives. Later ones ask: they drive if nobody does, or when the driver hands over or lets
    others drive. `turn` counts the changes of the driver: inputs with an older turn are ignored. The co-pilot
    goes when the driver changes.
    """

    def __init__(self) -> None:
        self._pages: dict[str, Page] = {}
        self._driver: str | None = None
        self._asking: str | None = None
        self.turn = 0
        self.copilot = Copilot()

    @property
    def driver(self) -> Page | None:
        return None if self._driver is None else self._pages[self._driver]

    @property
    def asking(self) -> Page | None:
        return None if self._asking is None else self._pages[self._asking]

    def named(self, page_id: str | None) -> Page | None:
        """The connected page with this id."""
        return None if page_id is None else self._pages.get(page_id)

    @property
    def count(self) -> int:
        return len(self._pages)

    def drives(self, page: Page) -> bool:
        return self._driver == page.id

    def join(self, name: str | None, person: str | None = None) -> Page | None:
        """A new page; None if there are too many."""
        if len(self._pages) >= MOST:
            return None
        taken = {other.name for other in self._pages.values()}
        number = next(number for number in range(1, MOST + 1) if number not in taken)
        page = Page(secrets.token_hex(8), (name or "").strip() or number, person)
        self._pages[page.id] = page
        if len(self._pages) == 1:
            self._give_to(page.id)
        return page

    def leave(self, page: Page) -> bool:
        """Remove a page; returns whether it drove."""
        was_driver = self._driver == page.id
        if self._asking == page.id:
            self._asking = None
        if was_driver:
            self._give_to(self._asking)
        del self._pages[page.id]
        return was_driver

    def ask(self, page: Page) -> None:
        """Note that a page asks to drive; only the first counts."""
        if self._driver is None:
            self._give_to(page.id)
        elif self._driver != page.id and self._asking is None:
            self._asking = page.id

    def hand_over(self, page: Page, to: str) -> bool:
        """Hand over to the page that has asked to drive; returns whether the driver changed."""
        if self._driver != page.id or self._asking is None or self._asking != to:
            return False
        self._give_to(to)
        return True

    def release(self, page: Page) -> bool:
        """Stop driving: the page that has asked to drives, or nobody. Returns whether the driver changed."""
        if self._driver != page.id:
            return False
        self._give_to(self._asking)
        return True

    def _give_to(self, page_id: str | None) -> None:
        self._driver = page_id
        self.turn += 1
        self.copilot.end()
        if self._asking == page_id:
            self._asking = None
