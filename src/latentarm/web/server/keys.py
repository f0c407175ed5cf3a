"""One-time links, and the cookies that they are exchanged for; only hashes are kept."""

import hashlib
import hmac
import logging
import secrets
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final, final

from pydantic import BaseModel, Field

from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.untrusted.opening import is_missing
from latentarm.web.records.record_files import read_record

LIFE_S: Final = 8 * 3600  # validity of a cookie, s
_LOG: Final = logging.getLogger(__name__)

_MOST_VISITORS: Final = 64


@final
class Keys:
    """Access to the page by links and cookies.

    The first link of a start makes a host: it is printed for the person who started the server. ``now_s`` is
    the time of day, s, which goes on while the machine is off. Cookies survive a restart in the file
    ``store``; from a damaged one nobody comes back.
    """

    def __init__(self, now_s: Callable[[], float] = time.time, store: Path | None = None) -> None:
        self._now_s = now_s
        self._store = store
        self._link: str | None = None
        self._hosts_link: str | None = None
        self._cookies = _read(store) if store is not None else {}

    def new_link(self) -> str:
        """A key for the next visitor, 256 random bits; voids the previous one."""
        key = secrets.token_urlsafe(32)
        self._link = _hash(key)
        self._hosts_link = self._hosts_link or self._link
        return key

    def redeem(self, key: str) -> str | None:
        """A cookie in exchange for an unused key, or None."""
        self._forget()
        given = _hash(key)
        if self._link is None or not hmac.compare_digest(self._link, given):
            return None
        if len(self._cookies) >= _MOST_VISITORS:
            return None
        self._link = None
        cookie = secrets.token_urlsafe(32)
        self._cookies[_hash(cookie)] = _Cookie(until_s=self._now_s() + LIFE_S, host=given == self._hosts_link)
        self._write()
        return cookie

    def is_host(self, cookie: str) -> bool:
        """Whether this cookie is that of the person who started the server."""
        found = self._found(cookie)
        return found is not None and found.host

    def opens_for(self, cookie: str) -> float | None:
        """How much longer a cookie is valid, s; None if it is unknown or expired."""
        found = self._found(cookie)
        return None if found is None else found.until_s - self._now_s()

    def _found(self, cookie: str) -> "_Cookie | None":
        self._forget()
        given = _hash(cookie)
        found = None
        for known, one in self._cookies.items():
            if hmac.compare_digest(known, given):
                found = one
        return found

    def _forget(self) -> None:
        now_s = self._now_s()
        # A clock that was set back makes no cookie valid for longer.
        self._cookies = {
            known: one for known, one in self._cookies.items() if 0 < one.until_s - now_s <= LIFE_S
        }

    def _write(self) -> None:
        if self._store is None:
            return
        try:
            write_text(self._store, _Cookies(cookies=self._cookies).model_dump_json())
        except UserError as error:
            _LOG.warning("After a restart everybody needs a new link: %s", error)


class _Cookie(BaseModel, frozen=True, extra="forbid", strict=True):
    until_s: float  # time of day
    host: bool


class _Cookies(BaseModel, frozen=True, extra="forbid", strict=True):
    cookies: dict[str, _Cookie] = Field(max_length=_MOST_VISITORS)  # by hash


def _read(store: Path) -> dict[str, _Cookie]:
    if is_missing(store):
        return {}
    try:
        return dict(read_record(_Cookies, store).cookies)
    except UserError as error:
        _LOG.warning("Everybody needs a new link: %s", error)
        return {}


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
