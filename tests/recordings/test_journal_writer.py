import dataclasses
import json
import math
import os
import signal
import sqlite3
import subprocess
import sys
import tempfile
import textwrap
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from latentarm.core.errors import UserError
from latentarm.core.journal_limits import JournalFullError, JournalLimits, JournalLostError, JournalWatch
from latentarm.core.types import Command, Goal, GripperCommand, GripperReading, Pose, StepRecord, Stop
from latentarm.demonstrations.dataset import read_dataset, write_dataset
from latentarm.recordings.dataset_export import ImplausibleWarning, demonstrations_of
from latentarm.recordings.journal_reader import list_journal, read_journal
from latentarm.recordings.journal_samples import figures_of, packed, unpacked
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder

HOME = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])
NAMES = tuple(f"joint{i}" for i in range(7))


def goal(name, value):
    return Goal(name, np.full(7, value), Pose(np.array([value, 0.0, 0.5]), np.eye(3)))


def header(**changes):
    values = {
        "robot": "panda",
        "joint_names": NAMES,
        "rate_hz": 100.0,
        "task": "reach",
        "goals": (goal("cup", 0.1), goal("bowl", 0.2)),
        "modes": ("only",),
    }
    return EpisodeHeader(**{**values, **changes})


def record(tick, *, goals=2, stop=None, limited_by=()):
    rng = np.random.default_rng(tick)
    return StepRecord(
        time_s=100.0 + 0.01 * tick,
        state=HOME + rng.uniform(-0.005, 0.005, 7),
        input=rng.uniform(-1, 1, 2),
        latent=rng.normal(size=2),
        action_human=rng.normal(size=7),
        action_assist=rng.normal(size=7),
        alpha=rng.uniform(),
        belief=np.full(goals, 1.0 / goals) if goals else np.zeros(0),
        mode=tick % 3,
        command=Command(rng.normal(size=7), 0.025, stop, limited_by),
        bound_rad=math.nan if tick % 3 == 1 else rng.uniform(0, 9),
        pace=rng.uniform(),
    )


def same(one, other):
    for name in ("state", "input", "latent", "action_human", "action_assist", "belief"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert (one.time_s, one.alpha, one.mode, one.pace) == (other.time_s, other.alpha, other.mode, other.pace)
    np.testing.assert_equal(one.bound_rad, other.bound_rad)
    np.testing.assert_array_equal(one.command.velocity, other.command.velocity)
    assert one.command.duration_s == other.command.duration_s
    assert one.command.stop == other.command.stop
    assert one.command.limited_by == other.command.limited_by
    assert (one.gripper, one.command.gripper) == (other.gripper, other.command.gripper)
    np.testing.assert_array_equal(one.things, other.things)
    np.testing.assert_array_equal(one.sightings, other.sightings)


def write(path, episodes, *, end_last=True):
    recorder = Recorder(path)
    for index, ticks in enumerate(episodes):
        recorder.begin_episode(header())
        for tick in range(ticks):
            recorder.record(record(tick))
        if end_last or index < len(episodes) - 1:
            recorder.end_episode()
    recorder.close()


def test_reads_back_exactly_what_was_recorded(tmp_path):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header())
    given = [record(0), record(1, stop=Stop("No, thank you."), limited_by=("ramp", "clearance")), record(2)]
    for one in given:
        recorder.record(one)
    recorder.end_episode()
    recorder.close()
    (episode,) = read_journal(path)
    assert episode.complete
    assert episode.header.joint_names == NAMES
    assert episode.header.modes == ("only",)
    assert [goal.name for goal in episode.header.goals] == ["cup", "bowl"]
    np.testing.assert_array_equal(episode.header.goals[1].pose.position, [0.2, 0.0, 0.5])
    for one, other in zip(given, episode.records, strict=True):
        same(one, other)


def test_an_episode_that_was_not_ended_is_kept_and_flagged(tmp_path):
    path = tmp_path / "drive.sqlite"
    write(path, [5, 3], end_last=False)
    whole, cut = read_journal(path)
    assert (whole.complete, len(whole.records)) == (True, 5)
    assert (cut.complete, len(cut.records)) == (False, 3)


