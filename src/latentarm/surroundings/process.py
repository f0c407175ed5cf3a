"""The process in which sources look for things, apart from the arm's loop and the web server.

`run_sources` runs in it. `SourceProcess` is the side that starts it; `Inbox` is the loop's. What comes from
there is JSON: strangers wrote what is decoded there, so nothing is unpickled.
"""

import json
import multiprocessing
import os
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Final, final

from latentarm.core.child_processes import start_child
from latentarm.core.errors import UserError
from latentarm.core.exact_json import of_json, to_json
from latentarm.core.types import Pose
from latentarm.core.untrusted.terminal import one_line
from latentarm.surroundings.catalogue import open_source
from latentarm.surroundings.contract import MOST_HOLD_S, Sighting, Source

OPENED_WITHIN_S: Final = 30.0
_PERIOD_S: Final = 0.02
_LONGEST: Final = 4096  # bytes of a message: short enough that a pipe takes it whole or not at all
_MOST_AT_ONCE: Final = 50
_LOWER_PRIORITY: Final = 5


def run_sources(texts: Sequence[str], names: Sequence[str], sightings: Connection, owner: Connection) -> None:
    """Open sources, send what they see, and end when ``owner`` is closed at the other end."""
    with suppress(OSError, AttributeError):
        os.nice(_LOWER_PRIORITY)
    os.set_blocking(sightings.fileno(), False)
    opened: dict[str, Source] = {}
    try:
        for text in texts:
            opened[text] = open_source(text, names)
        owner.send_bytes(b"")
        while not owner.poll(_PERIOD_S):
            for text in list(opened):
                _send_all(text, opened, sightings)
    except UserError as error:
        owner.send_bytes(one_line(str(error)).encode())
    finally:
        for source in opened.values():
            source.close()


def _send_all(text: str, opened: dict[str, Source], sightings: Connection) -> None:
    source = opened[text]
    try:
        seen = source.read()
    except Exception as error:  # noqa: BLE001 - whatever a source does, the others go on
        sys.stderr.write(f"latentarm: --objects {text} has ended: {one_line(repr(error))}\n")
        source.close()
        del opened[text]
        return
    for sighting in seen:
        # A loop that does not read loses sightings: they would be old by the time that it does.
        with suppress(OSError):
            sightings.send_bytes(as_message(sighting, text, min(source.hold_s, MOST_HOLD_S)))


@final
class SourceProcess:
    """Sources, opened in a process of their own; ``sightings`` is for the loop's `Inbox`.

    Raises UserError where one cannot be opened.
    """

    def __init__(self, texts: Sequence[str], names: Sequence[str]) -> None:
        self.sightings, writing = multiprocessing.Pipe(duplex=False)
        self._owner, theirs = multiprocessing.Pipe()
        self._process = start_child(run_sources, (texts, names, writing, theirs), "latentarm objects")
        writing.close()
        theirs.close()
        refused = "The sources of --objects did not open in time."
        with suppress(EOFError):
            if self._owner.poll(OPENED_WITHIN_S):
                refused = self._owner.recv_bytes().decode()
        if refused:
            self.end()
            raise UserError(refused)

    def end(self) -> None:
        """End the process."""
        self._owner.close()
        self._process.join(1.0)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


@final
class Inbox:
    """Sightings as they come from a `SourceProcess`, for the loop; it never waits."""

    def __init__(self, sightings: Connection) -> None:
        self._sightings: Connection | None = sightings

    def read(self, now_s: float) -> list[tuple[Sighting, str, float]]:
        """New ones, oldest first, at most `_MOST_AT_ONCE`; times are on the clock that reads ``now_s``.

        Each is with the text that named its source, and how long it counts, s.
        """
        found: list[tuple[Sighting, str, float]] = []
        ahead_s = now_s - time.monotonic()
        while self._sightings is not None and len(found) < _MOST_AT_ONCE:
            try:
                if not self._sightings.poll(0):
                    break
                message = json.loads(self._sightings.recv_bytes(_LONGEST))
                seen, source, hold_s = of_json(message, Sighting, Pose)
                figures = seen.time_s + ahead_s, seen.position_sd_m, seen.orientation_sd_rad
                sighting = Sighting(str(seen.name), seen.pose, *map(float, figures))
                found.append((sighting, str(source), float(hold_s)))
            except (OSError, EOFError):
                self._sightings = None  # its process has ended: what it saw grows old
            except (ValueError, TypeError, AttributeError, UserError):
                continue
        return found


def as_message(sighting: Sighting, source: str, hold_s: float) -> bytes:
    """A sighting as it is sent to an `Inbox`."""
    return json.dumps(to_json((sighting, source, hold_s))).encode()
