"""The native dataset: LeRobotDataset v3.0 on disk, whole episodes only.

``meta/info.json`` is the commit point. An append first puts the episode's samples, its row and its statistics
in place, each file whole, and replaces ``info.json`` last; every reader ignores rows beyond its totals. A
kill at any moment therefore loses at most the new episode, and the next append overwrites its remains.
"""

from dataclasses import replace
from pathlib import Path
from typing import Final, cast

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from latentarm.core.errors import UserError
from latentarm.core.files import write_text, written_whole
from latentarm.core.types import Demonstrations, Episode, StrPath
from latentarm.demonstrations.folders import locked, remove_files, staged_folder
from latentarm.demonstrations.info import (
    ACTION,
    CHUNK_FILES,
    DATA_FILE_MB,
    DATA_PATTERN,
    EPISODES_PATTERN,
    INFO_PATH,
    STATE,
    Info,
    features_of,
    info_json,
    read_info,
)
from latentarm.demonstrations.reader import committed_episodes, read_episodes, read_tasks
from latentarm.demonstrations.tables import (
    Table,
    episode_row,
    read_table,
    sample_columns,
    sample_table,
    statistics_json,
    task_table,
)
from latentarm.demonstrations.validation import check_same_features, validate, validate_episode

LOCK_FILE: Final = ".lock"  # exists during an append


