"""The study's requests as OpenAPI describes them: whatever is sent, nothing breaks and nothing leaks."""

import asyncio
import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, ClassVar, final

import httpx
import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from schemathesis import GenerationMode

from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.server.config import TeleopConfig
from latentarm.web.server.security import Gate
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.serving import request_limit
from latentarm_research.user_studies.serving.app import COOKIE, Answered, Consented, StudyServer
from latentarm_research.user_studies.serving.kept_options import KeptOptions, digest_of
from latentarm_research.user_studies.serving.models import Models
from latentarm_research.user_studies.serving.options import Serving, general_information
from latentarm_research.user_studies.serving.page_drive import ToDrive
from latentarm_research.user_studies.serving.store import Store
from latentarm_research.user_studies.serving.way import ToAnswer, Way
from latentarm_research.user_studies.trace import Trace
from study_participant import MODES, TWIST, definition

CASES = int(os.environ.get("LATENTARM_STUDY_CASES", "20"))
"""For each request."""

ORIGIN = "http://study.example"
PROLIFIC = "5" * 24
INFORMATION = "All that you need to know."

HTML = {"description": "a page", "content": {"text/html": {}}}
SENTENCE = {
    "description": "why it is refused",
    "content": {"application/json": {"schema": {"type": "object", "required": ["problem"]}}},
}
ONWARD = {
    "description": "the page that follows",
    "content": {"application/json": {"schema": {"type": "object", "required": ["to"]}}},
}


def described() -> dict[str, Any]:
    """The study's requests; their bodies are those of the server's own models."""
    links = [
        {"name": name, "in": "query", "schema": {"type": "string"}}
        for name in ("code", "PROLIFIC_PID", "STUDY_ID", "SESSION_ID", "left")
    ]
    refused = {str(status): SENTENCE for status in (400, 403, 409, 413)}
    posts = {"begin": None, "ready": None, "withdraw": None, "consent": Consented, "answers": Answered}
    pages = {"200": HTML, "303": {"description": "onward"}, "404": HTML}
    paths: dict[str, Any] = {
        "/study": {"get": {"parameters": links, "responses": pages}},
        "/study/data": {"get": {"responses": {"200": {"description": "their data"}, **refused}}},
        "/static/{version}/{name}": {
            "get": {
                "parameters": [
                    {"name": name, "in": "path", "required": True, "schema": {"type": "string"}}
                    for name in ("version", "name")
                ],
                "responses": {"200": {"description": "a file"}, "404": HTML},
            }
        },
    }
    for name, model in posts.items():
        body = {} if model is None else model.model_json_schema()
        content = {"application/json": {"schema": body}}
        request = {} if model is None else {"requestBody": {"required": True, "content": content}}
        paths[f"/study/{name}"] = {"post": {**request, "responses": {"200": ONWARD, **refused}}}
    return {"openapi": "3.1.0", "info": {"title": "A study", "version": "1"}, "paths": paths}


