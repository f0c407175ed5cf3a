"""The process of the cameras: it decodes and encodes apart from the arm and the web server.

`run_cameras` runs in it. `CameraProcess` is the web server's side. They exchange short JSON texts: strangers
wrote what is decoded there, so nothing from there is unpickled.
"""

import asyncio
import json
import logging
import multiprocessing
import os
import threading
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from multiprocessing.connection import Connection
from typing import Any, Final, final

from latentarm.cameras.sources import CameraSource
from latentarm.core.child_processes import start_child
from latentarm.core.errors import UserError
from latentarm.core.untrusted.terminal import one_line
from latentarm.web.protocol.notice import NoticeError

MOST_VIEWERS: Final = 4  # pages that may watch the cameras at once: pictures are encoded for each
CHECKED_WITHIN_S: Final = 20.0
ANSWER_WITHIN_S: Final = 5.0

_REST_S: Final = 3.0
_LOWER_PRIORITY: Final = 5
_LONGEST: Final = 1 << 17


def run_cameras(sources: Sequence[CameraSource], pipe: Connection, host: str) -> None:
    """Serve the cameras until the web server is gone, listening on the address ``host`` alone."""
    with suppress(OSError, AttributeError):
        os.nice(_LOWER_PRIORITY)
    # What goes wrong with one page is shown on that page; aiortc would also quote what strangers sent.
    logging.disable(logging.CRITICAL)
    asyncio.run(_Desk(sources, pipe, host).serve())


@final
class _Desk:
    def __init__(self, sources: Sequence[CameraSource], pipe: Connection, host: str) -> None:
        from latentarm.cameras.decoding import open_pictures
        from latentarm.web.cameras.camera import Camera
        from latentarm.web.cameras.viewer import OfferError, Viewer, listen_only_on

        listen_only_on(host)
        self._sources = sources
        self._pipe = pipe
        self._make_camera = Camera
        self._open = open_pictures
        self._make_viewer = Viewer
        self._bad_offer = OfferError
        self._viewers: dict[str, Viewer] = {}
        self._closing: set[asyncio.Task[None]] = set()

    async def serve(self) -> None:
        loop = asyncio.get_running_loop()
        self._cameras = [self._make_camera(source, self._open, loop) for source in self._sources]
        asked: asyncio.Queue[dict[str, Any] | None] = asyncio.Queue()

        def listen() -> None:
            with suppress(EOFError, OSError, RuntimeError):
                while True:
                    message = json.loads(self._pipe.recv_bytes(_LONGEST))
                    loop.call_soon_threadsafe(asked.put_nowait, message)
            with suppress(RuntimeError):
                loop.call_soon_threadsafe(asked.put_nowait, None)

        threading.Thread(target=listen, daemon=True).start()
        while (order := await asked.get()) is not None:
            match order:
                case {"order": "check"}:
                    self._say({"refused": await asyncio.to_thread(self._check)})
                case {"order": "answer", "number": number, "page": page, "offer": offer}:
                    self._say({"number": number, **await self._answer(page, offer)})
                case {"order": "leave", "page": page}:
                    self._leave(page)
                case {"order": "ages", "number": number}:
                    ages = {one.source.name: one.age_s for one in self._cameras}
                    self._say({"number": number, "ages": ages})
                case _:
                    pass
        for camera in self._cameras:
            camera.end()

    def _check(self) -> str | None:
        from latentarm.web.cameras.camera import check_camera

        with ThreadPoolExecutor(len(self._sources)) as threads:
            said = threads.map(partial(check_camera, open_pictures=self._open), self._sources)
            return next((sentence for sentence in said if sentence is not None), None)

    async def _answer(self, page: str, offer: str) -> dict[str, str]:
        self._leave(page)
        if len(self._viewers) >= MOST_VIEWERS:
            return {"failed": "cameras_full"}
        viewer = self._viewers[page] = self._make_viewer(self._cameras, lambda: self._leave(page, viewer))
        try:
            async with asyncio.timeout(ANSWER_WITHIN_S):
                return {"answer": await viewer.answer(offer)}
        except (self._bad_offer, TimeoutError):
            self._leave(page, viewer)
            return {"failed": "request_invalid"}

    def _leave(self, page: str, viewer: Any = None) -> None:
        found = self._viewers.get(page)
        if found is None or (viewer is not None and found is not viewer):
            return
        del self._viewers[page]
        task = asyncio.create_task(found.close())
        self._closing.add(task)
        task.add_done_callback(self._closing.discard)

    def _say(self, message: Mapping[str, object]) -> None:
        with suppress(OSError):
            self._pipe.send_bytes(json.dumps(message).encode())


