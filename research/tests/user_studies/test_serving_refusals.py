"""A study refuses bad requests with a sentence, shows nobody else's data, and changes nothing."""

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from latentarm_research.user_studies.serving.request_limit import BURST, RATE
from latentarm_research.user_studies.serving.store import Standing, Store
from study_participant import MODES, TWIST, Participant, definition, next_link, participant, serving

pytestmark = pytest.mark.slow

FLOOD = 10_000  # requests of the flood

PID = {"PROLIFIC_PID": "a" * 24, "STUDY_ID": "5" * 24, "SESSION_ID": "c" * 24}


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("study") / "people"


@pytest.fixture(scope="module")
def address(out: Path) -> Iterator[str]:
    """A study for Prolific too, with a place for everybody who comes in these tests."""
    study = out.parent / "two_ways.json"
    study.write_text(json.dumps({**definition(MODES, TWIST), "people": 12}))
    with serving(str(study), "--out", str(out), "--prolific", PID["STUDY_ID"], "--at-once", "1") as (
        address,
        _,
    ):
        yield address


@pytest.fixture
def person(address: str, out: Path) -> Iterator[Participant]:
    """Somebody who practises, and leaves in the end."""
    with participant(address, next_link(out, 0)) as person:
        person.consent()
        yield person
        person.post("withdraw")


def known(out: Path, person: Participant) -> Standing | None:
    """How far a person has come, from the study's database."""
    store = Store(out / "study.sqlite")
    try:
        return store.standing(person.client.cookies["latentarm_study"])
    finally:
        store.close()


def is_refused(answer: httpx.Response, status: int) -> bool:
    """Check that an answer has this status and a sentence for the person."""
    problem = answer.json()["problem"] if "json" in answer.headers["content-type"] else answer.text
    return answer.status_code == status and problem[:1].isupper() and problem.endswith(".")


def prolific(**given: str) -> str:
    return f"/study?{httpx.QueryParams({**PID, **given})}"


@pytest.mark.parametrize("key", ["", "A" * 22, "' OR 1=1 --"])
def test_a_guessed_key_opens_nothing(address: str, person: Participant, key: str) -> None:
    with participant(address) as guesser:
        guesser.client.headers["cookie"] = f"latentarm_study={key}"
        assert guesser.part == "unknown"
        for to in ("consent", "begin", "ready", "answers", "withdraw"):
            assert is_refused(guesser.post(to), 403)
        assert guesser.client.get("/").headers["location"] == "/study"
        with guesser.connected():
            time.sleep(0.5)
        assert guesser.told == ["drive_over"]
    assert person.part == "practice"


def test_a_guessed_link_opens_nothing(address: str) -> None:
    with participant(address, "/study?code=guess") as guesser:
        assert guesser.part == "unknown"


def test_links_of_prolific_open_their_own_study_alone(address: str) -> None:
    with participant(address, prolific()) as person:
        assert person.part == "consent"
    with participant(address, prolific()) as person:
        assert person.part == "consent"
    for wrong in ({"STUDY_ID": "6" * 24}, {"PROLIFIC_PID": "' OR 1=1 --"}):
        with participant(address, prolific(**wrong)) as guesser:
            assert guesser.part == "unknown", wrong
    # Prolific gives a new session to a person who returns.
    with participant(address, prolific(SESSION_ID="d" * 24)) as again:
        again.consent()
    with participant(address, prolific()) as person:
        assert person.part == "practice"
        person.post("withdraw")


def test_what_was_sent_before_changes_nothing_when_it_is_sent_again(
    address: str, out: Path, person: Participant
) -> None:
    person.ready()
    person.drive()
    first = {"order": 0, "answers": {"ease_1": 6}}
    assert person.post("answers", **first).status_code == 200
    person.drive()
    person.answer()
    assert person.part == "finished"
    before = known(out, person)
    assert before is not None
    assert before.completion in person.page
    assert is_refused(person.post("answers", **first), 409)
    for to in ("begin", "ready"):
        assert person.post(to).json() == {"to": "/study"}
    assert known(out, person) == before
    # Somebody else does not get their code.
    with participant(address, next_link(out)) as other:
        assert other.part == "consent"
        assert other.post("answers", **first).status_code == 409
        assert before.completion not in other.page


WRONG_ANSWERS: list[Any] = [
    {"order": 0, "answers": {"ease_1": 8}},
    {"order": 0, "answers": {"ease_1": 0}},
    {"order": 0, "answers": {"ease_1": 2.5}},
    {"order": 0, "answers": {"ease_9": 1}},
    {"order": 0, "answers": {"ease_1": 1}, "completion": "mine"},
    {"order": 0, "answers": []},
    {"order": -1, "answers": {}},
    [],
    "DROP TABLE answers",
]


