"""People and their drives over the real server: kept, listed, taken along, and gone when they are deleted."""

import csv
import io
import time
from secrets import token_hex

import httpx
import numpy as np
import pytest

from latentarm.web.arm_process.drive_setup import Spec

NAME = "李雷 Müller"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("records")


@pytest.fixture(scope="module")
def server(place, trained, serve):
    with serve(Spec(trained, out=place)) as site:
        yield site


@pytest.fixture(scope="module")
def ask(server):
    with httpx.Client(base_url=server.origin, headers={"origin": server.origin}) as client:
        yield client


def everywhere(folder, *texts):
    """Files whose name or bytes hold one of the texts."""
    found = [path for path in folder.rglob("*") if path.is_file()]
    return [
        path for path in found for text in texts if text in str(path) or text.encode() in path.read_bytes()
    ]


def drive_and_stop(page):
    """Drive for 0.8 s and press Stop; again where a busy machine had stopped the arm before."""
    for _ in range(5):
        page.drive(0.0, 1.0)
        time.sleep(0.8)
        page.send(type="stop")
        page.wait(lambda state: state["phase"] in ("neutral_needed", "disengaged"))
        if page.state["reason"]["code"] == "stop_pressed_by":
            return
    raise AssertionError(f"it was stopped five times: {page.state}")


def test_a_person_s_drives_are_kept_listed_taken_along_and_deleted(server, ask, place):
    name = f"{NAME} {token_hex(4)}"  # another one when the test is tried again
    person = ask.post("/records/people", json={"name": f"  {name} "}).json()
    assert person["name"] == name
    assert place / "records" / "people" / person["id"] / "person.json" in everywhere(place, name)
    with server.page(person=person["id"]) as page:
        assert page.state["driver_name"] == name
        page.send(type="record", on=True, task="soup")
        drive_and_stop(page)
        page.send(type="record", on=False)
        page.wait(lambda state: state["recording"]["episodes"] == 1)

    (drive,) = ask.get("/records/drives", params={"person": person["id"]}).json()["drives"]
    assert drive["task"] == "table_top"
    assert drive["inputs"] == ["pointer"]
    late = drive["late_stops"]  # those of a busy machine, after which the arm was enabled and pushed again
    assert drive["stops"] - late == 1 <= drive["presses"] <= 1 + late
    assert drive["ended"] == "driver_changed"
    assert 0.5 < drive["moving_s"] <= drive["time_s"] < 10
    assert drive["stops_by"] == {"person": 1, "page": late, "arm": 0}
    assert drive["input_s"] == {"pointer": pytest.approx(drive["moving_s"], abs=0.3)}
    assert drive["reasons"] == {"stop_pressed_by": 1} | ({"input_late": late} if late else {})
    assert (drive["outcome"], drive["steps_done"]) == (None, 0)
    for other in ({"person": ""}, {"task": "pour"}, {"input": "switch"}, {"until": "2001-01-01"}):
        assert ask.get("/records/drives", params=other).json()["drives"] == []

    trace = ask.get(f"/records/drives/{drive['id']}/trace").json()
    steps = np.linalg.norm(np.diff(trace["tool"], axis=0), axis=1)
    assert abs(steps.sum() - drive["way_m"]) < 0.01
    # The end is kept whenever it comes.
    assert min(np.diff(trace["t"])[:-1]) >= 0.09
    scene = ask.get(f"/records/scenes/{drive['scene']}/scene.json").json()
    assert scene == ask.get("/scene.json").json()
    assert all(len(row) == len(scene["bodies"]) for row in trace["bodies"])

    (row,) = csv.DictReader(io.StringIO(ask.get("/records/drives.csv").content.decode("utf-8-sig")))
    assert (row["person"], row["stops"], row["outcome"]) == (name, str(drive["stops"]), "")
    assert (row["stops_by_person"], row["stops_by_page"], row["stops_by_arm"]) == ("1", str(late), "0")
    assert row["input_s"] == f"pointer {drive['input_s']['pointer']:g}"

    (recording,) = ask.get("/records/recordings").json()["recordings"]
    assert [one["person"] for one in recording["episodes"]] == [person["id"]]
    assert (
        ask.delete(f"/records/recordings/{recording['name']}").json()["notice"]["code"] == "recording_in_use"
    )

    zipped = ask.get(f"/records/people/{person['id']}/export").content
    brought = ask.post("/records/import", content=zipped).json()
    assert (brought["name"], brought["drives"]) == (f"{name} (2)", 1)
    (copy,) = ask.get("/records/drives", params={"person": brought["person"]}).json()["drives"]
    assert copy == {**drive, "id": copy["id"], "person": brought["person"]}
    assert ask.delete(f"/records/people/{brought['person']}").status_code == 204

    kept = ask.get(f"/records/people/{person['id']}").json()
    assert (kept["drives"], kept["episodes"]) == (1, 1)
    assert ask.delete(f"/records/drives/{drive['id']}").status_code == 204
    assert ask.get("/records/drives").json()["drives"] == []
    assert ask.post(f"/records/drives/{drive['id']}/restore").json() == drive
    ask.delete(f"/records/drives/{drive['id']}")
    assert ask.delete(f"/records/people/{person['id']}").status_code == 204
    assert everywhere(place, name, person["id"], brought["person"], drive["id"]) == []
    assert ask.get(f"/records/people/{person['id']}").status_code == 404