def test_the_table_of_contents_says_what_can_be_read_one_by_one(tmp_path):
    path = tmp_path / "drive.sqlite"
    write(path, [5, 1, 3], end_last=False)
    entries = list_journal(path)
    assert [entry.complete for entry in entries] == [True, True, False]
    assert {entry.header.task for entry in entries} == {header().task}
    for entry, episode in zip(entries, read_journal(path), strict=True):
        assert entry.duration_s == episode.records[-1].time_s - episode.records[0].time_s
        (alone,) = read_journal(path, only=[entry.number])
        assert len(alone.records) == len(episode.records)
    rewritten(path, lambda scalars: scalars[:3])
    with pytest.raises(UserError, match="damaged"):
        list_journal(path)


def rewritten(path, scalars_of):
    """Make a journal of version 1, with other times and scalars in every sample."""
    database = sqlite3.connect(path, isolation_level=None)
    samples = database.execute("SELECT episode, number, figures FROM samples").fetchall()
    for episode, number, figures in samples:
        scalars, *rest = unpacked(figures)[:8]
        parts = [scalars_of(scalars), *rest]
        widths = np.array([len(part) for part in parts], dtype=np.float64)
        changed = np.concatenate([widths, *parts]).tobytes()
        database.execute(
            "UPDATE samples SET figures = ? WHERE episode = ? AND number = ?", (changed, episode, number)
        )
    database.execute("PRAGMA user_version = 1")
    database.close()


@pytest.mark.parametrize(
    ("scalars", "missing"), [(4, {"bound_rad": math.nan, "pace": 1.0}), (5, {"pace": 1.0})]
)
def test_a_journal_from_before_the_bound_or_the_pace_is_read_and_gone_on_with(tmp_path, scalars, missing):
    path = tmp_path / "drive.sqlite"
    write(path, [3])
    rewritten(path, lambda every: every[:scalars])
    write(path, [2])
    old, new = read_journal(path)
    for tick, one in enumerate(old.records):
        same(dataclasses.replace(record(tick), **missing), one)
    same(record(0), new.records[0])
    assert "assist.bound" in demonstrations_of([old], source="drive").episodes[0].extras


OF_VERSION_2 = bytes.fromhex(
    "0205000200028002800200024001000200000000000000f83f000000000000e03f000000000000f03f9a9999999999993f00"
    "00000000000040000000000000d03f000000000000e0bf000000000000d03f000000000000e0bf000000000000f03f000000"
    "000000d03f000000000000e0bf"
)
"""A sample as it was written before there were grippers."""

OF_VERSION_3 = bytes.fromhex(
    "030500020002800280020002400100020002000300000000000000f83f000000000000e03f000000000000f03f9a99999999"
    "99993f0000000000000040000000000000d03f000000000000e0bf000000000000d03f000000000000e0bf000000000000f0"
    "3f000000000000d03f000000000000e0bfb81e85eb51b8ae3f000000000000f03f00000000000000009a9999999999a93f00"
    "00000000003440"
)
"""The same with a gripper, as it was written before there were things."""


OF_VERSION_5 = bytes.fromhex(
    "0407000200028002800200024001000200020003000700000000000000f83f000000000000e03f000000000000f03f9a9999"
    "999999993f0000000000000040000000000000f03f0000000000000000000000000000d03f000000000000e0bf0000000000"
    "00d03f000000000000e0bf000000000000f03f000000000000d03f000000000000e0bfb81e85eb51b8ae3f000000000000f0"
    "3f00000000000000009a9999999999a93f00000000000034400000000000000000000000000000f03f000000000000004000"
    "00000000000840000000000000104000000000000014400000000000001840"
)
"""The same with a thing, as it was written before a recording said who knew where things are."""


def test_a_journal_from_before_sources_were_recorded_still_has_its_things(tmp_path):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header(things=("cup",)))
    recorder.record(standing(0, np.ones((1, 7))))
    recorder.close()
    with sqlite3.connect(path) as database:
        database.execute("UPDATE episodes SET about = json_remove(about, '$.sources')")
        database.execute("UPDATE samples SET figures = ?", (OF_VERSION_5,))
        database.execute("PRAGMA user_version = 5")
    database.close()
    (episode,) = read_journal(path)
    np.testing.assert_array_equal(episode.records[0].things, np.arange(7.0)[None])
    assert (episode.header.sources, episode.records[0].sightings.size) == ((), 0)


