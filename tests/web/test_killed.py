"""Servers and their arm's process that are killed, and a second server where one runs."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from urllib.parse import urlsplit

import httpx
import pytest

from latentarm.demonstrations.folders import locked
from latentarm.recordings.journal_reader import read_journal
from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.arm_process.replay import replay
from latentarm.web.records.drives import Wanted
from latentarm.web.records.records import Records

from .conftest import Site, wait_for

pytestmark = pytest.mark.clock


def command(out):
    return [sys.executable, "-m", "latentarm", "teleop", "--port", "0", "--json", "--out", str(out)]


IN_A_TERMINAL = """
import fcntl, os, signal, sys, termios
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # whatever runs the tests may ignore it
os.setsid()
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
os.execv(sys.argv[1], sys.argv[1:])
"""


@contextmanager
def in_a_terminal(out):
    """A server as somebody starts it in a window; and a function that closes the window."""
    ours, theirs = os.openpty()
    words = [sys.executable, "-c", IN_A_TERMINAL, *command(out)]
    with subprocess.Popen(words, stdin=theirs, stdout=theirs, stderr=theirs) as server:
        os.close(theirs)
        said = b""
        while b"}" not in said:
            said += os.read(ours, 1 << 16)
        address = json.loads(re.search(rb"{.*}", said).group())["address"]
        window = [ours]
        try:
            yield server, Site(urlsplit(address).port, None, None), lambda: os.close(window.pop())
        finally:
            for one in window:
                os.close(one)
            if server.poll() is None:
                server.kill()


def alive_in_group(group):
    """Processes of a group, by what they run; Python's own, which tidies up, ends last."""
    listed = subprocess.run(["ps", "-eo", "pgid=,stat=,args="], capture_output=True, text=True, check=True)
    rows = [line.split(maxsplit=2) for line in listed.stdout.splitlines()]
    return [row[2] for row in rows if row[0] == str(group) and not row[1].startswith("Z")]


@pytest.mark.parametrize(
    "how",
    [
        "window",  # a hang-up
        pytest.param("SIGTERM", marks=pytest.mark.slow),
        pytest.param("SIGHUP", marks=pytest.mark.slow),
        pytest.param("SIGTERM to all", marks=pytest.mark.slow),
    ],
)
def test_however_a_server_is_ended_the_drive_is_kept_the_arm_stops_and_all_can_be_read(tmp_path, how):
    with in_a_terminal(tmp_path) as (server, site, close_window), site.page() as page:
        page.send(type="record", on=True, task="until the end")
        page.drive(1.0, 0.0)
        wait_for(lambda: any(drive.way_m >= 0.01 for drive in drives_in(tmp_path)))
        match how:
            case "window":
                close_window()
            case "SIGTERM to all":  # as systemd does
                os.killpg(server.pid, signal.SIGTERM)
            case _:
                server.send_signal(signal.Signals[how])
        server.wait(60)
        wait_for(lambda: not alive_in_group(server.pid), within_s=10.0)
    drives = drives_in(tmp_path)  # a busy computer may stop the arm, and then there is more than one
    assert max(drive.way_m for drive in drives) >= 0.01
    assert all(drive.scene is not None or drive.ended == "broken_off" for drive in drives)
    (journal,) = tmp_path.glob("*.sqlite")
    (episode,) = read_journal(journal)
    assert len(episode.records) > 20
    assert not episode.records[-1].command.velocity.any()
    found = replay(max((tmp_path / "incidents").iterdir()))
    assert found["complete"]
    assert found["agreed"] == found["ticks"] >= len(episode.records)
    assert "Traceback" not in (tmp_path / "teleop.log").read_text()
    with locked(tmp_path, tmp_path / ".teleop.lock"):
        pass  # the next server can start


@contextmanager
def running(out):
    """A server of its own process, and what connects to it."""
    with subprocess.Popen(command(out), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as server:
        try:
            said = server.stdout.readline()
            assert said, server.stderr.read()
            yield server, Site(urlsplit(json.loads(said)["address"]).port, None, None)
        finally:
            server.send_signal(signal.SIGINT)


def drives_in(out):
    return Records(out, dict, lambda: None).drives.wanted(Wanted())


def test_a_drive_under_a_killed_server_is_kept_as_broken_off_and_the_next_server_starts_at_once(tmp_path):
    with running(tmp_path) as (server, site), site.page() as page:
        page.drive(1.0, 0.0)
        wait_for(lambda: any(drive.way_m >= 0.01 for drive in drives_in(tmp_path)))
        server.kill()
        server.wait()
    (broken,) = drives_in(tmp_path)
    assert (broken.ended, broken.outcome, broken.inputs) == ("broken_off", None, ("pointer",))
    assert 0.0 < broken.moving_s <= broken.time_s
    assert broken.way_m >= 0.01
    with running(tmp_path) as (_, site):
        (listed,) = httpx.get(f"{site.origin}/records/drives").json()["drives"]
        assert (listed["id"], listed["ended"]) == (broken.id, "broken_off")
        second = subprocess.run(command(tmp_path), capture_output=True, text=True, timeout=120)
        assert (second.returncode, second.stdout) == (2, "")
        assert second.stderr == (
            f"latentarm: The folder {tmp_path} is being written by another program; end it with Ctrl-C,"
            " or choose another folder with --out.\n"
        )
        with site.page() as page:
            page.drive(1.0, 0.0)
    ended = [drive for drive in drives_in(tmp_path) if drive.id != broken.id]
    assert ended
    assert all(drive.ended != "broken_off" and drive.scene is not None for drive in ended)


def test_a_drive_is_kept_even_if_the_server_is_killed_as_it_begins(tmp_path):
    with running(tmp_path) as (server, site), site.page() as page:
        page.enable()
        wait_for(lambda: list(tmp_path.glob("records/**/drives/*.json")))
        server.kill()
    assert [drive.ended for drive in drives_in(tmp_path)] == ["broken_off"]


def test_a_drive_whose_arm_process_is_killed_is_in_the_history_at_once(serve, tmp_path):
    with serve(Spec(out=tmp_path)) as site, site.page() as page:
        page.drive(1.0, 0.0)
        os.kill(site.control._process.pid, signal.SIGKILL)
        drives = wait_for(lambda: httpx.get(f"{site.origin}/records/drives").json()["drives"])
    assert [drive["ended"] for drive in drives] == ["broken_off"]
    assert [drive.ended for drive in drives_in(tmp_path)] == ["broken_off"]


@pytest.mark.parametrize(
    "numbers", [(signal.SIGINT, signal.SIGINT), (signal.SIGTERM,)], ids=["twice", "term"]
)
def test_a_server_that_has_just_begun_ends_when_it_is_told(tmp_path, numbers):
    with subprocess.Popen(
        command(tmp_path), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as server:
        server.stdout.readline()
        for number in numbers:
            server.send_signal(number)
            time.sleep(0.05)
        _, said = server.communicate(timeout=60)
    assert server.returncode == 0
    assert said.endswith("The page is closed.\n")
    assert "Traceback" not in said
    with locked(tmp_path, tmp_path / ".teleop.lock"):
        pass  # the next server can start
