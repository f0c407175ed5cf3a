"""A record with a PIN opens only for who gives it; tries are few, and nothing but the record needs it."""

import io
import json
import zipfile

import httpx
import pytest

from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.protocol.notice import NoticeError
from latentarm.web.records.people import PERSON_NAME, People
from latentarm.web.server.pins import (
    FORGOTTEN_S,
    MOST_CLIENTS,
    OPEN_S,
    TRIES,
    WAIT_S,
    Pins,
    cookie_of,
)

PIN, WRONG = "271828", "0000"
HERE = "192.0.2.1 browser"


class Time:
    s = 0.0

    def __call__(self):
        return self.s


@pytest.fixture
def people(tmp_path):
    return People(tmp_path)


@pytest.fixture
def time():
    return Time()


@pytest.fixture
def ada(people):
    return people.keep_pin(people.add("Ada").id, PIN)


@pytest.fixture
def pins(people, time):
    return Pins(people, wanted=True, now_s=time)


def code(act, *arguments):
    with pytest.raises(NoticeError) as told:
        act(*arguments)
    return told.value.notice.code


def test_the_file_holds_no_pin_and_two_people_with_the_same_one_have_different_hashes(people, ada):
    bea = people.keep_pin(people.add("Bea").id, PIN)
    assert PIN not in (people.folder_of(ada.id) / PERSON_NAME).read_text()
    assert ada.pin.salt != bea.pin.salt
    assert ada.pin.hash != bea.pin.hash
    again = People(people.folder_of(ada.id).parent)
    assert again.find(ada.id).pin == ada.pin


def test_a_record_opens_for_who_has_given_the_pin_until_they_leave_or_it_is_late(pins, ada, time):
    key = {cookie_of(ada.id): pins.unlock(ada, PIN, HERE)}
    assert pins.opened(ada, key)
    assert not pins.opened(ada, {})
    assert not pins.opened(ada, {cookie_of(ada.id): "guessed"})
    pins.lock(ada.id, key)
    assert not pins.opened(ada, key)
    key = {cookie_of(ada.id): pins.unlock(ada, PIN, HERE)}
    time.s = OPEN_S + 1.0
    assert not pins.opened(ada, key)


def test_the_key_of_one_person_opens_no_other_record(pins, people, ada):
    bea = people.keep_pin(people.add("Bea").id, PIN)
    key = pins.unlock(ada, PIN, HERE)
    assert not pins.opened(bea, {cookie_of(bea.id): key})


def test_after_some_wrong_pins_each_try_must_wait_the_right_one_too(pins, ada, time):
    assert [code(pins.unlock, ada, WRONG, HERE) for _ in range(TRIES)] == ["pin_wrong"] * TRIES
    assert code(pins.unlock, ada, PIN, HERE) == "pin_wait"
    time.s = WAIT_S + 1.0
    assert code(pins.unlock, ada, WRONG, HERE) == "pin_wrong"
    assert code(pins.unlock, ada, PIN, HERE) == "pin_wait"
    time.s = 3 * WAIT_S + 2.0
    pins.unlock(ada, PIN, HERE)
    assert code(pins.unlock, ada, WRONG, HERE) == "pin_wrong"


def test_who_gives_wrong_pins_keeps_no_other_client_out(pins, ada, time):
    for minute in range(60):
        time.s = minute * WAIT_S
        assert code(pins.unlock, ada, WRONG, "192.0.2.7 other") in ("pin_wrong", "pin_wait")
        assert code(pins.unlock, ada, WRONG, "192.0.2.1 other") in ("pin_wrong", "pin_wait")
        pins.unlock(ada, PIN, HERE)


def test_a_client_waits_twice_as_long_each_time_up_to_an_hour(pins, ada, time):
    for _ in range(TRIES):
        code(pins.unlock, ada, WRONG, HERE)
    for wait_s in (60, 120, 240, 480, 960, 1920, 3600, 3600):
        time.s += wait_s - 1.0
        assert code(pins.unlock, ada, PIN, HERE) == "pin_wait"
        time.s += 1.5
        assert code(pins.unlock, ada, WRONG, HERE) == "pin_wrong"