def test_settings_are_each_person_s_own(ask):
    ada, bea = (ask.post("/records/people", json={"name": name}).json()["id"] for name in ("Ada", "Bea"))
    assert (
        ask.put(f"/records/people/{ada}/settings", json={"panel": "dpad", "dwellS": 1.5}).status_code == 204
    )
    assert ask.get(f"/records/people/{ada}").json()["settings"] == {"panel": "dpad", "dwellS": 1.5}
    assert ask.get(f"/records/people/{bea}").json()["settings"] == {}
    assert ask.put(f"/records/people/{bea}", json={"name": "ＡＤＡ"}).json()["notice"]["code"] == (
        "person_name_taken"
    )
    assert ask.put(f"/records/people/{bea}", json={"name": "Béa"}).json()["name"] == "Béa"
    people = ask.get("/records/people").json()["people"]
    assert [one["name"] for one in people if one["id"] in (ada, bea)] == ["Ada", "Béa"]


MAPPED = {
    "uses": ["stop", "", "enable"],
    "axes": 3,
    "at": [2, 0],
    "way": [1, -1],
    "rest": [0.1, 0],
    "dead": 0.08,
}


def test_how_gamepads_are_used_goes_with_a_person_and_is_bounded(ask):
    ada, bea = (ask.post("/records/people", json={"name": name}).json()["id"] for name in ("Cem", "Dua"))
    settings = {"panel": "stick", "pads": {"045e-028e-Pad (x)": MAPPED}}
    assert ask.put(f"/records/people/{ada}/settings", json=settings).status_code == 204
    brought = ask.post("/records/import", content=ask.get(f"/records/people/{ada}/export").content).json()
    for person in (ada, brought["person"]):
        assert ask.get(f"/records/people/{person}").json()["settings"] == settings
    for pads in (
        {"a" * 121: MAPPED},
        {"a": MAPPED | {"uses": ["stop"] * 65}},
        {"a": MAPPED | {"uses": [["stop"]]}},
        {"a": [MAPPED]},
        {str(number): MAPPED for number in range(11)},
    ):
        assert ask.put(f"/records/people/{bea}/settings", json={"pads": pads}).status_code == 400
    assert ask.get(f"/records/people/{bea}").json()["settings"] == {}


@pytest.mark.parametrize(
    ("method", "path", "body"),
    [
        ("POST", "/records/people", b'{"name": 5}'),
        ("POST", "/records/people", b'{"name": "a", "name": "b"}'),
        ("POST", "/records/people", b"not json"),
        ("POST", "/records/people", b'{"name": "\\u202egnp"}'),
        ("POST", "/records/import", b"PK\x03\x04 and then nothing"),
        ("PUT", "/records/people/0123456789abcdef/settings", b'{"a": [1]}'),
        ("PUT", "/records/people/..%2f..%2fx", b'{"name": "x"}'),
        ("DELETE", "/records/drives/0123456789abcdef", b""),
        ("DELETE", "/records/recordings/..%2fsaid.sqlite", b""),
        ("GET", "/records/scenes/../scene.json", b""),
        ("GET", f"/records/scenes/{'A' * 32}/scene.json", b""),
    ],
)
def test_requests_for_what_is_not_there_are_refused(ask, method, path, body):
    answer = ask.request(method, path, content=body)
    assert 400 <= answer.status_code < 500


def test_another_site_can_change_nothing(server):
    for method, path in (("POST", "/records/people"), ("DELETE", "/records/people/0123456789abcdef")):
        with httpx.Client(base_url=server.origin, headers={"origin": "http://evil.example"}) as other:
            assert other.request(method, path, content=b'{"name":"x"}').status_code == 403
