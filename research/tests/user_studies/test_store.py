"""Places are given in order and never twice, and no drive is lost or doubled, whatever happens."""

import json
import tempfile
import threading
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from latentarm.core.errors import UserError
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.serving.store import Store
from latentarm_research.user_studies.trace import Trace

PLACES, AWAY_S, TRIALS = 4, 100.0, 2
WHO = st.integers(0, 5)


def drive(person: int, trial: int) -> DriveRecord:
    trace = Trace(person, "A", "task", trial, 0, True, (), (), (), ())
    return DriveRecord(
        people_are="real", person=person, condition="A", order=0, task="task", trial=trial, choice=0,
        attempt=0, ending="done", measures={"time_s": 1.0}, trace=trace,
    )  # fmt: skip


class Study(RuleBasedStateMachine):
    """People come, drive, go away for hours, come again, withdraw and finish; the server is killed."""

    def __init__(self) -> None:
        super().__init__()
        self.folder = tempfile.TemporaryDirectory()
        self.path = Path(self.folder.name) / "study.sqlite"
        self.store = Store(self.path, AWAY_S)
        self.store.open_places(PLACES)
        self.now_s = 0.0
        self.keys: dict[int, str] = {}
        self.driven: dict[int, list[int]] = {}
        self.finished: set[int] = set()
        self.had: dict[int, int] = {}
        self.seen_s: dict[int, float] = {}

    def teardown(self) -> None:
        self.store.close()
        self.folder.cleanup()

    def held(self) -> dict[int, int]:
        """The place of each person who has one."""
        standings = {who: self.store.standing(key) for who, key in self.keys.items()}
        return {who: one.number for who, one in standings.items() if one and one.number is not None}

    @rule(who=WHO)
    def comes(self, who: int) -> None:
        before = self.held()
        key = self.store.arrive(f"link{who}", "visit", self.now_s)
        assert key is not None
        assert self.keys.setdefault(who, key) == key
        number = self.store.place(key, self.now_s)
        after = self.held()
        # Only places of people who were away are taken back.
        away = {one for one, seen_s in self.seen_s.items() if seen_s < self.now_s - AWAY_S}
        assert before.keys() - after.keys() <= away
        if number is None:
            assert who in self.had or len(after) == PLACES
        elif who in self.had:
            assert number == self.had[who]
        else:
            # No order is begun while an earlier one is free.
            assert set(range(number)) <= set(after.values())
        if number is not None and who not in before:
            self.had[who], self.seen_s[who] = number, self.now_s

    @rule(who=WHO, trial=st.integers(0, TRIALS - 1))
    def drives(self, who: int, trial: int) -> None:
        number = self.held().get(who)
        if number is None:
            return
        for _ in range(2):  # it may be given twice: by the server, and by the one after it
            self.store.keep_drive(self.keys[who], drive(number, trial))
        theirs = self.driven.setdefault(who, [])
        if trial not in theirs:
            theirs.append(trial)

    @rule(who=WHO)
    def finishes(self, who: int) -> None:
        if who in self.held():
            self.store.finish(self.keys[who], "code")
            self.finished.add(who)

    @rule(who=WHO)
    def withdraws(self, who: int) -> None:
        if who in self.keys:
            key = self.keys.pop(who)
            self.store.withdraw(key)
            self.driven.pop(who, None)
            self.had.pop(who, None)
            self.seen_s.pop(who, None)
            self.finished.discard(who)
            assert self.store.standing(key) is None
            assert key.encode() not in self.path.read_bytes()

    @rule(span_s=st.sampled_from([1.0, 60.0, 150.0]))
    def time_passes(self, span_s: float) -> None:
        self.now_s += span_s

    @rule()
    def server_is_killed(self) -> None:
        self.store.close()
        self.store = Store(self.path, AWAY_S)
        self.store.open_places(PLACES)

    @invariant()
    def nothing_is_lost_or_doubled(self) -> None:
        places = list(self.held().values())
        assert len(places) == len(set(places))
        assert self.finished <= self.held().keys()
        for who, key in self.keys.items():
            standing = self.store.standing(key)
            assert standing is not None
            assert [one.trial for one in standing.drives] == self.driven.get(who, [])
            assert (standing.completion is not None) == (who in self.finished)


Study.TestCase.settings = settings(max_examples=10, stateful_step_count=30, deadline=None)
TestStudy = Study.TestCase


def test_people_who_come_at_once_get_different_places(tmp_path: Path) -> None:
    stores = [Store(tmp_path / "study.sqlite") for _ in range(4)]
    stores[0].open_places(8)
    given: list[Any] = []

    def come(number: int) -> None:
        store = stores[number % len(stores)]
        key = store.arrive(f"link{number}", "visit", 0.0)
        given.append(store.place(str(key), 0.0))

    threads = [threading.Thread(target=come, args=[number]) for number in range(9)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for store in stores:
        store.close()
    assert sorted(given, key=str) == [0, 1, 2, 3, 4, 5, 6, 7, None]


def test_codes_are_arguments_of_a_command_and_cells_of_a_spreadsheet(tmp_path: Path) -> None:
    codes = Store(tmp_path / "study.sqlite", AWAY_S).open_places(300)
    assert len({*codes}) == 300
    assert all(code.isalnum() for code in codes)


def test_another_file_is_refused(tmp_path: Path) -> None:
    (path := tmp_path / "study.sqlite").write_text("no database, " * 100)
    with pytest.raises(UserError, match="not the database of a study"):
        Store(path)


def test_the_published_schema_is_that_of_the_record() -> None:
    published = Path(__file__).parents[3] / "docs" / "study-drive.schema.json"
    assert json.loads(published.read_text()) == DriveRecord.model_json_schema()
