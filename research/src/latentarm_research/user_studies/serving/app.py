"""The server of a study: the participants' pages, and the Drive page of each who drives."""

import asyncio
import logging
import secrets
import shutil
import time
from collections.abc import AsyncGenerator, Awaitable, Callable
from contextlib import asynccontextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Final, final

from pydantic import Field
from sqlalchemy.exc import DBAPIError
from starlette.applications import Starlette
from starlette.datastructures import Headers
from starlette.requests import HTTPConnection, Request
from starlette.responses import FileResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import Route
from starlette.types import Receive, Scope, Send

from latentarm.core.errors import UserError
from latentarm.web.protocol.notice import Message, Notice
from latentarm.web.server.answers import NO_STORE, body_of, json_answer
from latentarm.web.server.assets import Assets
from latentarm.web.words.catalogue import COOKIE as LANGUAGE_COOKIE
from latentarm_research.user_studies.answers.items import wrong_answer
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.serving.device import Device, echo, shortfalls
from latentarm_research.user_studies.serving.links import link_of
from latentarm_research.user_studies.serving.models import Models
from latentarm_research.user_studies.serving.options import Serving
from latentarm_research.user_studies.serving.page_drive import ToDrive
from latentarm_research.user_studies.serving.participant_pages import (
    FILES,
    HOME,
    ParticipantPages,
    answer_file,
    own_data,
)
from latentarm_research.user_studies.serving.queue import Queue
from latentarm_research.user_studies.serving.request_limit import RequestLimit
from latentarm_research.user_studies.serving.running import RunningDrive, recovered, refuse_socket
from latentarm_research.user_studies.serving.servers import BEAT_S, Servers
from latentarm_research.user_studies.serving.store import Standing, Store
from latentarm_research.user_studies.serving.study_files import (
    DRIVES,
    forget,
    forget_strangers,
    keep_steps,
    steps_of,
    write_links,
)
from latentarm_research.user_studies.serving.way import Next, ToAnswer, Way

COOKIE: Final = "latentarm_study"
_READING: Final = ("GET", "HEAD")
_LOG: Final = logging.getLogger(__name__)


@final
class Consented(Message):
    """Somebody consents."""

    digest: str  # of the text that the page has shown


@final
class Understood(Message):
    """Somebody has answered the questions about the information."""

    answers: dict[str, str]  # number of an option by question


@final
class Compared(Message):
    """Somebody compares the ways of driving that they have met."""

    answers: dict[str, int]  # place of the chosen one in their order, from 1, by question


@final
class Answered(Message):
    """Somebody has answered the questions after a condition."""

    order: Annotated[int, Field(ge=0)]
    answers: dict[str, int | str]  # by item; one that is absent was left out


