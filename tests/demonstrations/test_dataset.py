import json
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, Goal, Pose
from latentarm.demonstrations.dataset import (
    LOCK_FILE,
    append_episode,
    read_dataset,
    write_dataset,
)
from latentarm.demonstrations.folders import locked, staged_folder
from latentarm.demonstrations.validation import RESERVED_FEATURES

Equal = Callable[[Demonstrations, Demonstrations], bool]
MakeEpisode = Callable[..., Episode]

NAMES = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=8)
FEATURES = NAMES.filter(lambda name: "/" not in name and name not in RESERVED_FEATURES)


def numbers(shape: tuple[int, ...]) -> st.SearchStrategy[np.ndarray]:
    return npst.arrays(np.float64, shape, elements=st.floats(-1e30, 1e30))


@st.composite
def any_demonstrations(draw: st.DrawFn) -> Demonstrations:
    dof = draw(st.integers(1, 4))
    extras = draw(st.dictionaries(FEATURES, st.integers(1, 3), max_size=2))
    acts = draw(st.booleans())
    episodes = []
    for _ in range(draw(st.integers(1, 3))):
        samples = draw(st.integers(2, 5))
        steps = draw(npst.arrays(np.float64, samples, elements=st.floats(0.01, 1)))
        episodes.append(
            Episode(
                state=draw(numbers((samples, dof))),
                timestamp=np.cumsum(steps),
                action=draw(numbers((samples, dof))) if acts else None,
                task=draw(st.text(st.characters(exclude_categories=["Cs"]), max_size=8)),
                extras={name: draw(numbers((samples, width))) for name, width in extras.items()},
            )
        )
    goals = tuple(
        Goal(draw(NAMES), draw(numbers((dof,))), Pose(draw(numbers((3,))), draw(numbers((3, 3)))))
        for _ in range(draw(st.integers(0, 2)))
    )
    return Demonstrations(
        episodes=tuple(episodes),
        rate_hz=draw(st.floats(0.1, 1000)),
        joint_names=tuple(draw(st.lists(NAMES, min_size=dof, max_size=dof, unique=True))),
        robot=draw(st.text(st.characters(exclude_categories=["Cs"]), max_size=8)),
        goals=goals,
    )


@given(given_demonstrations=any_demonstrations())
@settings(max_examples=40)
def test_what_is_written_is_read_again(given_demonstrations: Demonstrations, equal: Equal) -> None:
    with tempfile.TemporaryDirectory() as folder:
        write_dataset(given_demonstrations, Path(folder) / "data")
        assert equal(read_dataset(Path(folder) / "data"), given_demonstrations)


def test_appending_gives_what_writing_at_once_gives(
    tmp_path: Path, demonstrations: Demonstrations, equal: Equal
) -> None:
    write_dataset(demonstrations, tmp_path / "whole")
    write_dataset(replace(demonstrations, episodes=demonstrations.episodes[:1]), tmp_path / "grown")
    for episode in demonstrations.episodes[1:]:
        append_episode(tmp_path / "grown", episode)
    assert equal(read_dataset(tmp_path / "grown"), demonstrations)
    whole = {path.relative_to(tmp_path / "whole") for path in (tmp_path / "whole").rglob("*")}
    assert whole == {path.relative_to(tmp_path / "grown") for path in (tmp_path / "grown").rglob("*")}
    for path in whole:
        if path.suffix == ".parquet":
            assert pq.read_table(tmp_path / "grown" / path).equals(pq.read_table(tmp_path / "whole" / path))
        elif path.suffix == ".json":
            assert (tmp_path / "grown" / path).read_text() == (tmp_path / "whole" / path).read_text()


def test_a_full_data_file_is_followed_by_the_next(
    tmp_path: Path, demonstrations: Demonstrations, episode_of: MakeEpisode, equal: Equal
) -> None:
    path = tmp_path / "data"
    write_dataset(demonstrations, path)
    info = path / "meta/info.json"
    small = json.loads(info.read_text()) | {"data_files_size_in_mb": 0, "chunks_size": 2}
    info.write_text(json.dumps(small))
    added = (episode_of(3), episode_of(4, task="stir"), episode_of(5))
    for episode in added:
        append_episode(path, episode)
    assert equal(read_dataset(path), replace(demonstrations, episodes=demonstrations.episodes + added))
    names = sorted(str(file.relative_to(path / "data")) for file in (path / "data").rglob("*.parquet"))
    assert names == [f"chunk-00{chunk}/file-00{file}.parquet" for chunk in (0, 1) for file in (0, 1)]


