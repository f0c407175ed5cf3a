"""No finished drive is lost or doubled, and no place is given twice, whatever breaks."""

import json
import os
import threading
import time
from collections.abc import Generator, Iterator
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from pathlib import Path
from typing import Any, final

import httpx
import numpy as np
import pytest
from sqlalchemy import create_engine, select

from latentarm_research.user_studies.recorded import DATABASE
from latentarm_research.user_studies.serving.database import database_of
from latentarm_research.user_studies.serving.tables import Drive, Place
from postgres import postgres
from study_line import Line
from study_participant import MODES, TWIST, Participant, definition, next_link, participant, serving

FAULTS = int(os.environ.get("LATENTARM_STUDY_FAULTS", "2"))
"""Number of faults of each kind."""

pytestmark = pytest.mark.slow


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request: pytest.FixtureRequest) -> Iterator[str | None]:
    """The URL of a database; None for a file in the study's folder."""
    with postgres() if request.param == "postgresql" else nullcontext() as url:
        yield url


@final
class Served:
    """A study that is served and breaks."""

    def __init__(self, folder: Path, database: str | None) -> None:
        study, self.out = folder / "two_ways.json", folder / "people"
        study.write_text(json.dumps({**definition(MODES, TWIST), "people": FAULTS + 1}))
        options = [] if database is None else ["--database", database]
        self.command = (str(study), "--out", str(self.out), *options)
        self.database = database_of(self.out / DATABASE, database)
        self.person = 0

    @contextmanager
    def driver(self, address: str) -> Generator[Participant]:
        """The person whose next drive is due, at this server."""
        while True:
            with participant(address, next_link(self.out, self.person)) as person:
                does = {"consent": person.consent, "practice": person.ready, "questions": person.answer}
                while (part := person.part) in does:
                    does[part]()
                if part == "trial":
                    yield person
                    return
            self.person += 1

    def kept(self) -> dict[tuple[Any, ...], str]:
        """The drives that are kept; each is the first of its trial, and nobody shares a place."""
        url = f"sqlite:///{self.database}" if isinstance(self.database, Path) else self.database
        engine = create_engine(url)
        try:
            with engine.connect() as connection:
                names = (Drive.person, Drive.order, Drive.task, Drive.trial, Drive.choice, Drive.attempt)
                drives = {
                    tuple(row[:-1]): row[-1] for row in connection.execute(select(*names, Drive.record))
                }
                numbers = connection.scalars(select(Place.number).where(Place.person.is_not(None))).all()
        finally:
            engine.dispose()
        assert all(attempt == 0 for *_, attempt in drives)
        assert sorted(numbers) == list(range(len(numbers)))
        return drives


def test_nothing_is_lost_or_doubled_when_the_server_is_killed(tmp_path: Path, database: str | None) -> None:
    rng, study = np.random.default_rng(FAULTS), Served(tmp_path, database)
    with serving(*study.command) as (link, _), study.driver(link) as person:
        begun_s = time.monotonic()
        person.drive()
        # A busy computer takes longer from the press on Begin to the end.
        whole_s = time.monotonic() - begun_s
    before, seen = study.kept(), 0
    assert len(before) == 1
    for _ in range(FAULTS):
        with serving(*study.command) as (link, server):
            after = study.kept()
            # A drive whose end they saw is there.
            assert before.items() <= after.items()
            assert len(before) + seen <= len(after) <= len(before) + 1
            with study.driver(link) as person:
                before, seen = study.kept(), 0
                killing = threading.Timer(rng.uniform(0.0, 1.5 * whole_s), server.kill)
                killing.start()
                with suppress(httpx.TransportError, OSError, AssertionError):
                    person.drive()
                    seen = 1
                killing.join()
    with serving(*study.command) as (link, _):
        assert len(before) + seen <= len(study.kept()) <= len(before) + 1
        with participant(link, next_link(study.out, study.person)) as person:
            person.take_part()


@pytest.mark.parametrize("fault", ["tab closed", "network cut"])
def test_nothing_is_lost_or_doubled_when_a_page_goes(
    tmp_path: Path, database: str | None, fault: str
) -> None:
    rng, study = np.random.default_rng(FAULTS), Served(tmp_path, database)
    with serving(*study.command) as (link, _):
        for _ in range(FAULTS):
            with ExitStack() as until_back:
                with study.driver(link) as person:
                    before, way = study.kept(), {}
                    assert person.post("begin").json()["to"] == "/"
                    end_s = time.monotonic() + rng.uniform(0.0, 3.0)
                    line = until_back.enter_context(Line(person.origin))
                    if fault == "network cut":
                        way = {"sock": line.end, "close_timeout": 0.1}
                    with person.connected(**way) as page:
                        person.push(page, lambda end_s=end_s: time.monotonic() > end_s, [0.0, 1.0])
                        line.cut.set()
                with participant(link, next_link(study.out, study.person)) as person:
                    for _ in range(5):
                        # The drive of before may end by itself while they go on with it.
                        with suppress(AssertionError):
                            if person.part == "trial":
                                person.drive()
                    assert person.part != "trial"
                    after = study.kept()
            assert before.items() <= after.items()
            assert len(after) == len(before) + 1
