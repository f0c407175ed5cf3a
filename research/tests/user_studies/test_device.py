"""Who cannot drive from their device hears why before they practise, and may try again."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from latentarm.core.errors import UserError
from latentarm_research.user_studies.device_limits import DeviceLimits
from latentarm_research.user_studies.own.definition_file import read_definition
from latentarm_research.user_studies.recorded import Recorded
from latentarm_research.user_studies.report.people import consent_words
from latentarm_research.user_studies.serving.app import COOKIE
from latentarm_research.user_studies.sizes import PRESETS
from study_here import ORIGIN, Study
from study_participant import DEVICE

LIMITS = {"round_trip_ms": 200.0, "jitter_ms": 50.0, "width_px": 600, "height_px": 300, "needs": ["gamepad"]}


@pytest.fixture
def study(tmp_path: Path) -> Iterator[Study]:
    study = Study(tmp_path, device=LIMITS)
    yield study
    study.close()


def newcomer(study: Study) -> str:
    key = study.comes("consent")
    study.store.consent(key, "0" * 64, "2026-01-01T00:00:00+00:00")
    study.ask(key, "GET")  # gives them a place
    return key


GOOD = {**DEVICE, "inputs": ["mouse", "gamepad"], "round_trip_ms": 200.0, "jitter_ms": 50.0, "width_px": 600}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"webgl": False}, "it has no WebGL 2"),
        ({"width_px": 599}, "make it 600 by 300 pixels or larger"),
        ({"height_px": 299}, "make it 600 by 300 pixels or larger"),
        ({"inputs": ["mouse"]}, "None of these was used: gamepad."),
        ({"round_trip_ms": None, "jitter_ms": None}, "A firewall may block WebSockets"),
        ({"round_trip_ms": 201.0}, "A message takes 201 ms"),
        ({"jitter_ms": 51.0}, "held up now and then"),
    ],
)
def test_a_device_that_falls_short_is_told_why_and_may_try_again(
    study: Study, changes: dict[str, Any], sentence: str
) -> None:
    key = newcomer(study)
    assert ">Check</button>" in study.ask(key, "GET").text
    assert study.ask(key, "POST", "/device", **{**GOOD, **changes}).json() == {"to": "/study"}
    page = study.ask(key, "GET").text
    assert 'data-part="device"' in page
    assert sentence in page
    assert page.count("<p>", page.index('role="status"'), page.index("</div>")) == 2
    # Nobody drives before the check is passed.
    assert study.ask(key, "POST", "/begin").json() == {"to": "/study"}
    study.ask(key, "POST", "/device", **GOOD)
    study.ask(key, "POST", "/device", **{**GOOD, **changes})  # from another tab
    assert 'data-part="practice"' in study.ask(key, "GET").text
    kept = study.ask(key, "GET", "/data").json()["device_checks"]
    assert [one["passed"] for one in kept] == [False, True]
    study.ask(key, "POST", "/withdraw")
    assert study.store.everything(key)["device_checks"] == []


@pytest.mark.parametrize(
    "wrong", [{"browser": "<b>"}, {"width_px": -1}, {"jitter_ms": -1.0}, {"inputs": ["eye"]}]
)
def test_what_no_page_sends_is_refused(study: Study, wrong: dict[str, Any]) -> None:
    key = newcomer(study)
    assert study.ask(key, "POST", "/device", **{**GOOD, **wrong}).status_code == 400
    assert study.store.everything(key)["device_checks"] == []


def test_the_report_counts_devices_that_fell_short(study: Study) -> None:
    people = []
    for changes in ({}, {"webgl": False}):
        key = newcomer(study)
        study.ask(key, "POST", "/device", **{**GOOD, **changes})
        people.append(study.store.standing(key))
    definition = read_definition(study.folder / "two_ways.json")
    recorded = Recorded(definition, "real", (), (), (), PRESETS["smoke"], participants=tuple(people))
    assert "The device of 1 fell short." in consent_words(recorded)
    recorded = replace(recorded, participants=tuple(people[:1]))
    assert "fell short" not in consent_words(recorded)


def socket(study: Study, key: str, *texts: str) -> list[str]:
    """Send these messages over the drive's socket; the server's answers, until it closes."""
    events = [{"type": "websocket.connect"}, *({"type": "websocket.receive", "text": one} for one in texts)]
    answers: list[str] = []

    async def receive() -> dict[str, Any]:
        return events.pop(0)

    async def send(message: Any) -> None:
        answers.extend(message[name] for name in ("text",) if name in message)

    headers = {"host": "study.example", "origin": ORIGIN, "cookie": f"{COOKIE}={key}"}
    scope = {
        "type": "websocket", "path": "/drive", "query_string": b"", "client": ("127.0.0.1", 1),
        "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
    }  # fmt: skip
    study.loop.run_until_complete(study.gate(scope, receive, send))
    return answers


def test_the_socket_gives_messages_back_during_the_check_alone(study: Study) -> None:
    key = newcomer(study)
    assert socket(study, key, "0", "199", "far too long") == ["0", "199"]
    study.ask(key, "POST", "/device", **GOOD)
    (answer,) = socket(study, key)
    assert '"code":"drive_over"' in answer


@pytest.mark.parametrize("name", ["round_trip_ms", "jitter_ms", "width_px", "height_px"])
@pytest.mark.parametrize("value", [0, 5000])
def test_limits_that_no_device_meets_or_misses_are_refused(name: str, value: int) -> None:
    with pytest.raises(UserError, match=f"{name} of a device must be from 1 to"):
        DeviceLimits(**{name: value})  # type: ignore[arg-type]
