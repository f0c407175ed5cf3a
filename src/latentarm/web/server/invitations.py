"""One-time links for the next person: printed in the terminal, and shown to the host's page as a QR code."""

import io
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import segno
from starlette.responses import Response

from latentarm.web.server.answers import json_answer

ENTRY: Final = "/enter"
INVITATION: Final = "/invitation"
"""GET: whether a page may invite people. POST: make a link, which voids the one before."""


@final
@dataclass(eq=False)
class Invitations:
    """Makes one-time links and prints them in the terminal.

    ``new_key`` makes a key and voids the one before; ``base`` is the page's origin; ``draws``: whether the
    terminal can show a QR code.
    """

    _new_key: Callable[[], str]
    _base: str
    _say: Callable[[str], None]
    _draws: bool

    def draw(self, link: str) -> None:
        """Draw a link as a QR code, if the terminal can."""
        if self._draws:
            drawn = io.StringIO()
            segno.make_qr(link).terminal(drawn, compact=True)
            self._say(drawn.getvalue().rstrip("\n"))

    def next(self) -> str:
        """Make and print a link for the next person."""
        link = self.new_link()
        self._say(f"For the next person, a link that works once: {link}")
        self.draw(link)
        return link

    def new_link(self) -> str:
        """A link; the caller prints it."""
        return f"{self._base}{ENTRY}?key={self._new_key()}"


def answer(method: str, is_host: bool, invite: Callable[[], str]) -> Response:
    """Answer a request for `INVITATION`; only the host, who started the server, may invite."""
    if method == "GET":
        return json_answer({"may": is_host})
    if method != "POST":
        return Response(status_code=405, headers={"allow": "GET, POST"})
    if not is_host:
        return Response(status_code=403)
    link = invite()
    rows = list(segno.make_qr(link).matrix_iter())
    dark = [(x, y) for y, row in enumerate(rows) for x, module in enumerate(row) if module]
    path = "".join(f"M{x} {y}h1v1h-1z" for x, y in dark)
    return json_answer({"link": link, "size": len(rows), "path": path})
