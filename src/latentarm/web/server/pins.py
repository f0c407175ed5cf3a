"""Which records a visitor may open: those without a PIN, and those whose PIN they have given."""

import secrets
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, final

from latentarm.web.protocol.notice import NoticeError
from latentarm.web.records.people import People, PersonRecord
from latentarm.web.records.pin import fits

TRIES: Final = 5  # wrong PINs of a person that a client may give before it has to wait
WAIT_S: Final = 60.0
"""How long the client then waits, s; doubles with each further one, up to `LONGEST_WAIT_S`."""

LONGEST_WAIT_S: Final = 3600.0

FORGOTTEN_S: Final = 24 * 3600.0  # a client's tries are forgotten so long after its last wrong PIN, s
MOST_CLIENTS: Final = 40
"""Clients that may have given wrong PINs of a person at the same time, besides those that have opened the
record before. Together they try at most 1,400 PINs on the first day and 960 on each further one: all PINs of
four digits take them ten days."""

OPEN_S: Final = 8 * 3600.0  # how long a record stays open, s
_COOKIE: Final = "latentarm_pin_"
_MOST_KEYS: Final = 1000


@dataclass
class _Tries:
    count: int = 0
    not_before_s: float = 0.0
    forgotten_s: float = 0.0


@final
class Pins:
    """Remembers which browsers have given which PIN, until the server ends.

    ``wanted``: whether the host wants PINs. Otherwise nobody is asked: the way out for a forgotten PIN.
    """

    def __init__(self, people: People, *, wanted: bool, now_s: Callable[[], float] = time.monotonic) -> None:
        self.wanted = wanted
        self._people = people
        self._now_s = now_s
        self._lock = threading.Lock()
        self._tries: dict[str, dict[str, _Tries]] = {}
        self._known: dict[tuple[str, str], None] = {}
        self._keys: dict[str, tuple[str, float]] = {}

    def asked(self, person: PersonRecord) -> bool:
        """Whether this record has a PIN that counts."""
        return self.wanted and person.pin is not None

    def opened(self, person: PersonRecord, cookies: Mapping[str, str]) -> bool:
        """Whether a visitor with these cookies may open a record."""
        if not self.asked(person):
            return True
        of, until_s = self._keys.get(cookies.get(cookie_of(person.id), ""), ("", 0.0))
        return of == person.id and self._now_s() < until_s

    def unlock(self, person: PersonRecord, pin: str, client: str) -> str:
        """Open a record; returns the value of its cookie. Takes some 50 ms for the hash.

        ``client`` is an address and a browser. Raises NoticeError if the PIN is wrong, or there were too many
        wrong ones or clients that gave them.
        """
        with self._lock:
            # Counted before it is checked: simultaneous tries count too.
            self._count(person.id, client)
        if person.pin is None or not fits(pin, person.pin):
            raise NoticeError("pin_wrong")
        with self._lock:
            self._tries[person.id].pop(client, None)
            self._known = dict.fromkeys([*self._known, (person.id, client)][-_MOST_KEYS:])
        return self._key(person.id)

    def lock(self, person: str, cookies: Mapping[str, str]) -> None:
        """Close a record for a visitor."""
        self._keys.pop(cookies.get(cookie_of(person), ""), None)

    def change(self, person: str, pin: str | None) -> str:
        """Set or remove a record's PIN, and close the record for all but the visitor with this new cookie.

        Raises UserError if the host wants no PINs, there is no such person, or the record cannot be written.
        """
        if not self.wanted:
            raise NoticeError("request_invalid")
        self._people.keep_pin(person, pin)
        with self._lock:
            self._keys = {key: kept for key, kept in self._keys.items() if kept[0] != person}
        return self._key(person)

    def _count(self, person: str, client: str) -> None:
        now_s = self._now_s()
        counted = {
            one: tries for one, tries in self._tries.get(person, {}).items() if now_s < tries.forgotten_s
        }
        self._tries[person] = counted
        strangers = [tries for one, tries in counted.items() if (person, one) not in self._known]
        not_before_s = 0.0
        if client in counted:
            not_before_s = counted[client].not_before_s
        elif (person, client) not in self._known and len(strangers) >= MOST_CLIENTS:
            not_before_s = min(tries.forgotten_s for tries in strangers)
        if now_s < not_before_s:
            raise NoticeError("pin_wait", seconds=round(not_before_s - now_s + 0.5))
        tries = counted.setdefault(client, _Tries())
        tries.count += 1
        if tries.count >= TRIES:
            tries.not_before_s = now_s + min(WAIT_S * 2 ** (tries.count - TRIES), LONGEST_WAIT_S)
        tries.forgotten_s = now_s + FORGOTTEN_S

    def _key(self, person: str) -> str:
        key = secrets.token_urlsafe(16)
        with self._lock:
            now_s = self._now_s()
            kept = {one: value for one, value in self._keys.items() if value[1] > now_s}
            self._keys = dict([*kept.items()][1 - _MOST_KEYS :])
            self._keys[key] = (person, now_s + OPEN_S)
        return key


def cookie_of(person: str) -> str:
    """Name of the cookie that opens a person's record."""
    return _COOKIE + person
