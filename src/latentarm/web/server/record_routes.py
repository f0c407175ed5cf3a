"""The addresses of drives, scenes and recordings under ``/records``, for the page History."""

import asyncio
import csv
import io
from dataclasses import dataclass, fields
from datetime import date
from typing import Annotated, Final, final

from pydantic import Field
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from latentarm.web.protocol.notice import Message, NoticeError
from latentarm.web.records.drive_record import DriveRecord
from latentarm.web.records.drives import Wanted
from latentarm.web.records.records import Records
from latentarm.web.server.answers import NO_STORE, body_of, json_answer, routes_of
from latentarm.web.server.history import History
from latentarm.web.server.pins import Pins

_COLUMNS: Final = (
    "started", "person", "title", "task", "choice", "run", "robot", "profile", "modes", "inputs", "outcome",
    "why", "steps_done", "steps", "time_s", "moving_s", "idle_s", "input_s", "presses", "stops",
    "stops_by_person", "stops_by_page", "stops_by_arm", "late_stops", "way_m", "help", "help_level",
    "ended", "id",
)  # fmt: skip


class _Titled(Message):
    title: Annotated[str, Field(max_length=80)]


@final
@dataclass(eq=False)
class RecordRoutes:
    """Answers requests about drives and recordings; see `people_routes` for their form."""

    _records: Records
    _history: History
    _pins: Pins

    def routes(self) -> list[Route]:
        answers = {
            "/records/drives": {"GET": self._drives},
            "/records/drives.csv": {"GET": self._csv},
            "/records/drives/{drive}": {"PUT": self._entitle, "DELETE": self._delete},
            "/records/drives/{drive}/restore": {"POST": self._restore},
            "/records/drives/{drive}/trace": {"GET": self._trace},
            "/records/scenes/{scene}/scene.json": {"GET": self._scene},
            "/records/scenes/{scene}/mesh/{number}": {"GET": self._mesh},
            "/records/recordings": {"GET": self._recordings},
            "/records/recordings/{name}": {"PUT": self._entitle_recording, "DELETE": self._delete_recording},
            "/records/recordings/{name}/restore": {"POST": self._restore_recording},
        }
        return routes_of(answers)

    async def _drives(self, request: Request) -> Response:
        await self._history.settled()
        drives = self._drives_for(request)
        problem = self._history.problem
        return json_answer(
            {
                "drives": [_shown(drive) for drive in drives],
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
        rows.writerows(_row(drive, names) for drive in self._drives_for(request))
        named = f"latentarm-drives-{date.today()}.csv"
        headers = {"content-disposition": f'attachment; filename="{named}"', **NO_STORE}
        # With a mark of its encoding, without which spreadsheets show other scripts wrongly.
        return Response(table.getvalue().encode("utf-8-sig"), media_type="text/csv", headers=headers)

    def _drives_for(self, request: Request) -> list[DriveRecord]:
        closed = {
            person.id
            for person in self._records.people.all()
            if not self._pins.opened(person, request.cookies)
        }
        wanted = Wanted(**{field.name: request.query_params.get(field.name) for field in fields(Wanted)})
        return [drive for drive in self._records.drives.wanted(wanted) if drive.person not in closed]

    def _drive(self, request: Request) -> str:
        """Id of the drive that a request names."""
        name = str(request.path_params["drive"])
        drive = self._records.drives.find(name)
        person = self._records.people.find(drive.person if drive else None)
        if person is not None and not self._pins.opened(person, request.cookies):
            raise NoticeError("pin_needed", name=person.name)
        return name

    async def _entitle(self, request: Request) -> Response:
        titled, drive = await body_of(request, _Titled), self._drive(request)
        record = await asyncio.to_thread(self._records.drives.entitle, drive, titled.title.strip())
        return json_answer(_shown(record))

    async def _delete(self, request: Request) -> Response:
        await asyncio.to_thread(self._records.drives.delete, self._drive(request))
        return Response(status_code=204, headers=NO_STORE)

    async def _restore(self, request: Request) -> Response:
        drive = await asyncio.to_thread(self._records.drives.restore, request.path_params["drive"])
        return json_answer(_shown(drive))

    async def _trace(self, request: Request) -> Response:
        content = await asyncio.to_thread(self._records.drives.trace, self._drive(request))
        headers = {"content-encoding": "gzip", **NO_STORE}
        return Response(content, media_type="application/json", headers=headers)

    async def _scene(self, request: Request) -> Response:
        scene = request.path_params["scene"]
        content = await asyncio.to_thread(self._records.scenes.description, scene)
        return Response(content, media_type="application/json", headers=NO_STORE)

    async def _mesh(self, request: Request) -> Response:
        scene, number = request.path_params["scene"], request.path_params["number"]
        content = await asyncio.to_thread(self._records.scenes.mesh, scene, number)
        return Response(content, media_type="application/octet-stream", headers=NO_STORE)

    async def _recordings(self, _: Request) -> Response:
        found = await asyncio.to_thread(self._records.recordings.all)
        return json_answer({"recordings": [one.model_dump() for one in found]})

    async def _entitle_recording(self, request: Request) -> Response:
        titled, name = await body_of(request, _Titled), request.path_params["name"]
        await asyncio.to_thread(self._records.recordings.entitle, name, titled.title.strip())
        return Response(status_code=204, headers=NO_STORE)

    async def _delete_recording(self, request: Request) -> Response:
        await asyncio.to_thread(self._records.recordings.delete, request.path_params["name"])
        return Response(status_code=204, headers=NO_STORE)

    async def _restore_recording(self, request: Request) -> Response:
        await asyncio.to_thread(self._records.recordings.restore, request.path_params["name"])
        return Response(status_code=204, headers=NO_STORE)


def _shown(drive: DriveRecord) -> dict[str, object]:
    return {**drive.model_dump(), "stops_by": drive.stops_by}


def _row(drive: DriveRecord, names: dict[str, str]) -> list[object]:
    values = {
        **drive.model_dump(),
        "person": names.get(drive.person or "", ""),
        "modes": " ".join(drive.modes),
        "inputs": " ".join(drive.inputs),
        "input_s": drive.input_s and " ".join(f"{kind} {time_s:g}" for kind, time_s in drive.input_s.items()),
        **{f"stops_by_{who}": count for who, count in drive.stops_by.items()},
        "idle_s": round(drive.time_s - drive.moving_s, 2),
    }
    return ["" if values[column] is None else _plain(values[column]) for column in _COLUMNS]


def _plain(value: object) -> object:
    """A value that no spreadsheet takes for a formula."""
    return f"'{value}" if isinstance(value, str) and value[:1] in ("=", "+", "-", "@", "\t", "\r") else value
