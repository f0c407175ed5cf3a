"""What a detector posts, through the process of the sources, and what is refused."""

import json
import os
import subprocess
import sys
import time
from http.client import HTTPConnection
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.surroundings.catalogue import open_source
from latentarm.surroundings.http import MOST_BYTES
from latentarm.surroundings.process import Inbox, SourceProcess

BOWL = {"name": "bowl", "position_m": [0.5, -0.1, 0.28], "position_sd_m": 0.004, "age_s": 0.2}


@pytest.fixture(scope="module")
def source():
    made = open_source("http:0", ["bowl", "cup"])
    yield made
    made.close()


def post(port, body, path="/things", **headers):
    """The status and what is said."""
    given = body if isinstance(body, bytes) else json.dumps(body).encode()
    link = HTTPConnection("127.0.0.1", port, timeout=5.0)
    link.request("POST", path, given, headers)
    answer = link.getresponse()
    said = answer.read()
    link.close()
    return answer.status, json.loads(said)["detail"] if said else ""


def test_what_is_posted_is_read_once_with_the_time_of_its_picture(source):
    assert post(source.port, {"things": [BOWL]}) == (204, "")
    (seen,) = source.read()
    assert (seen.name, seen.position_sd_m) == ("bowl", 0.004)
    assert seen.time_s == pytest.approx(time.monotonic() - 0.2, abs=0.15)
    np.testing.assert_allclose(seen.pose.position, BOWL["position_m"])
    assert source.read() == ()


@pytest.mark.parametrize(
    ("body", "status", "said"),
    [
        (b"{", 400, "JSON"),
        ({"things": [BOWL | {"name": "Bowl"}]}, 422, "There is no thing 'Bowl'; there is: bowl, cup."),
        ({"things": [BOWL | {"position_m": [0.5, "left", 0.3]}]}, 422, "things.0.position_m.1: "),
        ({"things": [BOWL | {"position_m": [0.5, 0.1, 40.0]}]}, 422, "within 10 m"),
        ({"things": [BOWL | {"position_sd_m": 0.0}]}, 422, "standard deviation"),
        ({"things": [BOWL | {"quaternion_wxyz": [1.0, 1.0, 0.0, 0.0]}]}, 422, "must have the length 1"),
        ({"things": [BOWL | {"age_s": -1.0}]}, 422, "things.0.age_s"),
        ({"things": [BOWL | {"colour": "red"}]}, 422, "things.0.colour"),
        (b'{"things": [{"name": "bowl", "position_m": [NaN, 0, 0], "position_sd_m": 1}]}', 422, "position_m"),
        (b"[" * 60_000, 400, ""),
        (b" " * (MOST_BYTES + 1), 413, f"at most {MOST_BYTES} bytes"),
    ],
)
def test_a_bad_body_is_refused_in_one_sentence_and_nothing_of_it_is_taken(source, body, status, said):
    found, detail = post(source.port, body)
    assert found == status
    assert said in detail
    assert detail.endswith(".")
    assert "\n" not in detail
    assert source.read() == ()


@pytest.mark.parametrize(
    ("path", "headers", "status"),
    [
        ("/things", {"Host": "evil.example"}, 403),
        ("/things", {"Origin": "https://evil.example"}, 403),
        ("/other", {}, 404),
    ],
)
def test_pages_of_other_sites_cannot_post(source, path, headers, status):
    assert post(source.port, {"things": [BOWL]}, path, **headers)[0] == status
    assert source.read() == ()


def test_the_example_posts_what_is_taken(source):
    example = Path(__file__).parents[2] / "examples/your_own_detector.py"
    named = os.environ | {"OBJECTS_PORT": str(source.port)}
    done = subprocess.run(
        [sys.executable, example], capture_output=True, text=True, timeout=30, check=True, env=named
    )
    assert done.stdout == "Posted.\n"
    (seen,) = source.read()
    assert seen.name == "bowl"


@pytest.mark.parametrize("rest", ["", "x", "8470?hold=1", "8470?hold_s=nan", "8470?hold_s=900", "99999"])
def test_a_malformed_option_is_one_sentence(rest):
    with pytest.raises(UserError, match="--objects http"):
        open_source(f"http:{rest}", ["bowl"])


def test_sightings_reach_the_loop_on_its_own_clock_and_a_taken_port_is_refused(source):
    with pytest.raises(UserError, match=f"--objects http:{source.port} cannot be opened"):
        SourceProcess([f"http:{source.port}"], ["bowl"])
    port = source.port
    source.close()
    sources = SourceProcess([f"http:{port}?hold_s=3"], ["bowl"])
    try:
        inbox, found, end_s = Inbox(sources.sightings), [], time.monotonic() + 10.0
        assert post(port, {"things": [BOWL]})[0] == 204
        while not found and time.monotonic() < end_s:
            found = inbox.read(1000.0)
        sighting, named, hold_s = found[0]
        assert (named, hold_s) == (f"http:{port}?hold_s=3", 3.0)
        assert 998.0 < sighting.time_s <= 999.8
    finally:
        sources.end()
    assert inbox.read(1001.0) == []
