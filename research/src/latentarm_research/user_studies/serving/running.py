"""The drive that is under way: the arm's process, and the application that its Drive page talks to."""

import asyncio
import shutil
import time
from contextlib import AsyncExitStack
from dataclasses import replace
from pathlib import Path
from typing import Final, Self, final

from starlette.applications import Starlette
from starlette.types import Message, Receive, Scope, Send

from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import read_bytes
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.arm_process.process import ControlProcess
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.server_messages import Refused
from latentarm.web.server.app import build_app
from latentarm.web.server.config import TeleopConfig
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.serving.page_drive import RECORD, STEPS, PageDrive, ToDrive
from latentarm_research.user_studies.serving.study_files import DRIVES

RECORD_LIMIT: Final = 1 << 22  # bytes of a drive's record

_LOOK_S: Final = 0.05
_GONE_S: Final = 15.0  # a drive whose page has been closed for so long is broken off, s
_IDLE_S: Final = 600.0  # so much later than its time limit it is broken off too, s
_OVER: Final = Notice(code="drive_over")


@final
class RunningDrive:
    """One drive of a person."""

    def __init__(self, due: ToDrive, app: Starlette, control: ControlProcess, folder: Path) -> None:
        self.due = due
        self._ended = asyncio.Event()
        self._pages = 0  # open sockets of the Drive page
        self._begun_s = self._left_s = time.monotonic()
        self._app = app
        self._control = control
        self._folder = folder
        self._open = AsyncExitStack()

    @classmethod
    async def begin(
        cls, number: int, due: ToDrive, model: Path | None, config: TeleopConfig, key: str
    ) -> Self:
        """Begin a drive of the person with this number. Raises a `UserError` where it cannot be loaded."""
        folder = config.spec.out / DRIVES / key / due.kind
        fixed = PageDrive(due, number, model, folder)
        spec = Spec(seed=due.seed, choice=due.choice, out=folder, incidents=False, fixed=fixed)
        # Access needs are set up in the first practice, and are the same in every condition.
        locked = due.kind == "trial" or due.order > 0

        def build() -> tuple[Starlette, ControlProcess]:
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            control = ControlProcess(spec)
            try:
                served = replace(config, spec=spec, lock_setup=locked)
                return build_app(load_setup(spec), control, served), control
            except BaseException:
                control.end()
                raise

        app, control = await asyncio.to_thread(build)
        drive = cls(due, app, control, folder)
        await drive._open.enter_async_context(app.router.lifespan_context(app))
        return drive

    async def over(self) -> DriveRecord | None:
        """Wait until the drive has ended by itself; None where it was broken off.

        A drive that nobody sees the end of is broken off: the person has closed the page, or has lost the
        network.
        """
        latest_s = self._begun_s + self.due.limit_s + _IDLE_S
        while self._control.alive and time.monotonic() < latest_s:
            if (record := kept_record(self._folder)) is not None:
                return record if self._pages else None
            if not self._pages and time.monotonic() - self._left_s > _GONE_S:
                return None
            await asyncio.sleep(_LOOK_S)
        return None

    @property
    def left_s(self) -> float:
        """How long it may still take, s, if the person sets out at once."""
        return max(self._begun_s + self.due.limit_s - time.monotonic(), 0.0)

    @property
    def steps(self) -> Path:
        """The file of its steps, once it has ended."""
        return self._folder / STEPS

    def stop(self, why: Notice) -> None:
        """Stop the arm."""
        self._control.stop(why)

    async def close(self) -> None:
        """Stop the arm, end its process, and delete what it wrote; pages hear that the drive is over."""
        self.stop(_OVER)
        self._ended.set()
        await self._open.aclose()
        await asyncio.to_thread(self._control.end)
        # With the folder of the person: it has their key.
        await asyncio.to_thread(shutil.rmtree, self._folder.parent, ignore_errors=True)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request of the Drive page, or serve its socket until the drive is over."""
        if scope["type"] != "websocket":
            await self._app(scope, receive, send)
            return
        self._pages += 1
        try:
            await self._app(scope, self._until_over(receive), send)
        finally:
            self._pages -= 1
            self._left_s = time.monotonic()
        if self._ended.is_set():
            await say_over(send)

    def _until_over(self, receive: Receive) -> Receive:
        async def receive_until_over() -> Message:
            waits = [asyncio.ensure_future(one) for one in (receive(), self._ended.wait())]
            done, left = await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
            for one in left:
                one.cancel()
            if waits[0] in done:
                return waits[0].result()  # pyright: ignore[reportReturnType]
            return {"type": "websocket.disconnect", "code": 1001}

        return receive_until_over


async def refuse_socket(receive: Receive, send: Send) -> None:
    """Accept a Drive page's socket, say that the drive is over, and close it."""
    await receive()
    await send({"type": "websocket.accept"})
    await say_over(send)


async def say_over(send: Send) -> None:
    """Tell a Drive page that its drive is over."""
    try:
        await send({"type": "websocket.send", "text": Refused(notice=_OVER).model_dump_json()})
        await send({"type": "websocket.close", "code": 1000})
    except (RuntimeError, OSError):
        return  # the page has gone


def recovered(out: Path) -> list[tuple[str, DriveRecord, Path]]:
    """Trials that a killed server has left in the study's folder: person's key, record, file of the steps."""
    found = [
        (folder.name, kept_record(folder / "trial"), folder / "trial" / STEPS)
        for folder in (out / DRIVES).glob("*")
    ]
    return [(key, record, steps) for key, record, steps in found if record is not None]


def kept_record(folder: Path) -> DriveRecord | None:
    """The record of a drive in its folder; None where it has not ended."""
    path = folder / RECORD
    if not path.exists():
        return None
    try:
        return DriveRecord.model_validate_json(read_bytes(path, RECORD_LIMIT))
    except ValueError as error:
        raise UserError(f"{path} is not the record of a drive: remove it, and it is driven again.") from error