def test_statistics_are_those_of_all_samples(tmp_path: Path, demonstrations: Demonstrations) -> None:
    write_dataset(demonstrations, tmp_path / "data")
    stats = json.loads((tmp_path / "data/meta/stats.json").read_text())["observation.state"]
    states = np.concatenate([episode.state for episode in demonstrations.episodes])
    for measure in ("min", "max", "mean", "std"):
        np.testing.assert_allclose(stats[measure], getattr(states, measure)(axis=0), rtol=1e-5)
    assert stats["count"] == [len(states)]


def test_a_destination_in_use_is_left_alone(tmp_path: Path, demonstrations: Demonstrations) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full/diary.txt").write_text("mine")
    (tmp_path / "file").write_text("mine")
    with pytest.raises(UserError, match="already exists and is not empty"):
        write_dataset(demonstrations, tmp_path / "full")
    with pytest.raises(UserError, match="is not a folder"):
        write_dataset(demonstrations, tmp_path / "file")
    assert [path.name for path in sorted(tmp_path.rglob("*"))] == ["file", "full", "diary.txt"]
    assert (tmp_path / "full/diary.txt").read_text() == "mine"


def test_an_empty_folder_will_do(tmp_path: Path, demonstrations: Demonstrations) -> None:
    write_dataset(demonstrations, tmp_path)


def test_a_folder_that_cannot_be_written_is_said(tmp_path: Path, demonstrations: Demonstrations) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="cannot be written"):
        write_dataset(demonstrations, tmp_path / "file" / "data")


def test_what_a_killed_writer_left_is_cleared(
    tmp_path: Path, demonstrations: Demonstrations, equal: Equal
) -> None:
    (tmp_path / ".data.part" / "data").mkdir(parents=True)
    (tmp_path / ".data.part" / "data" / "half").write_text("half")
    write_dataset(demonstrations, tmp_path / "data")
    assert [path.name for path in tmp_path.iterdir()] == ["data"]
    assert equal(read_dataset(tmp_path / "data"), demonstrations)


def test_two_writers_do_not_meet(tmp_path: Path, demonstrations: Demonstrations) -> None:
    path = tmp_path / "data"
    write_dataset(demonstrations, path)
    before = sorted(path.rglob("*"))
    with locked(path, path / LOCK_FILE), pytest.raises(UserError, match="written by another program"):
        append_episode(path, demonstrations.episodes[0])
    assert sorted(path.rglob("*")) == before
    append_episode(path, demonstrations.episodes[0])
    assert not (path / LOCK_FILE).exists()


def test_two_programs_do_not_write_the_same_new_dataset(tmp_path: Path) -> None:
    with staged_folder(tmp_path / "data") as staging:
        (staging / "mine").write_text("mine")
        with pytest.raises(UserError, match="written by another program"), staged_folder(tmp_path / "data"):
            pytest.fail("both are writing")
        assert (staging / "mine").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["data"]


def test_the_lock_of_a_killed_writer_holds_nobody_up(tmp_path: Path, demonstrations: Demonstrations) -> None:
    write_dataset(demonstrations, tmp_path / "data")
    (tmp_path / "data" / LOCK_FILE).touch()
    append_episode(tmp_path / "data", demonstrations.episodes[0])
    assert len(read_dataset(tmp_path / "data").episodes) == len(demonstrations.episodes) + 1


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"state": np.zeros((6, 2)), "action": np.zeros((6, 2))}, "2 joints where 3 are expected"),
        ({"action": None}, "has no action, though the first episode has it"),
        ({"extras": {"belief": np.zeros((6, 2))}}, "has no assist.alpha, though"),
        ({"extras": {"belief": np.zeros((6, 3)), "assist.alpha": np.zeros((6, 1))}}, "a belief of width 3"),
        ({"timestamp": np.array([0, 0.1, 0.2, 0.2, 0.3, 0.4])}, "sample 3: the timestamp 0.2 s repeats"),
        ({"task": "\ud800"}, "is not text that a file can hold"),
    ],
)
def test_an_unfit_episode_is_not_appended(
    tmp_path: Path,
    demonstrations: Demonstrations,
    episode_of: MakeEpisode,
    equal: Equal,
    change: dict[str, object],
    sentence: str,
) -> None:
    write_dataset(demonstrations, tmp_path / "data")
    with pytest.raises(UserError, match=sentence) as refusal:
        append_episode(tmp_path / "data", replace(episode_of(3), **change))
    assert "episode 3" in str(refusal.value)
    assert equal(read_dataset(tmp_path / "data"), demonstrations)


def test_times_that_single_precision_cannot_tell_apart_are_refused(tmp_path: Path) -> None:
    epoch = 1.7e9 + np.arange(3) / 10
    late = Demonstrations((Episode(np.zeros((3, 1)), epoch),), 10.0, ("elbow",))
    with pytest.raises(UserError, match="count times from the episode's start"):
        write_dataset(late, tmp_path / "data")
    assert not list(tmp_path.iterdir())