@pytest.mark.parametrize(
    ("version", "sample", "measured", "asked"),
    [
        (2, OF_VERSION_2, None, None),
        (3, OF_VERSION_3, GripperReading(0.06, True), GripperCommand(0.0, 0.05, 20.0)),
    ],
)
def test_an_older_journal_is_read_and_gone_on_with(tmp_path, version, sample, measured, asked):
    path = tmp_path / "drive.sqlite"
    write(path, [1])
    with sqlite3.connect(path) as database:
        database.execute("UPDATE episodes SET about = json_remove(about, '$.things', '$.objects')")
        database.execute("UPDATE samples SET figures = ?", (sample,))
        database.execute(f"PRAGMA user_version = {version}")
    database.close()
    write(path, [2])
    old, new = read_journal(path)
    two, none = np.array([0.25, -0.5]), np.zeros(2)
    command = Command(two, 0.025, gripper=asked)
    same(
        StepRecord(1.5, two, none, none, two, two, 0.5, np.ones(1), 1, command, 2.0, measured), old.records[0]
    )
    same(record(0), new.records[0])


def gripped(tick, reading, asked):
    """The same step with a gripper."""
    one = record(tick)
    return dataclasses.replace(one, gripper=reading, command=dataclasses.replace(one.command, gripper=asked))


FINITE = st.floats(allow_nan=False, allow_infinity=False)
READINGS = st.none() | st.builds(GripperReading, FINITE, st.booleans())
GRIPPER_COMMANDS = st.none() | st.builds(GripperCommand, FINITE, FINITE, FINITE)


@settings(max_examples=15)
@given(st.lists(st.tuples(READINGS, GRIPPER_COMMANDS), min_size=10, max_size=40))
def test_a_gripper_is_read_back_exactly(steps):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "drive.sqlite"
        recorder = Recorder(path)
        recorder.begin_episode(header())
        given = [gripped(tick, *step) for tick, step in enumerate(steps)]
        for one in given:
            recorder.record(one)
        recorder.close()
        (episode,) = read_journal(path)
    for one, other in zip(given, episode.records, strict=True):
        same(one, other)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_gripper_that_is_not_finite_is_neither_written_nor_read(tmp_path, bad):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header())
    recorder.record(record(0))
    for step in ((GripperReading(bad), None), (None, GripperCommand(0.0, 0.1, bad))):
        with pytest.raises(UserError, match=r"drive\.sqlite.*gripper.*not finite"):
            recorder.record(gripped(1, *step))
    recorder.close()
    for parts in ([[bad, 0.0], []], [[0.04, 0.5], []], [[0.04], []], [[], [0.0, 0.1, bad]], [[], [0.0]]):
        later = (np.array(part, dtype=float) for part in (*parts, [], []))
        figures = packed([*figures_of(record(0))[:8], *later])
        with sqlite3.connect(path) as database:
            database.execute("UPDATE samples SET figures = ?", (figures,))
        database.close()
        with pytest.raises(UserError, match=r"drive\.sqlite is damaged.*gripper"):
            read_journal(path)


THINGS = ("plate", "cup")


def standing(tick, rows):
    """The same step with things about the arm, (K, 7)."""
    return dataclasses.replace(record(tick), things=np.array(rows, dtype=float))


@settings(max_examples=15)
@given(st.lists(arrays(np.float64, (2, 7), elements=FINITE), min_size=1, max_size=4), st.data())
def test_things_are_read_back_exactly_whether_they_move_or_not(places, data):
    where = data.draw(st.lists(st.sampled_from(places), min_size=1, max_size=20))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "drive.sqlite"
        recorder = Recorder(path)
        given = [standing(tick, rows) for tick, rows in enumerate(where)]
        for _ in range(2):
            recorder.begin_episode(header(things=THINGS, objects=("cup",)))
            for one in given:
                recorder.record(one)
            recorder.end_episode()
        recorder.close()
        episodes = read_journal(path)
    for episode in episodes:
        assert (episode.header.things, episode.header.objects) == (THINGS, ("cup",))
        for one, other in zip(given, episode.records, strict=True):
            same(one, other)


def test_what_stands_still_takes_no_room(tmp_path):
    rows = np.arange(14.0).reshape(2, 7)
    recorder = Recorder(tmp_path / "drive.sqlite")
    recorder.begin_episode(header(things=THINGS))
    for tick in range(3):
        recorder.record(standing(tick, rows + (tick == 2)))
    recorder.close()
    with sqlite3.connect(tmp_path / "drive.sqlite") as database:
        moved, still, moved_again = (
            len(one) for (one,) in database.execute("SELECT figures FROM samples ORDER BY number")
        )
    database.close()
    assert (moved - still, moved_again - still) == (14 * 8, 14 * 8)


