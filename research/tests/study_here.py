"""A study served in this process, with somebody at each part of it but the drives."""

import asyncio
import json
import time
from pathlib import Path
from typing import Any, final

import httpx

from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.server.config import TeleopConfig
from latentarm.web.server.security import Gate
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.serving.app import COOKIE, StudyServer
from latentarm_research.user_studies.serving.kept_options import KeptOptions, digest_of
from latentarm_research.user_studies.serving.models import Models
from latentarm_research.user_studies.serving.options import Serving
from latentarm_research.user_studies.serving.page_drive import ToDrive
from latentarm_research.user_studies.serving.store import Store
from latentarm_research.user_studies.serving.way import ToAnswer, Way
from latentarm_research.user_studies.trace import BINS, Trace
from study_participant import CONTACT, DEVICE, MODES, TWIST, definition

ORIGIN = "http://study.example"
PROLIFIC = "5" * 24
INFORMATION = "All that you need to know."


@final
class Study:
    """A study in this process, with somebody at each part of it but the drives."""

    def __init__(self, folder: Path, *, language: str = "en", **changes: Any) -> None:
        self.folder = folder
        (folder / "two_ways.json").write_text(
            json.dumps({**definition(MODES, TWIST), "people": 5, **changes})
        )
        serving = Serving(
            read_definition(folder / "two_ways.json"),
            KeptOptions(
                contact=CONTACT, information=digest_of(INFORMATION), prolific=PROLIFIC, preset="smoke",
                language=language,
            ),
            TeleopConfig(Spec(out=folder)), INFORMATION, 1, folder / "study.sqlite",
        )  # fmt: skip
        self.way = Way(serving.definition, serving.sizes, serving.kept.seed)
        self.store = Store(folder / "study.sqlite", 7200.0)
        server = StudyServer(
            serving,
            self.store,
            Models(serving.definition, folder),
            self.store.servers("here", f"{ORIGIN}/study", 1),
        )
        self.gate = Gate(server, frozenset({"study.example"}), frozenset({ORIGIN}), stop=server.stop)
        self.loop = asyncio.new_event_loop()
        self.client = httpx.AsyncClient(transport=httpx.ASGITransport(self.gate), base_url=ORIGIN)
        self.keys: dict[str, str] = {}
        self._used: set[str] = set()

    def ask(self, key: str, way: str, to: str = "", **content: Any) -> httpx.Response:
        """The answer to a request of the person with this cookie."""
        headers = {"cookie": f"{COOKIE}={key}", "origin": ORIGIN}
        self.client.cookies.clear()
        given = {"json": content} if content else {}
        return self.loop.run_until_complete(self.client.request(way, f"/study{to}", headers=headers, **given))

    def close(self) -> None:
        self.loop.run_until_complete(self.client.aclose())
        self.loop.close()
        self.store.close()

    def key(self, part: str) -> str:
        """The cookie of somebody at a part of the study; of somebody new where they have left."""
        if part not in ("consent", "questions", "finished"):
            return part
        if self.store.standing(self.keys.get(part, "")) is None:
            self.keys[part] = self.comes(part)
        return self.keys[part]

    def comes(self, part: str) -> str:
        """The cookie of somebody new at a part of the study."""
        free = [code for code in self.store.open_places(5) if code not in self._used]
        self._used.add(free[0])
        key = str(self.store.arrive(free[0], "", time.time()))
        if part == "consent":
            return key
        self.store.consent(key, "0" * 64, "2026-01-01T00:00:00+00:00")
        self.store.place(key, time.time())
        self.store.keep_device(key, DEVICE, passed=True)
        self.store.practised(key, 2)
        if part == "trial":
            return key
        while isinstance(due := self.due(key), ToDrive) or part == "finished":
            if isinstance(due, ToAnswer):
                self.store.keep_answers(key, due.order, due.condition.name, dict.fromkeys(due.items, 4))
            elif isinstance(due, ToDrive):
                self.store.keep_drive(key, driven(due))
            else:
                self.store.finish(key, "SECRET")
                break
        return key

    def due(self, key: str) -> object:
        standing = self.store.standing(key)
        assert standing is not None
        return self.way.after(standing)


def driven(due: ToDrive, *, success: bool = True) -> DriveRecord:
    rest = ((0.0,) * BINS,) * BINS
    way = ((0.0,), ((0.0, 0.0, 0.0),), (), rest)
    trace = Trace(0, due.condition.name, due.task.name, due.trial, due.choice, success, *way)
    return DriveRecord(
        people_are="real", person=0, condition=due.condition.name, order=due.order, task=due.task.name,
        trial=due.trial, choice=due.choice, attempt=due.attempt, ending="done", trace=trace,
        measures={"success_rate": float(success), "steps_done": 1.0, "time_s": 1.0},
    )  # fmt: skip
