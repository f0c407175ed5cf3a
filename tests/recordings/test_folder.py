"""Who recorded what, from the journal's header into the dataset."""

import json
import sqlite3
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.types import Command, Provenance, StepRecord
from latentarm.demonstrations.dataset import append_episode, read_dataset, write_dataset
from latentarm.demonstrations.provenance import BY_HAND, provenance_now
from latentarm.recordings.dataset_export import demonstrations_of
from latentarm.recordings.folder import list_recordings, read_episodes
from latentarm.recordings.journal_reader import list_journal, read_journal
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder

NAMES = ("shoulder", "elbow")


def step(tick: int) -> StepRecord:
    two = np.full(2, 0.01 * tick)
    return StepRecord(
        time_s=5.0 + 0.01 * tick,
        state=two,
        input=two,
        latent=two,
        action_human=two,
        action_assist=two,
        alpha=0.0,
        belief=np.zeros(0),
        mode=0,
        command=Command(two, 0.05),
    )


def journal(
    path: Path, *, people: tuple[str, ...] = ("Ada",), end_last: bool = True, controller: str = "latent"
) -> Path:
    recorder = Recorder(path)
    for index, person in enumerate(people):
        by = provenance_now(Provenance(person, "eat-cvae", "ab" * 32, controller=controller))
        recorder.begin_episode(EpisodeHeader("arm", NAMES, 100.0, f"stab {index}", provenance=by))
        for tick in range(11):
            recorder.record(step(tick))
        if end_last or index < len(people) - 1:
            recorder.end_episode(device="keyboard")
    recorder.close()
    return path


def test_who_recorded_an_episode_goes_into_the_dataset(tmp_path: Path) -> None:
    recordings = list_recordings(journal(tmp_path / "a.sqlite"))
    (listed,) = recordings
    assert (listed.entry.samples, listed.entry.duration_s) == (11, pytest.approx(0.1))
    write_dataset(demonstrations_of(read_episodes(recordings), source="a"), tmp_path / "data")
    (episode,) = read_dataset(tmp_path / "data").episodes
    by = episode.provenance
    assert by is not None
    assert by == Provenance(
        person="Ada",
        run="eat-cvae",
        run_fingerprint="ab" * 32,
        device="keyboard",
        controller="latent",
        version=by.version,
        started_utc=by.started_utc,
    )
    assert by.started_utc.endswith("+00:00")
    append_episode(tmp_path / "data", episode)
    assert [one.provenance for one in read_dataset(tmp_path / "data").episodes] == [by, by]


@pytest.mark.parametrize("controller", ["latent", BY_HAND])
def test_the_action_is_the_command_or_else_the_motion_by_hand(tmp_path: Path, controller: str) -> None:
    episodes = read_journal(journal(tmp_path / "a.sqlite", controller=controller))
    (episode,) = demonstrations_of(episodes, source="a").episodes
    assert episode.action is not None
    by_hand = np.full((11, 2), 1.0)  # 0.01 rad in each 10 ms
    commanded = np.stack([record.command.velocity for record in episodes[0].records])
    np.testing.assert_allclose(episode.action, by_hand if controller == BY_HAND else commanded, atol=1e-9)


def test_a_journal_from_before_this_was_recorded_reads_as_unknown(tmp_path: Path) -> None:
    path = journal(tmp_path / "old.sqlite")
    with sqlite3.connect(path) as database:
        database.execute("UPDATE episodes SET about = json_remove(about, '$.provenance')")
    database.close()
    assert list_journal(path)[0].header.provenance == Provenance()
    assert read_journal(path)[0].header.provenance == Provenance()


def test_journals_of_a_folder_are_counted_through(tmp_path: Path) -> None:
    journal(tmp_path / "b.sqlite", people=("Bob", "Cy"), end_last=False)
    journal(tmp_path / "a.sqlite")
    recordings = list_recordings(tmp_path)
    assert [(one.number, one.entry.header.provenance.person) for one in recordings] == [
        (1, "Ada"),
        (2, "Bob"),
        (3, "Cy"),
    ]
    whole = demonstrations_of(read_episodes(recordings), source="here")
    assert [one.provenance.person for one in whole.episodes if one.provenance] == ["Ada", "Bob"]
    cut = (
        demonstrations_of(read_episodes(recordings[2:]), source="here", incomplete=True)
        .episodes[0]
        .provenance
    )
    assert cut is not None
    assert (cut.person, cut.complete, cut.device) == ("Cy", False, "")


def test_a_folder_without_journals_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="holds no journal"):
        list_recordings(tmp_path)


@pytest.mark.parametrize("wrong", ["Ada", {"person": 3}, {"complete": "yes"}, [None]])
def test_a_damaged_provenance_is_refused(tmp_path: Path, wrong: object) -> None:
    path = journal(tmp_path / "a.sqlite")
    write_dataset(demonstrations_of(read_episodes(list_recordings(path)), source="a"), tmp_path / "data")
    info = tmp_path / "data/meta/info.json"
    document = json.loads(info.read_text())
    document["latentarm"]["provenance"] = [wrong]
    info.write_text(json.dumps(document))
    with pytest.raises(UserError, match="who recorded its episodes"):
        read_dataset(tmp_path / "data")
    with sqlite3.connect(path) as database:
        database.execute(
            "UPDATE episodes SET about = json_set(about, '$.provenance', json(?))", (json.dumps(wrong),)
        )
    database.close()
    with pytest.raises(UserError, match="is damaged"):
        read_journal(path)
