"""The addresses under ``/records/people``: people, their settings and PINs, export and import.

Requests are JSON objects with known fields; answers are JSON, or a notice with a status of 4xx. The gate has
checked the origin and the length of each request.
"""

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import date
from typing import Annotated, Final, final

from pydantic import Field, RootModel
from starlette.background import BackgroundTask
from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import Route

from latentarm.core.untrusted.names import file_words
from latentarm.web.protocol.notice import Message, NoticeError
from latentarm.web.records.drive_record import DriveRecord
from latentarm.web.records.drives import Wanted
from latentarm.web.records.people import PersonRecord, Settings
from latentarm.web.records.pin import PIN
from latentarm.web.records.record_files import new_id
from latentarm.web.records.records import Records
from latentarm.web.server.answers import NO_STORE, body_of, json_answer, refused, routes_of
from latentarm.web.server.history import History
from latentarm.web.server.pins import OPEN_S, Pins, cookie_of
from latentarm.web.server.security import COOKIE
from latentarm.web.server.setup_lock import SetupLock

IMPORT: Final = "/records/import"
"""Takes longer bodies than other addresses: see `latentarm.web.records.person_zip.IMPORT_LIMIT`."""


class _Named(Message):
    name: Annotated[str, Field(max_length=2000)]


class _Pinned(Message):
    pin: Annotated[str, Field(pattern=PIN)] | None


_BROWSER: Final = "latentarm_browser"
"""Cookie that tells browsers of this machine apart if the gate gives none."""


@final
@dataclass(eq=False)
class PeopleRoutes:
    """Answers requests about people.

    ``busy``: whether the arm is enabled for a person, or with their profile. ``let_go`` drops a person's
    profile from the arm before the person is deleted.
    """

    _records: Records
    _history: History
    _busy: Callable[[PersonRecord], bool]
    _let_go: Callable[[PersonRecord], None]
    _pins: Pins
    _lock_of_setup: SetupLock

    def routes(self) -> list[Route]:
        answers = {
            "/records/people": {"GET": self._people, "POST": self._add},
            "/records/people/{person}": {"GET": self._person, "PUT": self._rename, "DELETE": self._erase},
            "/records/people/{person}/settings": {"PUT": self._keep_settings},
            "/records/people/{person}/pin": {"PUT": self._keep_pin},
            "/records/people/{person}/unlock": {"POST": self._unlock},
            "/records/people/{person}/lock": {"POST": self._lock},
            "/records/people/{person}/export": {"GET": self._export},
            IMPORT: {"POST": self._import},
        }
        return routes_of(answers)

    async def _people(self, _: Request) -> Response:
        await self._history.settled()
        drives = self._records.drives.wanted(Wanted())
        return json_answer(
            {
                "people": [
                    {**_shown(person), "pin": self._pins.asked(person), **_history_of(person, drives)}
                    for person in self._records.people.all()
                ],
                "pins": self._pins.wanted,
                "problems": [problem.model_dump() for problem in self._records.people.problems],
            }
        )

    async def _add(self, request: Request) -> Response:
        named = await body_of(request, _Named)
        return json_answer(_shown(await asyncio.to_thread(self._records.people.add, named.name)), 201)

    async def _person(self, request: Request) -> Response:
        person = self._found(request)
        contents = await asyncio.to_thread(self._records.contents, person.id)
        return json_answer({**_shown(person), "settings": person.settings, **contents})

    def _found(self, request: Request) -> PersonRecord:
        """The person whom a request names, if the visitor may open their record."""
        person = self._named(request)
        if not self._pins.opened(person, request.cookies):
            raise NoticeError("pin_needed", name=person.name)
        return person

    def _named(self, request: Request) -> PersonRecord:
        return self._records.people.known(request.path_params["person"])

    async def _unlock(self, request: Request) -> Response:
        given, person = await body_of(request, _Pinned), self._named(request)
        session = request.cookies.get(COOKIE)
        browser = session or request.cookies.get(_BROWSER) or new_id()
        client = f"{request.client and request.client.host} {browser}"
        try:
            key = await asyncio.to_thread(self._pins.unlock, person, given.pin or "", client)
            answer = _with_key(request, person.id, key)
        except NoticeError as error:
            answer = refused(request, error)
        if session is None:
            answer.set_cookie(_BROWSER, browser, httponly=True, samesite="strict")
        return answer

    async def _lock(self, request: Request) -> Response:
        self._pins.lock(self._named(request).id, request.cookies)
        return Response(status_code=204, headers=NO_STORE)

    async def _keep_pin(self, request: Request) -> Response:
        person, given = self._found(request), await body_of(request, _Pinned)
        key = await asyncio.to_thread(self._pins.change, person.id, given.pin)
        return _with_key(request, person.id, key)

    async def _rename(self, request: Request) -> Response:
        named, person = await body_of(request, _Named), self._found(request)
        return json_answer(
            _shown(await asyncio.to_thread(self._records.people.rename, person.id, named.name))
        )

    async def _keep_settings(self, request: Request) -> Response:
        settings, person = await body_of(request, RootModel[Settings]), self._found(request)
        if self._lock_of_setup.on:
            raise NoticeError("setup_locked")
        await asyncio.to_thread(self._records.people.keep_settings, person.id, settings.root)
        return Response(status_code=204, headers=NO_STORE)

    async def _erase(self, request: Request) -> Response:
        person = self._found(request)
        if self._busy(person):
            raise NoticeError("person_driving", name=person.name)
        if self._history.person == person.id:
            self._history.end("driver_changed")
        await self._history.settled()
        self._let_go(person)
        await asyncio.to_thread(self._records.erase, person.id)
        return Response(status_code=204, headers=NO_STORE)

    async def _export(self, request: Request) -> Response:
        await self._history.settled()
        person = self._found(request)
        path = await asyncio.to_thread(self._records.export, person.id)
        return FileResponse(
            path,
            filename=f"latentarm-{file_words(person.name)}-{date.today()}.zip",
            media_type="application/zip",
            headers=NO_STORE,
            background=BackgroundTask(path.unlink, missing_ok=True),
        )

    async def _import(self, request: Request) -> Response:
        return json_answer(await asyncio.to_thread(self._records.bring, await request.body()), 201)


def _with_key(request: Request, person: str, key: str) -> Response:
    answer = Response(status_code=204, headers=NO_STORE)
    secure = request.url.scheme == "https"
    answer.set_cookie(
        cookie_of(person), key, max_age=round(OPEN_S), secure=secure, httponly=True, samesite="strict"
    )
    return answer


def _shown(person: PersonRecord) -> dict[str, object]:
    return {"id": person.id, "name": person.name, "added": person.added}


def _history_of(person: PersonRecord, drives: Sequence[DriveRecord]) -> dict[str, object]:
    theirs = [drive for drive in drives if drive.person == person.id]
    return {"drives": len(theirs), "last": theirs[0].started if theirs else None}