def test_things_that_are_missing_or_not_finite_are_neither_written_nor_read(tmp_path):
    path = tmp_path / "drive.sqlite"
    rows = np.ones((2, 7))
    recorder = Recorder(path)
    recorder.begin_episode(header(things=THINGS))
    recorder.record(standing(0, rows))
    for bad, said in ((rows[:1], "other shapes"), (rows * np.nan, "things whose figures are not finite")):
        with pytest.raises(UserError, match=said):
            recorder.record(standing(1, bad))
    recorder.close()
    for rows in ([], np.ones(7), np.ones(13), np.full(14, np.inf)):
        figures = packed([*figures_of(record(0))[:10], np.array(rows, dtype=float), np.zeros(0)])
        with sqlite3.connect(path) as database:
            database.execute("UPDATE samples SET figures = ?", (figures,))
        database.close()
        with pytest.raises(UserError, match=r"drive\.sqlite is damaged .*things"):
            read_journal(path)
    with sqlite3.connect(path) as database:
        database.execute("UPDATE episodes SET about = json_set(about, '$.objects', json('[\"spoon\"]'))")
    database.close()
    with pytest.raises(UserError, match="an object is not among the things"):
        read_journal(path)


SOURCES = ("scene", "touch", "http")
SAID = st.tuples(st.integers(-1, len(SOURCES) - 1), st.floats(0.0, 600.0))


def said_by(tick, rows, said):
    """The same step with things of which somebody says where they are."""
    sightings = np.array(said, dtype=float).reshape(-1, 2)
    return dataclasses.replace(standing(tick, rows), sightings=sightings)


@settings(max_examples=15, deadline=None)
@given(st.lists(st.tuples(SAID, SAID), min_size=2, max_size=20))
def test_what_a_recording_says_of_sources_and_ages_is_read_and_exported_as_written(said):
    with tempfile.TemporaryDirectory() as folder:
        path, rows = Path(folder) / "drive.sqlite", np.ones((2, 7))
        recorder = Recorder(path)
        recorder.begin_episode(header(things=THINGS, objects=("cup",), sources=SOURCES))
        given = [said_by(tick, rows, one) for tick, one in enumerate(said)]
        for one in given:
            recorder.record(one)
        recorder.end_episode()
        # An episode of a program that did not know sources goes into the same dataset.
        recorder.begin_episode(header(things=THINGS, objects=("cup",)))
        for tick in range(2):
            recorder.record(standing(tick, rows))
        recorder.end_episode()
        recorder.close()
        known, unknown = read_journal(path)
        write_dataset(demonstrations_of(read_journal(path), source="drive"), Path(folder) / "dataset")
        exported = read_dataset(Path(folder) / "dataset")
    assert known.header.sources == SOURCES
    for one, other in zip(given, known.records, strict=True):
        same(one, other)
    assert all(one.sightings.size == 0 for one in unknown.records)
    assert exported.objects == ("cup",)
    for index, source in enumerate(SOURCES):
        first, second = (one.extras[f"observation.environment_age.{source}"] for one in exported.episodes)
        ages_s = [age_s if by == index else -1.0 for _, (by, age_s) in said]
        as_stored = np.array(ages_s, dtype=np.float32)[:, None]
        np.testing.assert_array_equal(first, as_stored)
        assert (second == -1.0).all()


@pytest.mark.parametrize("said", [[], [(0, 0.0)], [(3, 0.0)] * 2, [(0.5, 0.0)] * 2, [(1, -0.1)] * 2])
def test_sources_that_cannot_be_are_damage(tmp_path, said):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header(things=THINGS, sources=SOURCES))
    recorder.record(said_by(0, np.ones((2, 7)), [(0, 0.0)] * 2))
    recorder.close()
    figures = packed(figures_of(said_by(0, np.ones((2, 7)), said)))
    with sqlite3.connect(path) as database:
        database.execute("UPDATE samples SET figures = ?", (figures,))
    database.close()
    with pytest.raises(UserError, match=r"drive\.sqlite is damaged .*from where"):
        read_journal(path)


@pytest.mark.parametrize("count", [3, 8])
def test_a_sample_of_unknown_make_is_damage(tmp_path, count):
    path = tmp_path / "drive.sqlite"
    write(path, [3])
    rewritten(path, lambda scalars: np.resize(scalars, count))
    with pytest.raises(UserError, match="damaged"):
        read_journal(path)


ANY = st.floats(width=64) | st.sampled_from([0.0, -0.0, np.nan, np.inf, 5e-324])


FIVE = st.lists(arrays(np.float64, st.integers(0, 9), elements=ANY), min_size=5, max_size=5)


