"""Links that let the next person in: printed in the terminal, and shown to the host's page as a QR code."""

import io
import json
from collections.abc import Callable
from typing import Final, final

import segno
from starlette.responses import Response

ENTRY: Final = "/enter"
INVITATION: Final = "/invitation"
"""A GET says whether a page may invite people; a POST makes a link, which voids the one before."""


@final
class Invitations:
    """Makes links that work once, and says each in the terminal.

    Args:
        new_key: a new key; the one before becomes invalid.
        base: the page's origin.
        say: tells the person who started the server.
        draws: whether their terminal can show a QR code.
    """

    def __init__(
        self, new_key: Callable[[], str], base: str, say: Callable[[str], None], draws: bool
    ) -> None:
        self._new_key = new_key
        self._base = base
        self._say = say
        self._draws = draws

    def first(self) -> str:
        """The host's own link, which the caller says."""
        return self._new_link()

    def draw(self, link: str) -> None:
        """Draw a link in the terminal, where that is possible."""
        if self._draws:
            drawn = io.StringIO()
            segno.make_qr(link).terminal(drawn, compact=True)
            self._say(drawn.getvalue().rstrip("\n"))

    def next(self) -> str:
        """A link for the next person, said in the terminal as well."""
        link = self._new_link()
        self._say(f"For the next person, a link that works once: {link}")
        self.draw(link)
        return link

    def _new_link(self) -> str:
        return f"{self._base}{ENTRY}?key={self._new_key()}"


def answer(method: str, is_host: bool, invite: Callable[[], str]) -> Response:
    """The answer to a request for `INVITATION`.

    Args:
        method: of the request.
        is_host: whether it comes from the page of the person who started the server.
        invite: makes a link.
    """
    if method == "GET":
        return _json({"may": is_host})
    if method != "POST":
        return Response(status_code=405, headers={"allow": "GET, POST"})
    if not is_host:
        return Response(status_code=403)
    link = invite()
    rows = list(segno.make_qr(link).matrix_iter())
    dark = [(x, y) for y, row in enumerate(rows) for x, module in enumerate(row) if module]
    path = "".join(f"M{x} {y}h1v1h-1z" for x, y in dark)
    return _json({"link": link, "size": len(rows), "path": path})


def _json(content: object) -> Response:
    return Response(json.dumps(content), media_type="application/json", headers={"cache-control": "no-store"})
