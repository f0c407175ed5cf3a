"""After an incident, one file says what happened, decides it again to the bit, and names nobody."""

import json
import os
import signal
import time
import zlib
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import pytest
from wooden_server import wooden_server

from latentarm import cli
from latentarm.robots.panda import panda
from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.arm_process.initial_state import RobotOptions
from latentarm.web.records.people import People


def freeze(site, page, server):
    server.pause_s = 0.12


def garble(site, page, server):
    server.unreadable = True


def press(site, page, server):
    server.press_emergency_stop()


def pull_out(site, page, server):
    server.cut()
    page.wait(lambda state: state["lost"])


def fall_silent(site, page, server):
    page.u = None


def kill(site, page, server):
    os.kill(site.control._process.pid, signal.SIGKILL)


KINDS = {
    "controller silent": (freeze, "reading_old", "newest reading is"),
    "not a number": (garble, "joints_invalid", "not numbers"),
    "emergency stop": (press, "arm_emergency_stop", "emergency stop"),
    "cable": (pull_out, "reading_old", "check the connection"),
    "late page": (fall_silent, "input_late", ""),
    "killed": (kill, None, None),
}
FIRST = ("cable", "killed")
"""A stop that the page's process decides, and an end that nobody decides; the others take the same way."""
"""What happens, the code of the stop that follows, and some of its words."""


def contents(path):
    """Everything in a report, as text."""
    with ZipFile(path) as packed:
        found = {one: packed.read(one) for one in packed.namelist()}
    return {
        name: zlib.decompressobj(31).decompress(content) if name.endswith(".gz") else content
        for name, content in found.items()
    }