@given(FIVE, FIVE | st.none())
def test_a_sample_is_written_and_read_exactly(parts, others):
    parts = [part for part in parts for _ in range(2)] if others is None else [*parts, *others]
    parts += 2 * [parts[-1]]
    found = unpacked(packed(parts))
    # Bit for bit, so that -0.0 and NaN count too.
    assert [part.tobytes() for part in found] == [part.tobytes() for part in parts]


@given(st.sampled_from([b"", b"\x02", b"\x03", b"\x04", b"\x05"]), st.binary(max_size=120))
def test_bytes_that_are_no_sample_are_refused(start, rest):
    with suppress(ValueError):
        assert len(unpacked(start + rest)) in (8, 10, 11, 12)


def test_nothing_is_written_twice(tmp_path):
    zeros, u = np.zeros(7), np.array([0.1, 0.2])
    assert len(packed([zeros, u, u])) == 1 + 3 * 2 + 2 * 8


def test_the_log_is_folded_while_an_episode_is_recorded(tmp_path):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder._database.execute("PRAGMA wal_autocheckpoint = 20")
    recorder.begin_episode(header())
    for tick in range(300):
        recorder.record(record(tick))
        assert (tmp_path / "drive.sqlite-wal").stat().st_size < 60 * 2100
    recorder.close()
    (episode,) = read_journal(path)
    assert len(episode.records) == 300


@pytest.mark.parametrize("limits", [{"most_bytes": 60_000}, {"least_free_bytes": 10**18}])
def test_a_journal_without_room_ends_its_episode_whole(tmp_path, limits):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header())
    recorder.record(record(0))
    recorder._watch = JournalWatch(path, JournalLimits(**limits))

    def fill():
        for tick in range(1, 2000):
            recorder.record(record(tick))

    with pytest.raises(JournalFullError, match=r"drive\.sqlite.*recording was ended"):
        fill()
    if "least_free_bytes" in limits:
        with pytest.raises(JournalFullError):
            recorder.begin_episode(header())
    recorder.close()
    (episode,) = read_journal(path)
    assert episode.complete
    assert len(episode.records) > 50


def test_a_limit_that_is_none_is_refused():
    for bad in (-1, 1.5, None, True):
        with pytest.raises(UserError, match="most_bytes"):
            JournalLimits(most_bytes=bad)
    for bad in (-1.0, math.nan, math.inf):
        with pytest.raises(UserError, match="most-gb"):
            JournalLimits.of_gigabytes(bad, 0.5)


def deleted(path):
    path.unlink()


def replaced(path):
    other = path.with_name("other")
    other.write_bytes(path.read_bytes())
    other.replace(path)


def without_log(path):
    path.with_name(path.name + "-wal").unlink()


def without_folder(path):
    path.parent.rename(path.parent.with_name("elsewhere"))


@pytest.mark.parametrize("harm", [deleted, replaced, without_log, without_folder])
def test_a_journal_that_is_lost_while_it_is_written_is_noticed_within_a_second(tmp_path, harm):
    path = tmp_path / "teleop" / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header())
    for tick in range(150):
        recorder.record(record(tick))
    harm(path)

    def go_on():
        for tick in range(150, 250):
            recorder.record(record(tick))

    with pytest.raises(JournalLostError, match=r"drive\.sqlite was deleted, moved or replaced"):
        go_on()
    with pytest.raises(JournalLostError):
        recorder.check()
    recorder.close()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda one: {"state": np.full(7, np.nan)}, "could not be read"),
        (lambda one: {"state": np.zeros(7)}, "'joint1' moves at 7[0-9.]* rad/s|outside its limits"),
        (lambda one: {"state": one.state + np.eye(7)[2] * 9.0}, "'joint2' reads 9"),
        (lambda one: {"time_s": one.time_s - 1.0}, "clock"),
        (lambda one: {"time_s": math.nan}, "clock"),
    ],
)
@pytest.mark.parametrize("old", [False, True])
def test_an_episode_is_exported_as_far_as_it_can_be_true(tmp_path, arm, change, said, old):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    # Journals from before limits were kept name a robot that is known.
    recorder.begin_episode(header(joint_limits=None if old else arm.limits))
    for tick in range(20):
        one = record(tick)
        recorder.record(dataclasses.replace(one, **change(one)) if tick == 12 else one)
    recorder.end_episode()
    recorder.close()
    with pytest.warns(ImplausibleWarning, match=said):
        (episode,) = demonstrations_of(read_journal(path), source="drive").episodes
    assert len(episode.state) == 12
    assert np.isfinite(episode.state).all()


