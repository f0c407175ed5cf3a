"""The addresses under ``/records``: people, drives and recordings, for the pages People and History.

Requests are JSON objects with known fields; answers are JSON, or a notice with a status of 4xx. The gate in
front has checked where each request comes from and how long it is.
"""

import asyncio
import csv
import io
import json
from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path
from typing import Annotated, Final, TypeVar, final

from fastapi import FastAPI
from pydantic import Field, TypeAdapter, ValidationError
from starlette.background import BackgroundTask
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response

from latentarm.errors import UserError
from latentarm.untrusted.documents import parse_object
from latentarm.web.protocol.notice import Message, Notice, NoticeError, notice_of
from latentarm.web.records.drive_record import DriveRecord
from latentarm.web.records.drives import Wanted
from latentarm.web.records.people import PersonRecord, Settings
from latentarm.web.records.pin import PIN
from latentarm.web.records.records import Records
from latentarm.web.server.history import History
from latentarm.web.server.pins import OPEN_S, Pins, cookie_of

IMPORT: Final = "/records/import"
"""Takes longer bodies than all else: see `latentarm.web.records.exchange.IMPORT_LIMIT`."""

_NO_STORE: Final = {"cache-control": "no-store"}
_STATUS: Final = {
    "person_unknown": 404,
    "record_unknown": 404,
    "pin_needed": 403,
    "pin_wait": 429,
    "pin_wrong": 403,
}
_COLUMNS: Final = (
    "started",
    "person",
    "title",
    "task",
    "choice",
    "run",
    "robot",
    "profile",
    "modes",
    "inputs",
    "outcome",
    "why",
    "steps_done",
    "steps",
    "time_s",
    "moving_s",
    "idle_s",
    "presses",
    "stops",
    "late_stops",
    "way_m",
    "help",
    "help_level",
    "ended",
    "id",
)

Answer = Callable[[Request], Awaitable[Response]]
Asked = TypeVar("Asked", bound=Message)


@final
class _Named(Message):
    name: Annotated[str, Field(max_length=200)]


@final
class _Titled(Message):
    title: Annotated[str, Field(max_length=80)]


@final
class _Pinned(Message):
    pin: Annotated[str, Field(pattern=PIN)] | None


_SETTINGS: Final[TypeAdapter[dict[str, bool | float | str]]] = TypeAdapter(Settings)


