"""Servers and their arm's process that are killed, and a second server where one runs."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from urllib.parse import urlsplit

import httpx
import pytest

from latentarm.demonstrations.folders import locked
from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.records.drives import Wanted
from latentarm.web.records.record_files import SYSTEM_CALENDAR
from latentarm.web.records.records import Records

from .conftest import Site, wait_for

pytestmark = pytest.mark.clock


def command(out):
    return [sys.executable, "-m", "latentarm", "teleop", "--port", "0", "--json", "--out", str(out)]


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
    return Records(out, dict, lambda: None, SYSTEM_CALENDAR).drives.wanted(Wanted())


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
            f"latentarm: {tmp_path} is being written by another program; end it with Ctrl-C, or choose"
            " another folder with --out.\n"
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
        os.kill(site.control.pid, signal.SIGKILL)
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