def test_what_cannot_be_true_from_its_beginning_is_no_episode(tmp_path):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header())
    for tick in range(20):
        recorder.record(dataclasses.replace(record(tick), state=np.zeros(7)))
    recorder.end_episode()
    recorder.close()
    with (
        pytest.warns(ImplausibleWarning, match="the episode is left out"),
        pytest.raises(UserError, match="no complete episode"),
    ):
        demonstrations_of(read_journal(path), source="drive")


def test_a_journal_goes_on_where_it_was_left(tmp_path):
    path = tmp_path / "drive.sqlite"
    write(path, [4])
    write(path, [2])
    assert [len(episode.records) for episode in read_journal(path)] == [4, 2]


def test_a_running_journal_can_be_read(tmp_path):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header())
    recorder.record(record(0))
    (episode,) = read_journal(path)
    assert len(episode.records) == 1
    recorder.record(record(1))
    recorder.close()


def test_reading_works_without_the_shared_memory_file(tmp_path):
    """A journal that was copied from elsewhere after a kill has its log, but not that."""
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header())
    recorder.record(record(0))
    copied = tmp_path / "copy"
    copied.mkdir()
    for name in ("drive.sqlite", "drive.sqlite-wal"):
        (copied / name).write_bytes((tmp_path / name).read_bytes())
    (episode,) = read_journal(copied / "drive.sqlite")
    assert len(episode.records) == 1
    recorder.close()


def test_records_outside_an_episode_or_of_other_shapes_are_refused(tmp_path):
    recorder = Recorder(tmp_path / "drive.sqlite")
    with pytest.raises(UserError, match="begin one"):
        recorder.record(record(0))
    with pytest.raises(UserError, match="begin one"):
        recorder.end_episode()
    recorder.begin_episode(header())
    recorder.record(record(0))
    with pytest.raises(UserError, match="shapes"):
        recorder.record(record(1, goals=3))
    recorder.close()


def test_what_is_no_journal_is_neither_written_nor_read(tmp_path):
    text = tmp_path / "notes.txt"
    text.write_text("not a database, but long enough to be looked at " * 100)
    foreign = tmp_path / "foreign.sqlite"
    with sqlite3.connect(foreign) as database:
        database.execute("CREATE TABLE things (name TEXT)")
    database.close()
    before = text.read_bytes(), foreign.read_bytes()
    for path in (text, foreign):
        with pytest.raises(UserError, match=path.name):
            Recorder(path)
        with pytest.raises(UserError, match=path.name):
            read_journal(path)
    assert (text.read_bytes(), foreign.read_bytes()) == before
    with pytest.raises(UserError, match="no journal"):
        read_journal(tmp_path / "absent.sqlite")
    assert not (tmp_path / "absent.sqlite").exists()


@pytest.mark.parametrize("tables", ["CREATE TABLE things (name)", "CREATE TABLE episodes (id, title)"])
def test_another_program_s_database_of_the_same_version_is_left_as_it_is(tmp_path, tables):
    path = tmp_path / "foreign.sqlite"
    database = sqlite3.connect(path)
    database.executescript(f"{tables}; PRAGMA user_version = 1;")
    database.close()
    before = path.read_bytes()
    for use in (Recorder, read_journal):
        with pytest.raises(UserError, match="not a journal"):
            use(path)
    assert path.read_bytes() == before