@final
class RecordRoutes:
    """Answers requests about records.

    Args:
        records: what is kept.
        history: logs the drive under way.
        busy: whether the arm is enabled for a person, or with a profile of theirs.
        let_go: makes the arm drive without the profiles of a person who is about to be deleted.
        pins: says whose records a visitor may open.
    """

    def __init__(
        self,
        records: Records,
        history: History,
        busy: Callable[[PersonRecord], bool],
        let_go: Callable[[PersonRecord], None],
        pins: Pins,
    ) -> None:
        self._records = records
        self._history = history
        self._busy = busy
        self._let_go = let_go
        self._pins = pins

    def add_to(self, app: FastAPI) -> None:
        """Serve everything here."""
        for path, methods in (
            ("/records/people", {"GET": self._people, "POST": self._add}),
            ("/records/people/{person}", {"GET": self._person, "PUT": self._rename, "DELETE": self._erase}),
            ("/records/people/{person}/settings", {"PUT": self._keep_settings}),
            ("/records/people/{person}/pin", {"PUT": self._keep_pin}),
            ("/records/people/{person}/unlock", {"POST": self._unlock}),
            ("/records/people/{person}/lock", {"POST": self._lock}),
            ("/records/people/{person}/export", {"GET": self._export}),
            (IMPORT, {"POST": self._import}),
            ("/records/drives", {"GET": self._drives}),
            ("/records/drives.csv", {"GET": self._csv}),
            ("/records/drives/{drive}", {"PUT": self._entitle, "DELETE": self._delete}),
            ("/records/drives/{drive}/restore", {"POST": self._restore}),
            ("/records/drives/{drive}/trace", {"GET": self._trace}),
            ("/records/scenes/{scene}/scene.json", {"GET": self._scene}),
            ("/records/scenes/{scene}/mesh/{number}", {"GET": self._mesh}),
            ("/records/recordings", {"GET": self._recordings}),
            (
                "/records/recordings/{name}",
                {"PUT": self._entitle_recording, "DELETE": self._delete_recording},
            ),
            ("/records/recordings/{name}/restore", {"POST": self._restore_recording}),
        ):
            for method, answer in methods.items():
                app.add_route(path, _guarded(answer), methods=[method])

    async def _people(self, _: Request) -> Response:
        await self._history.settled()
        drives = self._records.drives.wanted(Wanted())
        return _json(
            {
                "people": [
                    {
                        "id": person.id,
                        "name": person.name,
                        "added": person.added,
                        "pin": self._pins.asked(person),
                        **_history_of(person, drives),
                    }
                    for person in self._records.people.all()
                ],
                "pins": self._pins.wanted,
                "problems": [problem.model_dump() for problem in self._records.people.problems],
            }
        )

    async def _add(self, request: Request) -> Response:
        named = await _body(request, _Named)
        return _json(_shown(await asyncio.to_thread(self._records.people.add, named.name)), 201)

    async def _person(self, request: Request) -> Response:
        person = self._found(request)
        contents = await asyncio.to_thread(self._records.contents, person.id)
        return _json({**_shown(person), "settings": person.settings, **contents.model_dump()})

    def _found(self, request: Request) -> PersonRecord:
        """The person whom a request names, and whose record the visitor may open.

        Raises:
            NoticeError: nobody has this id, or their PIN must be given first.
        """
        person = self._named(request)
        if not self._pins.opened(person, request.cookies):
            raise NoticeError("pin_needed", name=person.name)
        return person

    def _named(self, request: Request) -> PersonRecord:
        """The person whom a request names.

        Raises:
            NoticeError: nobody has this id.
        """
        person = self._records.people.find(request.path_params["person"])
        if person is None:
            raise NoticeError("person_unknown")
        return person

    async def _unlock(self, request: Request) -> Response:
        given, person = await _body(request, _Pinned), self._named(request)
        key = await asyncio.to_thread(self._pins.unlock, person, given.pin or "")
        return _with_key(request, person.id, key)

    async def _lock(self, request: Request) -> Response:
        self._pins.lock(self._named(request).id, request.cookies)
        return Response(status_code=204, headers=_NO_STORE)

    async def _keep_pin(self, request: Request) -> Response:
        person, given = self._found(request), await _body(request, _Pinned)
        key = await asyncio.to_thread(self._pins.change, person.id, given.pin)
        return _with_key(request, person.id, key)

    async def _rename(self, request: Request) -> Response:
        named, person = await _body(request, _Named), self._found(request)
        return _json(_shown(await asyncio.to_thread(self._records.people.rename, person.id, named.name)))

    async def _keep_settings(self, request: Request) -> Response:
        try:
            settings = _SETTINGS.validate_json(json.dumps(_object(await request.body())))
        except ValidationError as error:
            raise NoticeError("request_invalid") from error
        person = self._found(request)
        await asyncio.to_thread(self._records.people.keep_settings, person.id, settings)
        return Response(status_code=204, headers=_NO_STORE)

    async def _erase(self, request: Request) -> Response:
        person = self._found(request)
        if self._busy(person):
            raise NoticeError("person_driving", name=person.name)
        if self._history.person == person.id:
            self._history.end("driver_changed")
        await self._history.settled()
        self._let_go(person)
        await asyncio.to_thread(self._records.erase, person.id)
        return Response(status_code=204, headers=_NO_STORE)

    async def _export(self, request: Request) -> Response:
        await self._history.settled()
        path = await asyncio.to_thread(self._records.export, self._found(request).id)
        # A neutral name: a file's name is seen by more people than what is in it.
        return FileResponse(
            path,
            filename="latentarm-person.zip",
            media_type="application/zip",
            headers=_NO_STORE,
            background=BackgroundTask(_remove, path),
        )

    async def _import(self, request: Request) -> Response:
        return _json((await asyncio.to_thread(self._records.bring, await request.body())).model_dump(), 201)

    async def _drives(self, request: Request) -> Response:
        await self._history.settled()
        drives = self._records.drives.wanted(_wanted(request))
        problem = self._history.problem
        return _json(
            {
                "drives": [drive.model_dump() for drive in drives],
                "people": {person.id: person.name for person in self._records.people.all()},
                "problem": None if problem is None else problem.model_dump(),
                "problems": [problem.model_dump() for problem in self._records.drives.problems],
            }
        )

    async def _csv(self, request: Request) -> Response:
        await self._history.settled()
        names = {person.id: person.name for person in self._records.people.all()}
        table = io.StringIO()
        rows = csv.writer(table)
        rows.writerow(_COLUMNS)
        rows.writerows(_row(drive, names) for drive in self._records.drives.wanted(_wanted(request)))
        headers = {"content-disposition": 'attachment; filename="latentarm-drives.csv"', **_NO_STORE}
        # With a mark of its encoding, without which spreadsheets show other scripts wrongly.
        return Response(table.getvalue().encode("utf-8-sig"), media_type="text/csv", headers=headers)

    async def _entitle(self, request: Request) -> Response:
        titled = await _body(request, _Titled)
        drive = await asyncio.to_thread(
            self._records.drives.entitle, request.path_params["drive"], titled.title.strip()
        )
        return _json(drive.model_dump())

    async def _delete(self, request: Request) -> Response:
        await asyncio.to_thread(self._records.drives.delete, request.path_params["drive"])
        return Response(status_code=204, headers=_NO_STORE)

    async def _restore(self, request: Request) -> Response:
        drive = await asyncio.to_thread(self._records.drives.restore, request.path_params["drive"])
        return _json(drive.model_dump())

    async def _trace(self, request: Request) -> Response:
        content = await asyncio.to_thread(self._records.drives.trace, request.path_params["drive"])
        headers = {"content-encoding": "gzip", **_NO_STORE}
        return Response(content, media_type="application/json", headers=headers)

    async def _scene(self, request: Request) -> Response:
        scene = _scene_id(request)
        content = await asyncio.to_thread(self._records.scenes.description, scene)
        return Response(content, media_type="application/json", headers=_NO_STORE)

    async def _mesh(self, request: Request) -> Response:
        scene, number = _scene_id(request), request.path_params["number"]
        content = await asyncio.to_thread(self._records.scenes.mesh, scene, number)
        if content is None:
            raise NoticeError("record_unknown")
        return Response(content, media_type="application/octet-stream", headers=_NO_STORE)

    async def _recordings(self, _: Request) -> Response:
        found = await asyncio.to_thread(self._records.recordings.all)
        return _json({"recordings": [one.model_dump() for one in found]})

    async def _entitle_recording(self, request: Request) -> Response:
        titled = await _body(request, _Titled)
        name = request.path_params["name"]
        await asyncio.to_thread(self._records.recordings.entitle, name, titled.title.strip())
        return Response(status_code=204, headers=_NO_STORE)

    async def _delete_recording(self, request: Request) -> Response:
        await asyncio.to_thread(self._records.recordings.delete, request.path_params["name"])
        return Response(status_code=204, headers=_NO_STORE)

    async def _restore_recording(self, request: Request) -> Response:
        await asyncio.to_thread(self._records.recordings.restore, request.path_params["name"])
        return Response(status_code=204, headers=_NO_STORE)