@final
class StudyServer:
    """The application of a study. Each participant who drives has an arm of their own."""

    def __init__(self, serving: Serving, store: Store, models: Models, servers: Servers) -> None:
        self._serving = serving
        self._store = store
        self._models = models
        self._servers = servers
        self._way = Way(serving.definition, serving.sizes, serving.kept.seed)
        assets = Assets()
        self._pages = ParticipantPages(serving, self._way, assets)
        self._drives: dict[str, RunningDrive] = {}  # by the person's key
        self._met: set[str] = set()  # keys that are somebody's
        self._limit = RequestLimit()
        self._queue = Queue(serving.at_once)
        self._following: set[asyncio.Task[None]] = set()
        self._changing = asyncio.Lock()
        posts = (
            self.consent,
            self.device,
            self.comprehension,
            self.begin,
            self.ready,
            self.answers,
            self.compare,
            self.withdraw,
        )
        self._app = Starlette(
            routes=[
                Route(HOME, self._home),
                *(Route(f"{HOME}/{do.__name__}", self._known(do), methods=["POST"]) for do in posts),
                Route(f"{HOME}/data", self._known(self.data)),
                Route(f"{HOME}/steps/{{name}}", self._known(self.steps)),
                *(Route(f"{HOME}/{name}", answer_file) for name in FILES),
                Route("/static/{version}/{name:path}", assets.answer),
            ],
            lifespan=self._life,
        )

    def stop(self, headers: Headers) -> None:
        """Stop the arm of the person whose browser asks."""
        key = HTTPConnection({"type": "http", "headers": headers.raw}).cookies.get(COOKIE, "")
        if (drive := self._drives.get(key)) is not None:
            drive.stop(Notice(code="stop_pressed"))

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve the participants' pages, and those of a drive to the participant who drives."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        connection = HTTPConnection(scope)
        key = connection.cookies.get(COOKIE, "")
        if scope["type"] == "http" and not self._limit.allows(connection, key if key in self._met else ""):
            await self._refused("study.refused.often", 429)(scope, receive, send)
            return
        if scope["path"].startswith((HOME, "/static/")):
            await self._app(scope, receive, send)
            return
        if scope["type"] == "websocket":
            await self._socket(key, scope, receive, send)
        elif (drive := self._drives.get(key)) is not None and scope["method"] in _READING:
            await drive(scope, receive, send)
        else:
            home = scope["path"] == "/" and scope["method"] in _READING
            answer = RedirectResponse(HOME, 303) if home else PlainTextResponse("There is no such page.", 404)
            await answer(scope, receive, send)

    async def _socket(self, key: str, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve the socket of a drive, or that of the check of a device."""
        if (drive := self._drives.get(key)) is not None:
            await drive(scope, receive, send)
        elif (standing := self._store.standing(key)) is not None and self._way.after(standing) == "device":
            await echo(scope, receive, send)
        else:
            await refuse_socket(receive, send)

    @asynccontextmanager
    async def _life(self, _: Starlette) -> AsyncGenerator[None]:
        # Drives that had ended when the server was killed are kept; those under way are driven again.
        out = self._serving.out
        for key, record, steps in recovered(out):
            self._keep(key, record, steps)
        shutil.rmtree(out / DRIVES, ignore_errors=True)
        beating = asyncio.create_task(self._beat())
        try:
            yield
        finally:
            beating.cancel()
            await asyncio.to_thread(self._servers.leave)
            async with self._changing:
                for key in list(self._drives):
                    await self._end_drive(key)

    async def _beat(self) -> None:
        """Tell the other servers that this one is up, and remove what they have deleted."""
        out, listed = self._serving.out, list[str]()
        while True:
            try:
                await asyncio.to_thread(self._servers.announce, time.time())
                known, codes = await asyncio.to_thread(self._store.present)
                await asyncio.to_thread(forget_strangers, out, known)
                if listed and codes != listed:
                    write_links(out, self._servers.address, codes)
                listed = codes
            except (DBAPIError, UserError) as error:
                why = error.orig if isinstance(error, DBAPIError) else error
                _LOG.warning("The study's database or its list of links cannot be used: %s", why)
            await asyncio.sleep(BEAT_S)

    def _known(self, do: Callable[[Request, str], Awaitable[Response]]) -> Callable[..., Awaitable[Response]]:
        """A request of a participant; one that cannot be met is answered by a sentence."""

        async def answer(request: Request) -> Response:
            key = request.cookies.get(COOKIE, "")
            if self._store.standing(key) is None:
                return self._refused("study.link", 403)
            self._met.add(key)
            try:
                return await do(request, key)
            except UserError as error:
                return _problem(str(error), 400)

        return answer

    async def _home(self, request: Request) -> Response:
        if "left" in request.query_params:
            return self._pages.page("left")
        try:
            link, visit = link_of(request.query_params, self._serving.kept.prolific, self._serving.words)
        except UserError as error:
            return self._pages.page("unknown", status=404, problem=str(error))
        if link:
            return await self._arrive(request, link, visit)
        standing = self._store.standing(request.cookies.get(COOKIE, ""))
        if standing is None:
            return self._pages.page("unknown", status=404)
        self._met.add(standing.key)
        return await self._next_page(standing)

    async def _arrive(self, request: Request, link: str, visit: str) -> Response:
        key = self._store.arrive(link, visit, time.time())
        if key is None:
            return self._pages.page("unknown", status=404)
        if (other := await asyncio.to_thread(self._servers.elsewhere, key, time.time())) is not None:
            return RedirectResponse(f"{other}?{request.url.query}", 303, headers=NO_STORE)
        self._met.add(key)
        answer = RedirectResponse(HOME, 303, headers=NO_STORE)
        secure = self._serving.config.encrypted
        life_s = 90 * 86400
        # Lax: people come from the page of another site.
        answer.set_cookie(COOKIE, key, max_age=life_s, secure=secure, httponly=True, samesite="lax")
        # The Drive page begins in the study's language, whatever the browser prefers.
        language = self._serving.words.language
        answer.set_cookie(LANGUAGE_COOKIE, language, max_age=life_s, secure=secure, samesite="strict")
        return answer

    async def _next_page(self, standing: Standing) -> Response:
        key = standing.key
        if standing.consented and standing.completion is None:
            if await asyncio.to_thread(self._store.place, key, time.time()) is None:
                return self._pages.page("lapsed" if standing.lapsed else "full")
            standing = self._store.standing(key) or standing
        due = self._way.after(standing)
        if due == "finished":
            code = self._store.finish(key, self._serving.kept.completion_code or secrets.token_hex(4).upper())
            return self._pages.page("finished", code=code)
        if due == "consent":
            return self._pages.consent()
        if due == "device":
            return self._pages.device(standing.device)
        if due == "compare":
            return self._pages.compare(standing.number or 0)
        if due == "comprehension":
            return self._pages.comprehension(again=bool(standing.comprehension))
        return self._pages.due(due, standing, running=key in self._drives)

    async def consent(self, request: Request, key: str) -> Response:
        """Note that they consent."""
        given = await body_of(request, Consented)
        if given.digest == self._serving.kept.information:
            when = datetime.now(UTC).isoformat(timespec="seconds")
            await asyncio.to_thread(self._store.consent, key, given.digest, when)
        return _onward(HOME)

    async def device(self, request: Request, key: str) -> Response:
        """Judge and keep the results of the check of their device."""
        found = await body_of(request, Device)
        due, _ = self._due(key)
        if due == "device":
            short = list(shortfalls(self._serving.definition.device, found, self._serving.words))
            await asyncio.to_thread(
                self._store.keep_device, key, found.model_dump(mode="json"), passed=not short
            )
        return _onward(HOME)

    async def comprehension(self, request: Request, key: str) -> Response:
        """Check what they have understood of the information."""
        given = (await body_of(request, Understood)).answers
        asked = {one.name: one for one in self._serving.definition.comprehension}
        options = {name: [str(one) for one in range(1, len(asked[name].options) + 1)] for name in asked}
        if any(option not in options.get(name, ()) for name, option in given.items()):
            return self._refused("study.refused.answers", 400)
        due, _ = self._due(key)
        if due == "comprehension":
            right = given == {name: str(one.attention) for name, one in asked.items()}
            await asyncio.to_thread(self._store.keep_comprehension, key, given, right=right)
        return _onward(HOME)

    async def begin(self, _: Request, key: str) -> Response:
        """Begin the drive that is due, or go on with it."""
        async with self._changing:
            due, standing = self._due(key)
            if not isinstance(due, ToDrive) or standing.number is None:
                return _onward(HOME)
            if key in self._drives and self._drives[key].due != due:
                await self._end_drive(key)
            if key not in self._drives:
                left_s = [drive.left_s for drive in self._drives.values()]
                if waits_s := self._queue.waits_s(key, due.limit_s, left_s):
                    return json_answer({"waits_s": round(waits_s)}, 503)
                model = self._models.folder(due.condition, due.task)
                drive = await RunningDrive.begin(standing.number, due, model, self._serving.config, key)
                self._drives[key] = drive
                following = asyncio.create_task(self._follow(key, drive))
                self._following.add(following)
                following.add_done_callback(self._following.discard)
        return _onward("/")

    async def _follow(self, key: str, drive: RunningDrive) -> None:
        """Keep the record of a drive when it ends by itself, and close it."""
        record = await drive.over()
        async with self._changing:
            if self._drives.get(key) is not drive:
                return
            if record is not None and drive.due.kind == "trial":
                await asyncio.to_thread(self._keep, key, record, drive.steps)
            await self._end_drive(key)

    def _keep(self, key: str, record: DriveRecord, steps: Path) -> None:
        """Keep a drive and the file of its steps."""
        if self._store.keep_drive(key, record):
            keep_steps(self._serving.out, key, record, steps)

    async def _end_drive(self, key: str) -> None:
        """Close a person's drive, if one is under way."""
        if (drive := self._drives.pop(key, None)) is not None:
            await drive.close()

    async def ready(self, _: Request, key: str) -> Response:
        """End the practice."""
        async with self._changing:
            due, _standing = self._due(key)
            if isinstance(due, ToDrive) and due.kind == "practice":
                await self._end_drive(key)
                await asyncio.to_thread(self._store.practised, key, due.order + 1)
        return _onward(HOME)

    async def answers(self, request: Request, key: str) -> Response:
        """Keep answers."""
        given = await body_of(request, Answered)
        due, _ = self._due(key)
        if not isinstance(due, ToAnswer) or given.order != due.order:
            return self._refused("study.refused.questions", 409)
        definition = self._serving.definition
        if any(
            item not in due.items or wrong_answer(definition, item, answer)
            for item, answer in given.answers.items()
        ):
            return self._refused("study.refused.answers", 400)
        await asyncio.to_thread(self._store.keep_answers, key, due.order, due.condition.name, given.answers)
        return _onward(HOME)

    async def compare(self, request: Request, key: str) -> Response:
        """Keep the conditions that they chose in the comparison."""
        given = (await body_of(request, Compared)).answers
        due, standing = self._due(key)
        if due != "compare" or standing.number is None:
            return self._refused("study.refused.questions", 409)
        met = self._way.order(standing.number)
        asked = {one.name for one in self._serving.definition.comparison}
        if not (given.keys() <= asked and all(1 <= way <= len(met) for way in given.values())):
            return self._refused("study.refused.answers", 400)
        chosen = {name: met[way - 1] for name, way in given.items()}
        await asyncio.to_thread(self._store.keep_answers, key, len(met), "", chosen)
        return _onward(HOME)

    async def data(self, _: Request, key: str) -> Response:
        """See `own_data`; with the addresses of the steps of their drives."""
        kept = own_data(await asyncio.to_thread(self._store.everything, key))
        steps = [f"{HOME}/steps/{path.name}" for path in steps_of(self._serving.out, key)]
        answer = json_answer({**kept, "steps": steps})
        answer.headers["content-disposition"] = 'attachment; filename="my-data.json"'
        return answer

    async def steps(self, request: Request, key: str) -> Response:
        """The steps of one of their drives."""
        named = {path.name: path for path in steps_of(self._serving.out, key)}
        path = named.get(request.path_params["name"])
        return self._refused("study.refused.drive", 404) if path is None else FileResponse(path)

    async def withdraw(self, _: Request, key: str) -> Response:
        """Delete everything about them."""
        async with self._changing:
            await self._end_drive(key)
            gone = await asyncio.to_thread(self._store.withdraw, key)
            await asyncio.to_thread(forget, self._serving.out, gone)
        answer = _onward(f"{HOME}?left")
        answer.delete_cookie(COOKIE)
        return answer

    def _due(self, key: str) -> tuple[Next, Standing]:
        standing = self._store.standing(key)
        if standing is None:
            raise UserError(self._serving.words.say("study.link"))
        return self._way.after(standing), standing

    def _refused(self, key: str, status: int) -> Response:
        return _problem(self._serving.words.say(key), status)


def _onward(to: str) -> Response:
    return json_answer({"to": to})


def _problem(why: str, status: int) -> Response:
    return json_answer({"problem": why}, status)