@pytest.mark.parametrize(
    "kind", [kind if kind in FIRST else pytest.param(kind, marks=pytest.mark.slow) for kind in KINDS]
)
def test_an_incident_is_reported_and_replayed_to_the_bit(serve, tmp_path, capsys, kind):
    happen, code, words = KINDS[kind]
    spec = Spec(out=tmp_path / "teleop", robot=RobotOptions("panda"), found=(("firmware", "2.1"),))
    with wooden_server(panda()) as server:
        spec = Spec(arm=server.address, out=spec.out, robot=spec.robot, found=spec.found)
        with serve(spec) as site, site.page() as page:
            page.send(type="mode", mode="end_effector", axes=0)
            page.drive(1.0, 0.0)
            happen(site, page, server)
            page.wait(lambda state: state["phase"] in ("disengaged", "neutral_needed"))
            time.sleep(0.2)
            server.pause_s, server.unreadable = 0.0, False
            server.repair()
    report = tmp_path / "report.zip"
    assert cli.main(["report", str(tmp_path / "teleop"), "--out", str(report)]) == 0
    about = json.loads(contents(report)["report.json"])
    (told,) = about["incidents"]
    assert told["arm"] == {"firmware": "2.1"}
    assert told["settings"]["safety"]["joint_speed"] == 0.5
    assert told["settings"]["arm"] == "wooden"
    assert {"latentarm", "python", "system", "packages"} == about["versions"].keys()
    events = told["events"]
    enabled = next(index for index, event in enumerate(events) if "enabled" in event)
    if code is None:
        assert "enabled" in events[-1]
    else:
        stop = next(event for event in events[enabled:] if event.get("stopped") == code)
        assert words in stop["words"]
        assert stop["time_s"] > 0.1
    capsys.readouterr()
    assert cli.main(["replay", str(report), "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out).values()
    assert found["agreed"] == found["ticks"] == told["ticks"] > 10
    assert found["complete"] is (kind != "killed")
    assert "127.0.0.1" not in str(contents(report))


def test_a_report_names_nobody_and_no_address(serve, trained, tmp_path, capsys):
    out = tmp_path / "teleop"
    people = People(out / "records" / "people")
    ada = people.keep_pin(people.add("Ada Lovelace").id, "271828")
    with serve(Spec(trained, out=out), pins=True) as site, site.page("Bob Marley") as page:
        page.drive(1.0, 0.0)
        page.send(type="stop")
        page.wait(lambda state: (state["reason"] or {}).get("code") == "stop_pressed_by")
        assert page.state["reason"]["parameters"]["name"] == "Bob Marley"  # pages say who it was
    (out / "teleop.log").write_text(
        f"The profile of Ada Lovelace in {Path.home()}/x, at franka://172.16.0.2/y and 10.0.0.7:9090\n"
    )
    report = tmp_path / "report.zip"
    assert cli.main(["report", str(out), "--out", str(report)]) == 0
    everything = contents(report)
    assert set(everything) > {"report.json", "logs/teleop.log"}
    text = b"".join(everything.values()).decode()
    assert "Somebody pressed Stop." in text
    secrets = (ada.pin.hash, ada.pin.salt, ada.id, str(tmp_path), str(trained.parent), str(Path.home()))
    for hidden in ("Lovelace", "Marley", "172.16.0.2", "10.0.0.7", "127.0.0.1", *secrets):
        at = text.find(hidden)
        assert at < 0, text[max(at - 80, 0) : at + 80]
    assert cli.main(["replay", str(report)]) == 0
    assert "gave the same command, to the bit" in capsys.readouterr().out


def test_the_name_of_a_profile_stays_here_and_the_profile_is_replayed(desk_of, trained, tmp_path, capsys):
    from latentarm.web.arm_process.drive_setup import load_setup

    from .test_incident import drive_straight, recorded

    assert cli.main(["align", str(trained), "--simulated", "--answers", "2", "--name", "Grace Hopper"]) == 0
    setup = load_setup(Spec(trained, profile="Grace Hopper"))
    with desk_of(setup) as desk, recorded(desk, tmp_path / "teleop"):
        drive_straight(desk)
    report = tmp_path / "report.zip"
    assert cli.main(["report", str(tmp_path / "teleop"), "--out", str(report)]) == 0
    text = b"".join(contents(report).values()).decode()
    assert "profiles/person/alignment.safetensors" in text
    assert "Grace" not in text
    assert cli.main(["replay", str(report)]) == 0
    assert f"{len(desk.records)} of {len(desk.records)} ticks" in capsys.readouterr().out


def test_the_drive_that_went_wrong_can_be_named_and_old_versions_are_said(tmp_path, capsys):
    from .test_incident import CallLog, JournalLimits

    folder = tmp_path / "incidents"
    for day in (24, 25, 26):
        CallLog(folder / f"202611{day}-100000-000000.incident.gz", JournalLimits(), [{"incident": 1}]).close()
    report = tmp_path / "report.zip"
    assert cli.main(["report", str(tmp_path), "--drive", "2026-11-25T12:00+00:00", "--out", str(report)]) == 0
    told = json.loads(contents(report)["report.json"])["incidents"]
    assert [one["file"][:8] for one in told] == ["20261125", "20261124"]
    assert all("another version" in one["damaged"] for one in told)
    with (folder / "20261124-100000-000000.incident.gz").open("ab") as file:
        file.truncate(30 << 20)
    capsys.readouterr()
    assert cli.main(["report", str(tmp_path), "--out", str(report)]) == 0
    assert "20261124-100000-000000.incident.gz and 0 older" in capsys.readouterr().out
    assert len(json.loads(contents(report)["report.json"])["incidents"]) == 2
    for when, said in (("2026-11-24T09:00+00:00", "no incident file from before"), ("today", "is no time")):
        assert cli.main(["report", str(tmp_path), "--drive", when]) == 2
        assert said in capsys.readouterr().err
    assert cli.main(["report", str(tmp_path / "teleop")]) == 2


@pytest.mark.parametrize("damage", ["none", "deflated", "cut"])
def test_a_report_of_strangers_is_refused_in_a_sentence(tmp_path, capsys, damage):
    path = tmp_path / "r.zip"
    name = "incidents/x.incident.gz" if damage == "deflated" else "other/../../x.incident.gz"
    with ZipFile(path, "w", ZIP_DEFLATED) as packed:
        packed.writestr(name, bytes(100_000))
    if damage == "cut":
        path.write_bytes(path.read_bytes()[:40])
    assert cli.main(["replay", str(path)]) == 2
    assert capsys.readouterr().err.startswith("latentarm: ")
    assert [one.name for one in tmp_path.iterdir()] == ["r.zip"]