def _guarded(answer: Answer) -> Answer:
    """The same, with an error of the user's as a notice."""

    async def guarded(request: Request) -> Response:
        try:
            return await answer(request)
        except UserError as error:
            notice = notice_of(error)
            return _refusal(notice, _STATUS.get(notice.code, 400))

    return guarded


def _refusal(notice: Notice, status: int) -> Response:
    return JSONResponse({"notice": notice.model_dump()}, status, headers=_NO_STORE)


def _json(content: object, status: int = 200) -> Response:
    return JSONResponse(content, status, headers=_NO_STORE)


def _with_key(request: Request, person: str, key: str) -> Response:
    """An answer that opens a person's record for this browser."""
    answer = Response(status_code=204, headers=_NO_STORE)
    secure = request.url.scheme == "https"
    answer.set_cookie(
        cookie_of(person), key, max_age=round(OPEN_S), secure=secure, httponly=True, samesite="strict"
    )
    return answer


def _object(body: bytes) -> dict[str, object]:
    try:
        return parse_object(body, "The request")
    except UserError as error:
        raise NoticeError("request_invalid") from error


async def _body(request: Request, kind: type[Asked]) -> Asked:
    """What a request asks for.

    Raises:
        NoticeError: it is not of that kind.
    """
    body = await request.body()
    _object(body)
    try:
        return kind.model_validate_json(body)
    except ValidationError as error:
        raise NoticeError("request_invalid") from error


def _wanted(request: Request) -> Wanted:
    given = request.query_params
    return Wanted(
        person=given.get("person"),
        task=given.get("task"),
        input=given.get("input"),
        since=given.get("since"),
        until=given.get("until"),
    )


def _scene_id(request: Request) -> str:
    scene = str(request.path_params["scene"])
    if len(scene) != 32 or not set(scene) <= set("0123456789abcdef"):
        raise NoticeError("record_unknown")
    return scene


def _shown(person: PersonRecord) -> dict[str, object]:
    return {"id": person.id, "name": person.name, "added": person.added}


def _history_of(person: PersonRecord, drives: Sequence[DriveRecord]) -> dict[str, object]:
    """How often somebody has driven, and when last."""
    theirs = [drive for drive in drives if drive.person == person.id]
    return {"drives": len(theirs), "last": theirs[0].started if theirs else None}


def _row(drive: DriveRecord, names: dict[str, str]) -> list[object]:
    """A line of the table; empty where nothing is known."""
    values = {
        **drive.model_dump(),
        "person": names.get(drive.person or "", ""),
        "modes": " ".join(drive.modes),
        "inputs": " ".join(drive.inputs),
        "idle_s": round(drive.time_s - drive.moving_s, 2),
    }
    return ["" if values[column] is None else _plain(values[column]) for column in _COLUMNS]


def _plain(value: object) -> object:
    """A value that no spreadsheet takes for a formula."""
    return f"'{value}" if isinstance(value, str) and value[:1] in ("=", "+", "-", "@", "\t", "\r") else value


def _remove(path: Path) -> None:
    path.unlink(missing_ok=True)