def test_an_episode_that_lost_a_sample_never_becomes_complete(tmp_path):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header())
    recorder.record(record(0))
    other = sqlite3.connect(path, isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    with pytest.raises(UserError, match="locked"):
        recorder.record(record(1))
    other.execute("ROLLBACK")
    other.close()
    with pytest.raises(UserError, match="no episode"):
        recorder.record(record(2))
    with pytest.raises(UserError, match="no episode"):
        recorder.end_episode()
    recorder.close()
    (episode,) = read_journal(path)
    assert (episode.complete, len(episode.records)) == (False, 1)


def test_a_damaged_journal_is_one_sentence(tmp_path):
    path = tmp_path / "drive.sqlite"
    write(path, [200])
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    refused = []
    for _ in range(30):
        damaged = bytearray(whole)
        at = int(rng.integers(100, len(whole) - 4096))
        damaged[at : at + 2048] = rng.bytes(2048)
        path.write_bytes(bytes(damaged))
        try:
            for episode in read_journal(path):
                assert all(len(one.state) == 7 for one in episode.records)
        except UserError as error:
            refused.append(str(error))
    assert all(str(path) in sentence for sentence in refused)
    assert len(refused) > 10
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(UserError, match=path.name):
        read_journal(path)


def test_a_full_disk_is_one_sentence(tmp_path):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    recorder.begin_episode(header())
    recorder.record(record(0))
    # SQLite's own limit on the file's size stands in for the disk's.
    recorder._database.execute("PRAGMA max_page_count = 6")

    def fill():
        for tick in range(1, 1000):
            recorder.record(record(tick))

    with pytest.raises(UserError, match=r"drive\.sqlite cannot be written: .*full"):
        fill()
    recorder.close()
    (episode,) = read_journal(path)
    assert not episode.complete
    assert len(episode.records) > 1


def test_exports_complete_episodes_with_all_that_was_decided(tmp_path):
    path = tmp_path / "drive.sqlite"
    write(path, [6, 5, 4], end_last=False)
    demonstrations = demonstrations_of(read_journal(path), source="drive")
    assert [len(episode.state) for episode in demonstrations.episodes] == [6, 5]
    episode = demonstrations.episodes[0]
    assert set(episode.extras) == {
        "input.u",
        "latent.z",
        "action.human",
        "action.assist",
        "assist.alpha",
        "assist.bound",
        "mode",
        "belief",
        "observation.environment_state",
    }
    np.testing.assert_allclose(episode.timestamp, 0.01 * np.arange(6), atol=1e-9)
    np.testing.assert_array_equal(episode.action[3], record(3).command.velocity)
    np.testing.assert_array_equal(episode.extras["input.u"][3], record(3).input)
    bounds = [record(tick).bound_rad for tick in range(6)]
    np.testing.assert_array_equal(episode.extras["assist.bound"][:, 0], np.nan_to_num(bounds, nan=-1.0))
    assert demonstrations.goals[0].name == "cup"
    assert demonstrations.rate_hz == 100.0


def test_the_exported_dataset_reads_back(tmp_path, arm):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    for ticks in (6, 5):
        recorder.begin_episode(header(joint_names=arm.joint_names))
        for tick in range(ticks):
            recorder.record(record(tick))
        if ticks == 6:
            recorder.end_episode()
    recorder.close()
    write_dataset(demonstrations_of(read_journal(path), source="drive"), tmp_path / "dataset")
    found = read_dataset(tmp_path / "dataset")
    assert len(found.episodes) == 1
    np.testing.assert_allclose(found.episodes[0].extras["action.human"][2], record(2).action_human, rtol=1e-6)
    np.testing.assert_allclose(found.episodes[0].extras["assist.bound"][:2, 0], [record(0).bound_rad, -1.0])
    np.testing.assert_allclose(found.goals[1].configuration, np.full(7, 0.2))


def recorded(path, *episodes):
    """A journal of complete episodes, each a list of a reading and a command of the gripper."""
    recorder = Recorder(path)
    for steps in episodes:
        recorder.begin_episode(header())
        for tick, step in enumerate(steps):
            recorder.record(gripped(tick, *step))
        recorder.end_episode()
    recorder.close()
    return path


HELD, OPEN = GripperReading(0.06, True), GripperReading(0.08)
CLOSE, LET_GO = GripperCommand(0.0, 0.05, 20.0), GripperCommand(0.08, 0.05, 20.0)


def test_a_gripper_s_life_goes_into_the_dataset(tmp_path, arm):
    from latentarm.demonstrations.gripper import gripper_uses

    steps = [(OPEN, None), (OPEN, CLOSE), (HELD, None), (HELD, None), (GripperReading(-1e-5), LET_GO)]
    journal = recorded(tmp_path / "drive.sqlite", steps, steps[:2])
    write_dataset(demonstrations_of(read_journal(journal), source="drive"), tmp_path / "dataset")
    demonstrations = read_dataset(tmp_path / "dataset")
    extras = demonstrations.episodes[0].extras
    width, holding, action = (
        extras[name].ravel()
        for name in ("observation.gripper_width", "observation.gripper_holding", "action.gripper")
    )
    np.testing.assert_allclose(width, [0.08, 0.08, 0.06, 0.06, 0.0], rtol=1e-6)
    np.testing.assert_array_equal(holding, [0, 0, 1, 1, 0])
    # It stays as it is until a command comes, which counts until the next.
    np.testing.assert_allclose(action, [0.08, 0.0, 0.0, 0.0, 0.08], rtol=1e-6)
    statistics = json.loads((tmp_path / "dataset/meta/stats.json").read_text())
    assert statistics["observation.gripper_width"]["max"] == [pytest.approx(0.08)]
    first, second = gripper_uses(demonstrations)
    assert (first.changes, first.closed_fraction) == (2, pytest.approx(0.75))
    assert (second.changes, second.closed_fraction) == (1, 0.0)


def test_an_episode_is_cut_where_its_gripper_could_not_be_read(tmp_path):
    path = recorded(tmp_path / "drive.sqlite", [(OPEN, None), (HELD, None), (None, None), (OPEN, None)])
    with pytest.warns(ImplausibleWarning, match="the gripper could not be read"):
        (episode,) = demonstrations_of(read_journal(path), source="drive").episodes
    assert len(episode.state) == 2


def test_episodes_with_a_gripper_and_without_do_not_mix(tmp_path):
    path = recorded(tmp_path / "drive.sqlite", [(OPEN, None)] * 3, [(None, None)] * 3)
    with pytest.raises(UserError, match=r"with a gripper and without: export them apart, with --episodes"):
        demonstrations_of(read_journal(path), source="drive")


def test_a_journal_without_a_complete_episode_exports_nothing(tmp_path):
    path = tmp_path / "drive.sqlite"
    write(path, [5], end_last=False)
    with pytest.raises(UserError, match="no complete episode"):
        demonstrations_of(read_journal(path), source="drive")


def test_episodes_of_different_robots_do_not_mix(tmp_path):
    path = tmp_path / "drive.sqlite"
    recorder = Recorder(path)
    for names in (NAMES, tuple(reversed(NAMES))):
        recorder.begin_episode(header(joint_names=names))
        for tick in range(3):
            recorder.record(record(tick))
        recorder.end_episode()
    recorder.close()
    with pytest.raises(UserError, match="different robots"):
        demonstrations_of(read_journal(path), source="drive")


WRITER = """
import sys
import numpy as np
from pathlib import Path
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder
from latentarm.core.types import Command, StepRecord
recorder = Recorder(Path(sys.argv[1]))
episode = 0
while True:
    recorder.begin_episode(EpisodeHeader("panda", tuple("abcdefg"), 100.0))
    for tick in range(150):
        one = np.full(7, float(tick))
        two = np.full(2, float(episode))
        command = Command(one, 0.025)
        recorder.record(StepRecord(0.01 * tick, one, two, two, one, one, 0.0, np.zeros(0), 0, command))
        sys.stdout.write(f"{episode} {tick}\\n")
        sys.stdout.flush()
    recorder.end_episode()
    sys.stdout.write(f"{episode} whole\\n")
    sys.stdout.flush()
    episode += 1
"""


def kill_and_read(path, seconds):
    """SIGKILL a recording after so long; every acknowledged sample and whole episode must be there."""
    child = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(WRITER), str(path)], stdout=subprocess.PIPE, text=True
    )
    first = child.stdout.readline()
    time.sleep(seconds)
    os.kill(child.pid, signal.SIGKILL)
    rest, _ = child.communicate()
    lines = (first + rest).split("\n")
    # The last line may be cut in the middle; what it was about was acknowledged before it was printed.
    acknowledged = [line.split() for line in lines[:-1]]
    episodes = read_journal(path)
    for number, what in acknowledged:
        episode = episodes[int(number)]
        if what == "whole":
            assert episode.complete
        else:
            assert episode.records[int(what)].state[0] == float(what)
            assert episode.records[int(what)].input[0] == float(number)
    # Nothing that was not recorded, either, and at most one sample more than was acknowledged.
    assert sum(len(episode.records) for episode in episodes) <= sum(w != "whole" for _, w in acknowledged) + 1
    assert [e.complete for e in episodes[:-1]] == [True] * (len(episodes) - 1)
    # The journal can be gone on with.
    write(path, [2])
    assert len(read_journal(path)) == len(episodes) + 1
    return len(acknowledged)


@pytest.mark.parametrize("seed", range(3))
def test_a_kill_at_any_moment_loses_nothing_that_was_acknowledged(tmp_path, seed):
    assert kill_and_read(tmp_path / "drive.sqlite", np.random.default_rng(seed).uniform(0.0, 0.4)) >= 1


@pytest.mark.slow
def test_thirty_kills_lose_nothing_that_was_acknowledged(tmp_path):
    rng = np.random.default_rng(30)
    for number in range(30):
        kill_and_read(tmp_path / f"drive{number}.sqlite", rng.uniform(0.0, 1.5))
