"""Sightings that any detector posts as JSON to a port of this machine.

Guarded like the page on the loopback: only programs of this machine reach it, and a browser's page of another
site is refused by the ``Host`` and ``Origin`` headers. Nobody gains by posting here who could not open the
page itself; a detector elsewhere comes through an SSH tunnel, which knows who it is.
"""

import json
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, HTTPServer
from typing import Annotated, Any, Final, final
from urllib.parse import parse_qsl

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from scipy.spatial.transform import Rotation

from latentarm.core.errors import UserError
from latentarm.core.types import Pose
from latentarm.surroundings.contract import MOST_HOLD_S, Newest, Sighting, Source

PATH: Final = "/things"
MOST_BYTES: Final = 1 << 16
MOST_THINGS: Final = 64
USUAL_HOLD_S: Final = 2.0
_HOST: Final = "127.0.0.1"
_NAMES: Final = (_HOST, "localhost")
_WAIT_S: Final = 2.0  # for the rest of a request

Number = Annotated[float, Field(allow_inf_nan=False)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


@final
class PostedThing(_Strict):
    """A thing, as a detector posts it."""

    name: str  # as the task names it
    position_m: tuple[Number, Number, Number]  # of its frame in the arm's base frame
    quaternion_wxyz: tuple[Number, Number, Number, Number] = (1.0, 0.0, 0.0, 0.0)
    position_sd_m: Number  # standard deviation of each coordinate
    orientation_sd_rad: Number = float(np.pi)  # about each axis; pi: it cannot tell how the thing is turned
    age_s: Annotated[float, Field(ge=0.0, le=MOST_HOLD_S)] = 0.0  # since the picture was taken


@final
class Posted(_Strict):
    """The body of a POST to `PATH`."""

    things: Annotated[tuple[PostedThing, ...], Field(max_length=MOST_THINGS)]


class _RefusedError(Exception):
    def __init__(self, status: int, sentence: str) -> None:
        super().__init__(sentence)
        self.status = status


@final
class HttpSource(Source):
    """Takes what is posted to a port of the loopback.

    Raises UserError if the port is taken.
    """

    def __init__(self, port: int, names: Sequence[str], hold_s: float) -> None:
        self._names, self.hold_s = tuple(names), hold_s
        self._newest = Newest()
        source = self

        @final
        class Handler(BaseHTTPRequestHandler):
            timeout = _WAIT_S

            def do_POST(self) -> None:
                try:
                    source.take(self)
                except _RefusedError as refused:
                    body = json.dumps({"detail": str(refused)}).encode()
                    self.send_response(refused.status)
                    self.send_header("content-type", "application/json")
                    self.send_header("content-length", str(len(body)))
                    self.end_headers()
                    self.wfile.write(body)
                else:
                    self.send_response(204)
                    self.end_headers()

            def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - the library's name
                """Nothing: what strangers send is not written to the terminal."""

        try:
            self._server = HTTPServer((_HOST, port), Handler)
        except (OSError, OverflowError) as error:
            raise UserError(
                f"--objects http:{port} cannot be opened: {error}. Choose another port."
            ) from error
        self.port = int(self._server.server_address[1])
        threading.Thread(target=self._server.serve_forever, name="objects by http", daemon=True).start()

    def read(self) -> Sequence[Sighting]:
        return self._newest.take()

    def close(self) -> None:
        with suppress(OSError):
            self._server.shutdown()
            self._server.server_close()

    def take(self, request: BaseHTTPRequestHandler) -> None:
        """Take one request; raises `_RefusedError` with a status and a sentence."""
        headers = request.headers
        if headers.get_all("host") not in [[f"{name}:{self.port}"] for name in _NAMES] or "origin" in headers:
            raise _RefusedError(403, "Only programs of this machine post here, and no browser.")
        if request.path != PATH:
            raise _RefusedError(404, f"Post to {PATH}.")
        length = headers.get("content-length", "")
        if not (length.isascii() and length.isdigit() and len(length) < 9 and int(length) <= MOST_BYTES):
            raise _RefusedError(413, f"State the body's length, at most {MOST_BYTES} bytes.")
        try:
            posted = Posted.model_validate_json(request.rfile.read(int(length)))
            now_s = time.monotonic()
            seen = [self._sighting(thing, now_s) for thing in posted.things]
        except OSError as error:
            raise _RefusedError(400, "The body did not come in time.") from error
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            where = ".".join(str(part) for part in first["loc"]) or "The body"
            raise _RefusedError(
                400 if first["type"] == "json_invalid" else 422, f"{where}: {first['msg']}."
            ) from error
        except UserError as error:
            raise _RefusedError(422, str(error)) from error
        self._newest.put(seen)

    def _sighting(self, thing: PostedThing, now_s: float) -> Sighting:
        if thing.name not in self._names:
            raise UserError(f"There is no thing {thing.name[:40]!r}; there is: {', '.join(self._names)}.")
        if not np.isclose(np.linalg.norm(thing.quaternion_wxyz), 1.0, atol=1e-3):
            raise UserError(f"The quaternion of {thing.name!r} must have the length 1.")
        return Sighting(
            thing.name,
            Pose(
                np.array(thing.position_m),
                Rotation.from_quat(thing.quaternion_wxyz, scalar_first=True).as_matrix(),
            ),
            now_s - thing.age_s,
            thing.position_sd_m,
            thing.orientation_sd_rad,
        )


def open_http(rest: str, names: Sequence[str]) -> Source:
    """Open ``PORT`` or ``PORT?hold_s=SECONDS``."""
    port, _, query = rest.partition("?")
    try:
        options = dict(parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query)))
        number, hold_s = int(port), float(options.pop("hold_s", USUAL_HOLD_S))
    except ValueError as error:
        raise UserError(
            f"--objects http:{rest} is not understood: write http:PORT, as in http:8470."
        ) from error
    if options or not 0.1 <= hold_s <= MOST_HOLD_S or not 0 <= number <= 65535:
        raise UserError(
            f"--objects http:{rest}: write http:PORT?hold_s=SECONDS, with 0.1 to {MOST_HOLD_S:g} s."
        )
    return HttpSource(number, names, hold_s)