def test_answers_that_do_not_fit_the_questionnaire_are_refused(person: Participant) -> None:
    person.ready()
    person.drive()
    for content in WRONG_ANSWERS:
        assert is_refused(person.client.post("/study/answers", json=content), 400), content
        assert person.part == "questions"


def test_a_second_tab_watches(address: str, person: Participant) -> None:
    with participant(address) as second, person.driving():
        second.client.cookies.update(person.client.cookies)
        # It begins no second drive.
        assert second.post("begin").json()["to"] == "/"
        with second.connected() as socket:
            end_s = time.monotonic() + 1.0
            second.push(socket, lambda: time.monotonic() > end_s, [0.0, 1.0])
        assert not second.state["you"]
        assert second.state["tool"] == person.state["tool"]
        assert person.state["you"]
        assert not person.told
        person.ready()


def test_a_drive_begins_only_while_an_arm_is_free(address: str, out: Path, person: Participant) -> None:
    assert person.post("begin").json() == {"to": "/"}
    with participant(address, next_link(out)) as other:
        other.consent()
        waits = other.post("begin")
        assert waits.status_code == 503
        assert waits.json()["waits_s"] > 0
        person.ready()
        assert other.post("begin").json() == {"to": "/"}
        other.post("withdraw")


def test_long_bodies_are_refused(address: str, person: Participant) -> None:
    assert is_refused(person.client.post("/study/answers", content=b" " * 70_000), 413)
    assert person.part == "practice"


SQL = [
    "' OR 1=1 --",
    '"; DROP TABLE people; --',
    "1); DELETE FROM drives; --",
    "%' UNION SELECT key FROM people",
]


@pytest.mark.parametrize("sql", SQL)
def test_sql_in_any_field_is_text(address: str, out: Path, person: Participant, sql: str) -> None:
    before = known(out, person)
    with participant(address) as guesser:
        for link in ({"code": sql}, *({**PID, name: sql} for name in PID)):
            guesser.client.get("/study", params=link)
            assert guesser.part == "unknown"
        for path in (f"/study/{sql}", f"/static/{sql}/{sql}", f"/{sql}"):
            assert guesser.client.get(path).status_code == 404
        guesser.client.headers["cookie"] = f"latentarm_study={sql}"
        assert is_refused(guesser.post("withdraw"), 403)
    contents: list[tuple[str, dict[str, Any]]] = [
        ("consent", {"digest": sql}),
        ("answers", {"order": sql, "answers": {}}),
        ("answers", {"order": 0, "answers": {sql: 1}}),
        ("answers", {"order": 0, "answers": {"ease_1": sql}}),
    ]
    for to, content in contents:
        assert person.post(to, **content).status_code in (200, 400, 409)
    assert known(out, person) == before


def test_a_flood_of_requests_is_refused_and_logged(
    out: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    study = out.parent / "two_ways.json"
    begun_s = time.monotonic()
    with serving(str(study), "--out", str(tmp_path / "people")) as (address, _):
        with participant(address, address) as person:
            assert person.part == "consent"
            with participant(address) as stranger:
                said = [stranger.client.get("/study").status_code for _ in range(FLOOD)]
            # Strangers do not use up the allowance of participants.
            assert person.part == "consent"
            own = [person.client.get("/study").status_code for _ in range(FLOOD // 10)]
        spent_s = time.monotonic() - begun_s
    assert set(said) == {404, 429}
    assert set(own) == {200, 429}
    assert said.count(404) <= BURST + RATE * spent_s
    assert own.count(200) <= BURST + RATE * spent_s
    assert "Too many requests came at once; refused so far: 1000." in capfd.readouterr().err
    content = b"".join(path.read_bytes() for path in (tmp_path / "people").rglob("*") if path.is_file())
    assert b"127.0.0.1" not in content.replace(address.split("/study")[0].encode(), b"")


@pytest.mark.parametrize(
    "path", ["/study/export", "/study.sqlite", "/study/study.sqlite", "/links.csv", "/records", "/people"]
)
def test_nothing_is_exported(address: str, person: Participant, path: str) -> None:
    assert person.client.get(path).status_code == 404


def test_requests_of_another_site_are_refused(person: Participant) -> None:
    answer = person.client.post("/study/withdraw", json={}, headers={"origin": "https://elsewhere.example"})
    assert is_refused(answer, 403)
    assert person.part == "practice"