@final
class CameraProcess:
    """The cameras for the web server; ``host`` is the page's numeric address.

    Raises UserError if a camera cannot be opened, or gives no picture.
    """

    def __init__(self, sources: Sequence[CameraSource], host: str) -> None:
        self.sources = tuple(sources)
        self._host = host
        self._number = 0
        # One at a time, and never the loop that the arm is driven through.
        self._thread = ThreadPoolExecutor(1, "cameras")
        self._start()
        self._pipe.send_bytes(json.dumps({"order": "check"}).encode())
        said = self._heard("refused", CHECKED_WITHIN_S)
        if said is None or said["refused"] is not None:
            self.end()
            raise UserError(
                "The cameras give no picture in time." if said is None else one_line(said["refused"])
            )

    async def answer(self, page: str, offer: str) -> str:
        """Answer a page's WebRTC session description with ours.

        Raises NoticeError if too many pages are watching, the offer is invalid, or the process of the cameras
        has just ended.
        """
        return await asyncio.get_running_loop().run_in_executor(self._thread, self._answer, page, offer)

    async def ages_s(self) -> dict[str, float]:
        """Ages of the newest pictures, s, by the name of the camera, of those that somebody watches."""
        said = await asyncio.get_running_loop().run_in_executor(self._thread, self._ask, {"order": "ages"})
        ages: dict[str, float | None] = {} if said is None else said["ages"]
        return {name: age_s for name, age_s in ages.items() if age_s is not None}

    def leave(self, page: str) -> None:
        """End a page's view; returns at once."""
        self._thread.submit(self._send, {"order": "leave", "page": page})

    def end(self) -> None:
        self._thread.shutdown(wait=False, cancel_futures=True)
        self._pipe.close()
        self._process.join(1.0)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()

    def _start(self) -> None:
        self._pipe, theirs = multiprocessing.Pipe()
        self._started_s = time.monotonic()
        self._process = start_child(run_cameras, (self.sources, theirs, self._host), "latentarm cameras")
        theirs.close()

    def _answer(self, page: str, offer: str) -> str:
        if not self._process.is_alive():
            # A decoder may break on what a camera sends; the arm goes on, and so do the cameras.
            if time.monotonic() - self._started_s < _REST_S:
                raise NoticeError("cameras_gone")
            self._pipe.close()
            self._start()
        said = self._ask({"order": "answer", "page": page, "offer": offer})
        if said is None:
            raise NoticeError("cameras_gone")
        if "answer" in said:
            return str(said["answer"])
        raise NoticeError("cameras_full" if said.get("failed") == "cameras_full" else "request_invalid")

    def _ask(self, question: Mapping[str, object]) -> dict[str, Any] | None:
        self._number += 1
        sent = self._send({**question, "number": self._number})
        return self._heard("number", ANSWER_WITHIN_S) if sent else None

    def _send(self, message: Mapping[str, object]) -> bool:
        try:
            self._pipe.send_bytes(json.dumps(message).encode())
        except (OSError, ValueError):
            return False
        return True

    def _heard(self, key: str, within_s: float) -> dict[str, Any] | None:
        """The answer to the newest question; older ones were late."""
        end_s = time.monotonic() + within_s
        try:
            while self._pipe.poll(max(0.0, end_s - time.monotonic())):
                said = json.loads(self._pipe.recv_bytes(_LONGEST))
                if key in said and said.get("number", self._number) == self._number:
                    return said
        except (EOFError, OSError, ValueError):
            pass
        return None