def write_dataset(demonstrations: Demonstrations, path: StrPath) -> None:
    """Write demonstrations to a new folder, which appears whole or not at all.

    Values are stored in single precision, as the layout has them; goals exactly.

    Raises UserError where the demonstrations are invalid (see `validate`), or ``path`` is not empty
    or not writable.
    """
    path = Path(path)
    validate(demonstrations, str(path))
    features = features_of(demonstrations)
    tasks: list[str] = []
    samples: list[Table] = []
    rows: list[Table] = []
    places: list[tuple[int, int]] = []
    frames = written = 0
    for index, episode in enumerate(demonstrations.episodes):
        if episode.task not in tasks:
            tasks.append(episode.task)
        columns = sample_columns(
            episode, features, episode_index=index, first_index=frames, task_index=tasks.index(episode.task)
        )
        samples.append(sample_table(columns))
        written += samples[-1].nbytes
        places.append(divmod(written // (DATA_FILE_MB * 1024**2), CHUNK_FILES))
        rows.append(episode_row(columns, episode.task, data_place=places[-1], episodes_place=(0, 0)))
        frames += len(episode.timestamp)
    info = Info(
        episodes=len(samples),
        frames=frames,
        tasks=len(tasks),
        features=features,
        about=replace(demonstrations, episodes=()),
        provenance=tuple(episode.provenance for episode in demonstrations.episodes),
    )
    with staged_folder(path) as staging:
        for place in sorted(set(places)):
            held = [table for table, where in zip(samples, places, strict=True) if where == place]
            _write_tables(staging / _place(DATA_PATTERN, place), held)
        _write_state(staging, pa.concat_tables(rows), (0, 0), tasks, info)


def append_episode(path: StrPath, episode: Episode) -> None:
    """Append one episode to a dataset, atomically: it is absent if the process is killed first.

    The newest data file is copied with the episode added, up to the layout's size of a data file; then a new
    one begins. Raises UserError where the episode is invalid or of other joints or features, ``path`` is not
    a dataset of `write_dataset`, or another program is writing it.
    """
    path = Path(path)
    with locked(path, path / LOCK_FILE):
        info = _native_info(path)
        validate_episode(episode, info.episodes, info.about.joint_names, str(path))
        _check_features(path, info, episode)
        rows = committed_episodes(path, info)
        _remove_uncommitted(path, rows)
        tasks = read_tasks(path)[: info.tasks]
        if episode.task not in tasks:
            tasks.append(episode.task)
        columns = sample_columns(
            episode,
            info.features,
            episode_index=info.episodes,
            first_index=info.frames,
            task_index=tasks.index(episode.task),
        )
        added = sample_table(columns)
        data_place, kept = _data_to_extend(path, info, rows, added)
        last = rows.slice(len(rows) - 1).to_pylist()[0]
        episodes_place = (last["meta/episodes/chunk_index"], last["meta/episodes/file_index"])
        row = episode_row(columns, episode.task, data_place=data_place, episodes_place=episodes_place)
        _write_tables(path / _place(DATA_PATTERN, data_place), [*kept, added])
        grown = replace(
            info,
            episodes=info.episodes + 1,
            frames=info.frames + len(episode.timestamp),
            tasks=len(tasks),
            provenance=(*map(info.provenance_of, range(info.episodes)), episode.provenance),
        )
        _write_state(
            path, pa.concat_tables([rows, row], promote_options="default"), episodes_place, tasks, grown
        )


def read_dataset(path: StrPath) -> Demonstrations:
    """Read a dataset of `write_dataset`, with every complete episode.

    Values are in single precision. Raises UserError where ``path`` is not a dataset, was written by another
    program (import it first), or is damaged.
    """
    path = Path(path)
    info = _native_info(path)
    demonstrations = replace(info.about, episodes=read_episodes(path, info))
    validate(demonstrations, str(path))
    return demonstrations


def _native_info(path: Path) -> Info:
    info = read_info(path)
    if not info.native:
        raise UserError(f"{path} was written by another program; import it into a dataset of its own first.")
    return info


def _check_features(path: Path, info: Info, episode: Episode) -> None:
    empty = episode.state[:0]
    width = {feature.name: feature.width for feature in info.features}
    others = Episode(
        state=empty,
        timestamp=episode.timestamp[:0],
        action=empty if ACTION in width else None,
        extras={name: empty[:, :0].reshape(0, k) for name, k in width.items() if name not in {STATE, ACTION}},
    )
    check_same_features(others, episode, info.episodes, str(path))


def _place(pattern: str, place: tuple[int, int]) -> str:
    return pattern.format(chunk_index=place[0], file_index=place[1])


def _data_places(rows: Table) -> list[tuple[int, int]]:
    """Chunk and file of each episode's samples."""
    chunk, file = (cast(list[int], rows.column(f"data/{one}_index").to_pylist()) for one in ("chunk", "file"))
    return list(zip(chunk, file, strict=True))


def _remove_uncommitted(path: Path, rows: Table) -> None:
    """Delete leftovers of a killed writer: temporary files, and data files without episodes."""
    remove_files(path.rglob(".*.part"))
    committed = {path / _place(DATA_PATTERN, place) for place in _data_places(rows)}
    remove_files(set((path / "data").glob("*/*.parquet")) - committed)


def _data_to_extend(path: Path, info: Info, rows: Table, added: Table) -> tuple[tuple[int, int], list[Table]]:
    """The data file for the next episode, and the episodes that it already holds."""
    places = _data_places(rows)
    chunk, file = places[-1]
    last = path / _place(DATA_PATTERN, places[-1])
    table = read_table(last)
    if last.stat().st_size + added.nbytes < info.data_file_mb * 1024**2 and table.schema.equals(added.schema):
        held = np.array([place == places[-1] for place in places])
        lengths = rows.column("length").to_numpy()[held]
        starts = np.cumsum(lengths) - lengths
        return places[-1], [table.slice(start, size) for start, size in zip(starts, lengths, strict=True)]
    return divmod(chunk * info.chunk_files + file + 1, info.chunk_files), []


def _write_tables(path: Path, tables: list[Table]) -> None:
    """Write tables of one schema to one Parquet file, each as its own row group."""
    schema = tables[0].schema
    with written_whole(path) as part, pq.ParquetWriter(part, schema, write_page_checksum=True) as writer:
        for table in tables:
            writer.write_table(table)


def _write_state(root: Path, rows: Table, place: tuple[int, int], tasks: list[str], info: Info) -> None:
    """Write everything about the episodes except their samples; the commit point comes last."""
    chunk, file = (rows.column(f"meta/episodes/{name}_index").to_numpy() for name in ("chunk", "file"))
    newest = rows.filter(pa.array((chunk == place[0]) & (file == place[1])))
    _write_tables(root / "meta/tasks.parquet", [task_table(tasks)])
    _write_tables(root / _place(EPISODES_PATTERN, place), [newest])
    write_text(root / "meta/stats.json", statistics_json(rows))
    write_text(root / INFO_PATH, info_json(info))