@final
class Study:
    """A study in this process, with somebody at each part of it but the drives."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        (folder / "two_ways.json").write_text(
            json.dumps({**definition(MODES, TWIST), "people": 5, "papers_people": ""})
        )
        serving = Serving(
            read_definition(folder / "two_ways.json"),
            KeptOptions(information=digest_of(INFORMATION), prolific=PROLIFIC, preset="smoke"),
            TeleopConfig(Spec(out=folder)), INFORMATION, 1, folder / "study.sqlite",
        )  # fmt: skip
        self.way = Way(serving.definition, serving.sizes, serving.kept.seed)
        self.store = Store(folder / "study.sqlite", 7200.0)
        server = StudyServer(serving, self.store, Models(serving.definition, folder))
        gate = Gate(server, frozenset({"study.example"}), frozenset({ORIGIN}), stop=server.stop)
        self.loop = asyncio.new_event_loop()
        self.client = httpx.AsyncClient(transport=httpx.ASGITransport(gate), base_url=ORIGIN)
        self.keys: dict[str, str] = {}

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
        self.store.practised(key, 2)
        while isinstance(due := self._due(key), ToDrive) or part == "finished":
            if isinstance(due, ToAnswer):
                self.store.keep_answers(key, due.order, due.condition.name, dict.fromkeys(due.items, 4))
            elif isinstance(due, ToDrive):
                self.store.keep_drive(key, driven(due))
            else:
                self.store.finish(key, "SECRET")
                break
        return key

    _used: ClassVar[set[str]] = set()

    def _due(self, key: str) -> object:
        standing = self.store.standing(key)
        assert standing is not None
        return self.way.after(standing)


def driven(due: ToDrive) -> DriveRecord:
    trace = Trace(0, due.condition.name, due.task.name, due.trial, due.choice, True, (), (), (), ())
    return DriveRecord(
        people_are="real", person=0, condition=due.condition.name, order=due.order, task=due.task.name,
        trial=due.trial, choice=due.choice, attempt=due.attempt, ending="done", measures={"time_s": 1.0},
        trace=trace,
    )  # fmt: skip


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Study]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(request_limit, "BURST", float("inf"))
        study = Study(tmp_path_factory.mktemp("study"))
        yield study
        study.loop.run_until_complete(study.client.aclose())
        study.loop.close()
        study.store.close()


def test_a_person_from_prolific_comes_back_in_another_session(study: Study) -> None:
    def opens(visit: str) -> httpx.Response:
        link = {"PROLIFIC_PID": "a" * 24, "STUDY_ID": PROLIFIC, "SESSION_ID": visit}
        return study.loop.run_until_complete(study.client.get("/study", params=link))

    first, again, without = opens("c" * 24), opens("d" * 24), opens("")
    study.client.cookies.clear()
    assert first.status_code == again.status_code == 303
    assert first.cookies[COOKIE] == again.cookies[COOKIE]
    assert without.status_code == 404
    assert "it lacks SESSION_ID" in without.text


def test_nobody_reads_their_condition_or_the_question_before_they_have_finished(study: Study) -> None:
    def reads(key: str) -> str:
        study.client.cookies.clear()
        headers = {"cookie": f"{COOKIE}={key}"}
        pages = [study.client.get(f"/study{page}", headers=headers) for page in ("", "/data")]
        return "".join(study.loop.run_until_complete(one).text for one in pages)

    told = read_definition(study.folder / "two_ways.json")
    telling = [told.title, told.about, *(text for one in told.conditions for text in (one.name, one.about))]
    assert not [text for text in telling if text in general_information(told, 2.0)]
    key = study.comes("consent")
    for part in ("consent", "practice", "trial", "questions"):
        page = study.key("questions") if part == "questions" else key
        assert f'data-part="{part}"' in reads(page)
        assert not [text for text in telling if text in reads(page)]
        if part == "consent":
            study.store.consent(key, "0" * 64, "2026-01-01T00:00:00+00:00")
        study.store.practised(key, 2 if part == "practice" else 0)
    finished = reads(study.key("finished"))
    assert all(text in finished for text in (told.title, told.about, '"condition":"Modes"'))


PARTS = ("", "guess", "' OR 1=1 --", "consent", "questions", "finished")
OPERATIONS = [one.ok() for one in schemathesis.openapi.from_dict(described()).get_all_operations()]
SENT = [
    pytest.param(operation, mode, id=f"{operation.label} {mode.value}")
    for operation in OPERATIONS
    for mode in GenerationMode
    # Any text may stand in a link; only a body can be wrong.
    if mode.is_positive or "requestBody" in operation.definition.raw
]


@pytest.mark.parametrize(("operation", "mode"), SENT)
def test_whatever_is_sent_is_answered_as_described(
    study: Study, operation: Any, mode: GenerationMode
) -> None:
    cases = operation.as_strategy(generation_mode=mode)

    @settings(max_examples=CASES, deadline=None, suppress_health_check=list(HealthCheck), database=None)
    @given(case=cases, part=st.sampled_from(PARTS))
    def sent(case: Any, part: str) -> None:
        request = case.as_transport_kwargs(base_url=ORIGIN)
        request["headers"] = {
            **request.get("headers", {}),
            "origin": ORIGIN,
            "cookie": f"{COOKIE}={study.key(part)}",
        }
        request.pop("cookies", None)
        if not isinstance(request.get("data", {}), dict):
            request["content"] = request.pop("data")
        given = {name: value for name, value in request.items() if value is not None}
        answer = study.loop.run_until_complete(study.client.request(**given))
        assert answer.status_code < 500
        assert str(answer.status_code) in {*operation.definition.raw["responses"], "404", "405", "307"}
        if part != "finished":
            assert "SECRET" not in answer.text

    sent()
