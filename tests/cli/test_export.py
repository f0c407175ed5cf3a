"""Recordings leave a journal from the command line."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.types import Command, GripperCommand, GripperReading, Provenance, StepRecord
from latentarm.demonstrations.dataset import read_dataset
from latentarm.demonstrations.provenance import provenance_now
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def teleop(workplace: Path) -> Path:
    """A folder as `latentarm teleop` leaves it: three episodes, the last cut short."""
    recorder = Recorder(workplace / "teleop/journal-20260102-030405.sqlite")
    for index in range(3):
        by = provenance_now(Provenance("\x1b[31mAda", "eat-cvae", controller="latent"))
        recorder.begin_episode(
            EpisodeHeader(
                "arm",
                ("a", "b"),
                100.0,
                f"stab {index} [/nope]",
                provenance=by,
                things=("cup",),
                sources=("touch", "http"),
            )
        )
        for tick in range(5):
            two = np.full(2, 0.01 * (tick + index))
            command = Command(two, 0.05, gripper=GripperCommand(0.0, 0.05, 20.0) if tick == 2 else None)
            gripper = GripperReading(0.08 if tick < 3 else 0.06, holding=tick >= 3)
            recorder.record(
                StepRecord(
                    0.01 * tick,
                    two,
                    two,
                    two,
                    two,
                    two,
                    0.0,
                    np.zeros(0),
                    0,
                    command,
                    gripper=gripper,
                    things=np.array([[0.5, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0]]),
                    sightings=np.array([[tick % 2, 0.05 * tick]]),
                )
            )
        if index < 2:
            recorder.end_episode("gamepad")
    recorder.close()
    return workplace / "teleop"


def test_what_was_recorded_is_listed(run: Run, teleop: Path) -> None:
    code, out, _ = run("export", "teleop")
    assert code == 0
    assert "stab 1 [/nope]" in out
    assert "cut short" in out
    assert "\x1b" not in out
    assert "--out" in out
    code, out, _ = run("export", "teleop", "--json")
    listed = json.loads(out)
    assert [(one["episode"], one["complete"], one["device"]) for one in listed] == [
        (1, True, "gamepad"),
        (2, True, "gamepad"),
        (3, False, None),
    ]


def test_recordings_become_a_dataset_that_inspect_shows(run: Run, teleop: Path) -> None:
    code, out, _ = run("export", "teleop", "--out", "eaten")
    assert code == 0
    assert "2 of 3 episodes are in eaten/" in out
    assert "1 were cut short" in out
    assert [one.task for one in read_dataset(Path("eaten")).episodes] == ["stab 0 [/nope]", "stab 1 [/nope]"]
    code, out, _ = run("inspect", "eaten")
    assert code == 0
    assert "Ada" in out
    assert "gamepad" in out
    assert "eat-cvae" in out
    # Closed for the second half of each episode; two episodes of four steps.
    closed = [line.split()[1:] for line in out.partition("Gripper")[2].splitlines() if "50" in line]
    assert closed == [["50", "–", "1"]] * 2
    code, _, err = run("export", "teleop", "--out", "eaten")
    assert code == 2
    assert "already exists" in err


def test_episodes_are_chosen_by_number(run: Run, teleop: Path) -> None:
    assert run("export", "teleop", "--episodes", "2-3", "--incomplete", "--out", "some")[0] == 0
    first, second = read_dataset(Path("some")).episodes
    assert (first.task, second.task) == ("stab 1 [/nope]", "stab 2 [/nope]")
    assert first.provenance is not None
    assert second.provenance is not None
    assert (first.provenance.complete, second.provenance.complete) == (True, False)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("teleop", "--episodes", "3"), "episode 3 was cut short: .* --incomplete"),
        (("teleop", "--episodes", "4"), "has episodes 1 to 3"),
        (("teleop", "--episodes", "2-1"), "has episodes 1 to 3"),
        (("teleop", "--episodes", "all"), "neither a number"),
        (("nowhere",), "no journal nowhere"),
        (("eaten.txt",), "eaten.txt"),
        ((".",), "holds no journal"),
    ],
)
def test_what_cannot_be_exported_is_refused(
    run: Run, teleop: Path, words: tuple[str, ...], said: str
) -> None:
    import re

    Path("eaten.txt").write_text("no journal")
    code, out, err = run("export", *words, "--out", "new")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert re.search(said, err)
    assert not Path("new").exists()


def test_recordings_become_a_file_that_foxglove_shows(run: Run, teleop: Path) -> None:
    reader = pytest.importorskip("mcap.reader")
    code, out, _ = run("export", "teleop", "--format", "mcap", "--episodes", "1", "--out", "eaten.mcap")
    assert (code, out) == (0, "1 of 3 episodes are in eaten.mcap.\n")
    with Path("eaten.mcap").open("rb") as file:
        found = [
            (schema.name, channel.topic, message.log_time, json.loads(message.data))
            for schema, channel, message in reader.make_reader(file).iter_messages()
        ]
    joints = [message for name, _, _, message in found if name == "foxglove.JointStates"]
    assert len(joints) == 5
    assert joints[1]["joints"][0] == {"name": "a", "position": 0.01, "velocity": 0.01}
    steps = [message for _, topic, _, message in found if topic == "/step"]
    assert steps[3]["gripper_m"] == [0.06]
    assert steps[3]["sightings"] == [{"thing": "cup", "source": "http", "age_s": pytest.approx(0.15)}]
    times = [at_ns for _, topic, at_ns, _ in found if topic == "/step"]
    assert times[1] - times[0] == pytest.approx(1e7, abs=1e3)
    assert times[0] > 1e18  # in this century
    assert [message["message"] for name, _, _, message in found if name == "foxglove.Log"] == ["enabled"]
    assert run("export", "teleop", "--format", "mcap", "--out", "eaten.mcap")[0] == 2
