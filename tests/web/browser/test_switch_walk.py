"""A helper clicks and presses anything: one choice is lit, and a switch does that and nothing else."""

import httpx
import pytest

from switch_walk import Walk

PRESSES = 120


@pytest.fixture(scope="module")
def served(start_server, trained, tmp_path_factory):
    """A server of its own, with a person whose PIN is asked for."""
    with start_server(tmp_path_factory.mktemp("switch_walk"), str(trained), "--pin") as address:
        headers = {"origin": address}
        person = httpx.post(f"{address}/records/people", json={"name": "Bo"}, headers=headers).json()["id"]
        httpx.put(f"{address}/records/people/{person}/pin", json={"pin": "1234"}, headers=headers)
        yield address


@pytest.mark.parametrize("seed", [1, 2])
def test_a_switch_does_what_is_lit_and_nothing_else(chromium, served, seed):
    """10,000 presses are a command: `tests/switch_walk.py` says which."""
    context = chromium.new_context()
    events = []
    try:
        walk = Walk(context.new_page(), served, seed, events.append)
        walk.go(PRESSES)
    finally:
        context.close()
    assert walk.faults == []
    # It was about something.
    assert walk.did["click"] > 5
    assert walk.did["on list"] > 5
