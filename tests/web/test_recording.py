"""What the page is told of a recording that cannot go on, and what is kept of it."""

import threading

import numpy as np
import pytest

from latentarm.core.journal_limits import JournalLimits
from latentarm.core.types import Command, StepRecord, Stop
from latentarm.recordings.journal_reader import read_journal
from latentarm.recordings.journal_writer import EpisodeHeader
from latentarm.web.arm_process import episode_writer
from latentarm.web.arm_process.episode_writer import EpisodeWriter

HEADER = EpisodeHeader("panda", tuple(f"joint{i + 1}" for i in range(7)), 100.0)


def sample(tick, *, state=None, stop=None):
    zeros = np.zeros(7)
    state = 0.5 + 0.01 * tick if state is None else state
    command = Command(zeros, 0.05, stop)
    return StepRecord(
        0.01 * tick, np.full(7, state), zeros[:2], zeros[:2], zeros, zeros, 0.0, zeros[:0], 0, command
    )


def recorded(writer):
    writer.close()
    (episode,) = read_journal(next(writer._folder.glob("*.sqlite")))
    return episode


@pytest.mark.parametrize(
    "bad",
    [
        {"state": np.nan},
        {"stop": Stop("The reading of joint 'joint3' jumped.", untrusted=True)},
        {"state": np.nan, "stop": Stop("The joints are not numbers.", untrusted=True)},
    ],
)
def test_an_episode_ends_before_what_cannot_be_trusted_and_says_why(tmp_path, bad):
    writer = EpisodeWriter(tmp_path)
    writer.begin(HEADER)
    for tick in range(20):
        writer.add(sample(tick, **(bad if tick >= 12 else {})))
    assert not writer.on
    assert writer.status.problem.code == ("recording_ended" if "stop" in bad else "joints_unreadable")
    if "stop" in bad:
        assert bad["stop"].reason in writer.status.problem.text
    episode = recorded(writer)
    assert episode.complete
    assert len(episode.records) == 12
    assert np.isfinite([record.state for record in episode.records]).all()


def test_a_recording_may_begin_while_the_reason_of_an_earlier_stop_is_still_shown(tmp_path):
    writer = EpisodeWriter(tmp_path)
    old = Stop("The reading of joint 'joint3' jumped.", untrusted=True)
    writer.add(sample(0, stop=old))
    writer.begin(HEADER)
    for tick in range(1, 9):
        writer.add(sample(tick, stop=old if tick < 4 else None))
    writer.end()
    assert len(recorded(writer).records) == 8
    assert writer.status.problem is None


def test_a_full_journal_ends_the_episode_whole_and_says_so(tmp_path):
    writer = EpisodeWriter(tmp_path, JournalLimits(most_bytes=150_000))
    writer.begin(HEADER)
    for tick in range(400):
        writer.add(sample(tick, state=0.5 + 1e-4 * tick))
    episode = recorded(writer)
    assert writer.status.problem.code == "journal_full"
    assert not writer.on
    assert episode.complete
    assert 0 < len(episode.records) < 400
    assert writer.status.episodes == 1


@pytest.mark.parametrize("during", ["an episode", "the time between two"])
def test_a_deleted_journal_is_noticed_and_the_next_episode_goes_into_another(tmp_path, monkeypatch, during):
    monkeypatch.setattr(episode_writer, "_CHECK_S", 0.005)
    writer = EpisodeWriter(tmp_path)
    writer.begin(HEADER)
    written = threading.Event()
    for tick in range(10):
        writer.add(sample(tick))
    if during != "an episode":
        writer.end()
    while not (files := list(tmp_path.glob("*.sqlite"))) or writer._waiting.qsize():
        written.wait(0.002)
    files[0].unlink()
    # Its thread ends when it has noticed.
    writer._thread.join(timeout=20.0)
    assert writer.status.problem.code == "journal_lost"
    assert not writer.on
    writer.begin(HEADER)
    for tick in (10, 11, 12):
        writer.add(sample(tick))
    writer.end()
    assert writer.status.problem is None
    writer.close()
    (episode,) = read_journal(next(iter(tmp_path.glob("*.sqlite"))))
    assert (episode.complete, len(episode.records)) == (True, 3)


@pytest.mark.parametrize("ending", ["the person", "a reading that cannot be trusted"])
def test_an_episode_in_which_nothing_moved_is_not_kept(tmp_path, ending):
    writer = EpisodeWriter(tmp_path)
    writer.begin(HEADER)
    for tick in range(10):
        writer.add(sample(tick, state=0.5 + 1e-4 * tick))
    if ending == "the person":
        writer.end()
        assert writer.status.problem.text == "The arm did not move, so this recording was not kept."
    else:
        writer.add(sample(10, state=np.nan))
    writer.begin(HEADER)
    for tick in range(10):
        writer.add(sample(tick))
    writer.end()
    assert recorded(writer).header == HEADER
    assert writer.status.episodes == 1