def test_all_pins_of_four_digits_take_any_number_of_clients_ten_days(pins, ada, time, monkeypatch):
    monkeypatch.setattr("latentarm.web.server.pins.fits", lambda pin, kept: False)
    tried, clients = [0] * 4, [str(number) for number in range(MOST_CLIENTS)]
    for quarter in range(4 * 96):  # of an hour: whoever may try does, the newest of them as well
        time.s = quarter * 900.0
        for client in [*clients, f"new {quarter}"]:
            while code(pins.unlock, ada, WRONG, client) == "pin_wrong":
                tried[quarter // 96] += 1
    assert tried[0] <= 1400
    assert max(tried[1:]) <= 24 * MOST_CLIENTS
    assert (10_000 - 1400) / (24 * MOST_CLIENTS) + 1 > 9.9


def test_a_browser_that_has_opened_the_record_before_is_never_kept_out_by_others(pins, ada, time):
    pins.unlock(ada, PIN, HERE)
    for number in range(MOST_CLIENTS):
        code(pins.unlock, ada, WRONG, str(number))
    assert code(pins.unlock, ada, PIN, "new") == "pin_wait"
    pins.unlock(ada, PIN, HERE)
    time.s = FORGOTTEN_S
    pins.unlock(ada, PIN, "new")


def test_a_new_pin_closes_the_record_for_everybody_else(pins, people, ada):
    other = {cookie_of(ada.id): pins.unlock(ada, PIN, HERE)}
    mine = {cookie_of(ada.id): pins.change(ada.id, "1234")}
    changed = people.find(ada.id)
    assert pins.opened(changed, mine)
    assert not pins.opened(changed, other)
    assert code(pins.unlock, changed, PIN, HERE) == "pin_wrong"


def test_where_the_host_wants_no_pins_nobody_is_asked(people, ada):
    without = Pins(people, wanted=False)
    assert without.opened(ada, {})
    assert code(without.change, ada.id, "1234") == "request_invalid"


@pytest.fixture(scope="module")
def server(trained, serve, tmp_path_factory):
    with serve(Spec(trained, out=tmp_path_factory.mktemp("pins")), pins=True) as site:
        yield site


def test_choosing_exporting_and_deleting_need_the_pin_and_stop_does_not(server):
    def browser():
        return httpx.Client(base_url=server.origin, headers={"origin": server.origin})

    with browser() as mine, browser() as other:
        person = mine.post("/records/people", json={"name": "Ada"}).json()["id"]
        path = f"/records/people/{person}"
        for pin in ("123", "123456789", "12a4", ""):
            assert mine.put(f"{path}/pin", json={"pin": pin}).status_code == 400
        assert mine.put(f"{path}/pin", json={"pin": PIN}).status_code == 204
        assert mine.get(path).json()["name"] == "Ada"

        refused = [
            other.get(path),
            other.get(f"{path}/export"),
            other.put(path, json={"name": "Eve"}),
            other.put(f"{path}/settings", json={"panel": "dpad"}),
            other.put(f"{path}/pin", json={"pin": None}),
            other.delete(path),
        ]
        assert {(one.status_code, one.json()["notice"]["code"]) for one in refused} == {(403, "pin_needed")}
        with server.page(person=person) as page:
            # Without the PIN somebody drives as a guest, and stops the arm as ever.
            assert isinstance(page.state["driver_name"], int)
            page.enable()
            page.send(type="stop")
            page.wait(lambda state: state["phase"] != "ready")

        assert other.post(f"{path}/unlock", json={"pin": WRONG}).json()["notice"]["code"] == "pin_wrong"
        assert other.post(f"{path}/unlock", json={"pin": PIN}).status_code == 204
        zipped = other.get(f"{path}/export").content
        # What is brought to another computer has no PIN there, and no hash of one.
        brought = other.post("/records/import", content=zipped).json()["person"]
        listed = {one["id"]: one["pin"] for one in other.get("/records/people").json()["people"]}
        assert listed == {person: True, brought: False}
        other.post(f"{path}/lock")
        assert other.get(path).status_code == 403
        assert mine.delete(path).status_code == 204


def test_wrong_pins_of_one_browser_keep_no_other_one_out(server):
    def browser():
        return httpx.Client(base_url=server.origin, headers={"origin": server.origin})

    with browser() as mine, browser() as guessing:
        person = mine.post("/records/people", json={"name": "Dee"}).json()["id"]
        path = f"/records/people/{person}"
        mine.put(f"{path}/pin", json={"pin": PIN})
        mine.post(f"{path}/lock")
        told = [guessing.post(f"{path}/unlock", json={"pin": WRONG}).status_code for _ in range(TRIES + 1)]
        assert told == [403] * TRIES + [429]
        assert mine.post(f"{path}/unlock", json={"pin": PIN}).status_code == 204


DRIVE = {
    "id": "0123456789abcdef", "person": None, "started": "2026-11-20T10:00:00+00:00", "time_s": 5.0,
    "moving_s": 3.0, "robot": "panda", "task": "entree", "run": None, "profile": None, "modes": [],
    "inputs": ["keyboard"], "presses": 2, "stops": 0, "late_stops": 0, "reasons": {}, "way_m": 0.2,
    "help": None, "ended": "reset", "scene": None,
}  # fmt: skip


def test_drives_are_told_only_to_those_who_may_open_the_record(server):
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as zipped:
        zipped.writestr("person.json", json.dumps({"id": DRIVE["id"], "name": "Cy", "added": ""}))
        zipped.writestr(f"drives/{DRIVE['id']}.json", json.dumps(DRIVE))
    with (
        httpx.Client(base_url=server.origin, headers={"origin": server.origin}) as mine,
        httpx.Client(base_url=server.origin) as other,
    ):
        person = mine.post("/records/import", content=archive.getvalue()).json()["person"]
        of_them = {"person": person}
        (drive,) = other.get("/records/drives", params=of_them).json()["drives"]
        assert mine.put(f"/records/people/{person}/pin", json={"pin": PIN}).status_code == 204
        assert [one["id"] for one in mine.get("/records/drives", params=of_them).json()["drives"]] == [
            drive["id"]
        ]
        assert other.get("/records/drives", params=of_them).json()["drives"] == []
        assert len(other.get("/records/drives.csv", params=of_them).text.splitlines()) == 1
        path = f"/records/drives/{drive['id']}"
        other.headers["origin"] = server.origin
        for refused in (other.get(f"{path}/trace"), other.put(path, json={"title": "x"}), other.delete(path)):
            assert refused.status_code == 403
        assert mine.put(path, json={"title": "mine"}).json()["title"] == "mine"
