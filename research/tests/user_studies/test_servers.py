"""Several servers share a study's database: people are spread over them, and go on where one has gone."""

import json
import shutil
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import httpx
import pytest

from latentarm_research.user_studies.serving.database import postgresql
from latentarm_research.user_studies.serving.servers import GONE_S
from latentarm_research.user_studies.serving.store import Store
from latentarm_research.user_studies.serving.study_files import STEPS
from postgres import postgres
from study_participant import MODES, TWIST, definition, next_link, participant, serving

NOW_S = 1000.0
PEOPLE = 4
ARMS = {"a": 1, "b": 2}


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    store = Store(tmp_path / "study.sqlite")
    store.open_places(9)
    yield store
    store.close()


def arrivals(store: Store, count: int) -> list[str]:
    """The keys of so many people who come."""
    return [str(store.arrive(str(store.unused()), "", NOW_S)) for _ in range(count)]


def test_people_are_spread_by_arms_and_stay_as_long_as_their_server_runs(store: Store) -> None:
    servers = {name: store.servers(name, f"http://{name}", arms) for name, arms in ARMS.items()}
    for one in servers.values():
        one.announce(NOW_S)
    keys = arrivals(store, 6)
    at = [servers["a"].elsewhere(key, NOW_S) or "http://a" for key in keys]
    assert at.count("http://b") == 2 * at.count("http://a") == 4
    for key, address in zip(keys, at, strict=True):
        for name, one in servers.items():
            assert one.elsewhere(key, NOW_S) == (None if address == f"http://{name}" else address)
    later_s = NOW_S + GONE_S + 1.0
    servers["b"].announce(later_s)
    assert {servers["b"].elsewhere(key, later_s) for key in keys} == {None}
    servers["a"].announce(later_s)
    # Who has gone on elsewhere stays there.
    assert {servers["a"].elsewhere(key, later_s) for key in keys} == {"http://b"}
    servers["b"].leave()
    assert {servers["a"].elsewhere(key, later_s) for key in keys} == {None}


def test_a_server_that_starts_again_keeps_its_people(store: Store) -> None:
    first, other = (store.servers(name, f"http://{name}", 1) for name in ("a", "b"))
    first.announce(NOW_S)
    other.announce(NOW_S)
    (key,) = arrivals(store, 1)
    assert first.elsewhere(key, NOW_S) is None
    store.servers("a", "http://a:2", 1).announce(NOW_S)
    assert other.elsewhere(key, NOW_S) == "http://a:2"


@pytest.mark.slow
def test_the_people_of_a_killed_server_go_on_at_the_other(tmp_path: Path) -> None:
    study, outs = tmp_path / "two_ways.json", [tmp_path / "one", tmp_path / "other"]
    study.write_text(json.dumps({**definition(MODES, TWIST), "people": PEOPLE}))
    with postgres() as url, ExitStack() as running:
        started = []
        for out in outs:
            options = ("--out", str(out), "--database", url, "--at-once", "2")
            started.append(running.enter_context(serving(str(study), *options)))
            if out is outs[0]:
                shutil.copytree(out, outs[1], ignore=shutil.ignore_patterns(".*"))
        links = [next_link(outs[0], number) for number in range(PEOPLE)]
        at = [origin_of(str(httpx.get(link, follow_redirects=True).url)) for link in links]
        assert sorted(map(at.count, set(at))) == [PEOPLE // 2] * 2
        for origin, link in zip(at, links, strict=True):
            with participant(origin, link.replace(origin_of(link), origin)) as person:
                person.consent()
                person.ready()
                person.drive()
        (killed, process), (left, _) = started
        process.kill()
        time.sleep(GONE_S + 1.0)
        there = [link.replace(origin_of(killed), origin_of(left)) for link in links]
        for link in there:
            with participant(left, link) as person:
                person.take_part()
        store = Store(postgresql(url))
        people = store.people()
        (deleted,) = store.withdraw_by_code(links[-1].rpartition("=")[2])
        store.close()
        drives = [(one.key, drive.order, drive.trial, drive.choice) for one in people for drive in one.drives]
        assert len(set(drives)) == len(drives)
        assert all(one.finished for one in people)
        assert sorted(one.number or 0 for one in people) == list(range(PEOPLE))
        # Who is deleted by a command elsewhere leaves no steps in the folder of a server that runs.
        assert any((out / STEPS / deleted.key).exists() for out in outs)
        deadline_s = time.monotonic() + 10.0
        listed = outs[1] / "links.csv"
        while (outs[1] / STEPS / deleted.key).exists() or deleted.next_code not in listed.read_text():
            assert time.monotonic() < deadline_s
            time.sleep(0.1)


def origin_of(address: str) -> str:
    return address.partition("/study")[0]
