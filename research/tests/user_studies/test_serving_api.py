"""The study's requests as OpenAPI describes them: whatever is sent, nothing breaks and nothing leaks."""

import os
from collections.abc import Iterator
from typing import Any

import httpx
import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from schemathesis import GenerationMode

from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.serving import request_limit
from latentarm_research.user_studies.serving.app import COOKIE, Answered, Compared, Consented, Understood
from latentarm_research.user_studies.serving.device import Device
from latentarm_research.user_studies.serving.options import general_information
from latentarm_research.user_studies.serving.page_drive import ToDrive
from latentarm_research.user_studies.serving.words.catalogue import study_languages
from study_here import ORIGIN, PROLIFIC, Study, driven
from study_participant import CONTACT, DEVICE, definition

CASES = int(os.environ.get("LATENTARM_STUDY_CASES", "20"))
"""For each request."""

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
    posts = {"begin": None, "ready": None, "withdraw": None, "consent": Consented, "answers": Answered,
             "device": Device, "comprehension": Understood, "compare": Compared}  # fmt: skip
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


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Study]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(request_limit, "BURST", float("inf"))
        (task,) = definition()["tasks"]
        study = Study(tmp_path_factory.mktemp("study"), tasks=[{**task, "trial_s": 20.0}])
        yield study
        study.close()


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


def test_the_page_says_why_a_drive_that_was_too_long_has_ended(study: Study) -> None:
    key = study.comes("trial")
    due = study.due(key)
    assert isinstance(due, ToDrive)
    failed = driven(due, success=False)
    changes = {"ending": "record_full", "measures": {"time_s": 0.0}}  # so that another drive is due
    study.store.keep_drive(key, failed.model_copy(update=changes))
    assert "it was too long to record" in study.ask(key, "GET").text


def test_every_page_says_whom_to_ask(study: Study) -> None:
    pages = [study.ask("", "GET", to) for to in ("", "?left", "?code=unknown", "?PROLIFIC_PID=1")]
    parts = [study.ask(study.key(part), "GET") for part in ("consent", "questions", "finished")]
    assert all(CONTACT in page.text for page in (*pages, *parts))


def test_nobody_reads_their_condition_or_the_question_before_they_have_finished(study: Study) -> None:
    def reads(key: str) -> str:
        return "".join(study.ask(key, "GET", page).text for page in ("", "/data"))

    told = read_definition(study.folder / "two_ways.json")
    telling = [told.title, told.about, *(text for one in told.conditions for text in (one.name, one.about))]
    assert not [text for text in telling if text in general_information(told, 2.0, study_languages()["en"])]
    key = study.comes("consent")
    for part in ("consent", "device", "practice", "trial", "questions"):
        page = study.key("questions") if part == "questions" else key
        assert f'data-part="{part}"' in reads(page)
        assert not [text for text in telling if text in reads(page)]
        if part == "consent":
            study.store.consent(key, "0" * 64, "2026-01-01T00:00:00+00:00")
        if part == "device":
            study.store.keep_device(key, DEVICE, passed=True)
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
