"""Reading LeRobotDatasets by any writer.

From the v3.0 layout only the rows within its totals are read. The v2.0 and v2.1 layouts have a Parquet file
for each episode and a list of the episodes in JSON lines.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa

from latentarm.core.errors import UserError
from latentarm.core.types import Episode, FloatArray, Provenance
from latentarm.core.untrusted.documents import MOST_BYTES, parse_object
from latentarm.core.untrusted.memory import bounded_memory
from latentarm.core.untrusted.opening import read_bytes
from latentarm.demonstrations.info import ACTION, DATA_PATTERN, STATE, Info
from latentarm.demonstrations.tables import TASK_COLUMN, Table, float_column, integer_column, read_table


def read_tasks(root: Path) -> list[str]:
    """Task texts in the order of their indices."""
    path = root / "meta/tasks.parquet"
    table = read_table(path, ["task_index", TASK_COLUMN])
    texts = ["; ".join(text) for text in _texts(table.column(TASK_COLUMN), path)]
    if integer_column(table, "task_index", path).tolist() != list(range(len(texts))):
        raise UserError(f"{path} is damaged: its tasks are not numbered from zero.")
    return texts


def committed_episodes(root: Path, info: Info) -> Table:
    """The table of episodes without leftovers of a killed writer."""
    folder = root / "meta/episodes"
    paths = sorted(folder.glob("*/*.parquet"))
    if not paths:
        raise UserError(f"{folder} holds no table of episodes; the dataset is damaged.")
    tables = [read_table(path) for path in paths]
    required = {"episode_index", "tasks", "length", "data/chunk_index", "data/file_index"}
    for path, table in zip(paths, tables, strict=True):
        for name in sorted(required - set(table.column_names)):
            raise UserError(f"{path} has no column {name}; the dataset is damaged.")
    try:
        rows = pa.concat_tables(tables, promote_options="default").slice(0, info.episodes)
    except pa.ArrowException as error:
        raise UserError(f"{folder} is damaged: its tables do not fit each other.") from error
    index = integer_column(rows, "episode_index", folder)
    if not np.array_equal(index, np.arange(info.episodes)):
        raise UserError(f"{folder} is damaged: it does not list the {info.episodes} episodes in order.")
    return rows


def read_episodes(root: Path, info: Info) -> tuple[Episode, ...]:
    """Every committed episode with all its float features."""
    if info.episodes == 0:
        return ()
    size = sum(path.lstat().st_size for path in root.glob("*/**/*.parquet"))
    with bounded_memory(str(root), size):
        rows = committed_episodes(root, info)
        folder = root / "meta/episodes"
        names = ("length", "data/chunk_index", "data/file_index")
        length, chunk, file = (integer_column(rows, name, folder) for name in names)
        total = length.sum()
        if total != info.frames:
            raise UserError(f"{folder} is damaged: its episodes hold {total} samples and not {info.frames}.")
        tasks = ["; ".join(names) for names in _texts(rows.column("tasks"), folder)]
        episodes: list[Episode] = []
        while len(episodes) < info.episodes:
            first = len(episodes)
            same = (chunk[first:] == chunk[first]) & (file[first:] == file[first])
            stop = info.episodes if same.all() else first + int(np.argmin(same))
            path = root / DATA_PATTERN.format(chunk_index=int(chunk[first]), file_index=int(file[first]))
            episodes += read_file(path, info, first, length[first:stop].tolist(), tasks[first:stop])
        return tuple(episodes)


def _texts(column: Any, path: Path) -> list[list[str]]:
    """A column of texts, or of lists of them."""
    try:
        entries = column.to_pylist()
    except UnicodeDecodeError as error:
        raise UserError(f"{path} is damaged: its texts are not UTF-8.") from error
    return [list(map(str, entry)) if isinstance(entry, list) else [str(entry)] for entry in entries]


def read_file(
    path: Path, info: Info, first: int, lengths: Sequence[int], tasks: Sequence[str]
) -> list[Episode]:
    """The episodes in one data file, of which ``first`` is the first's number."""
    widths = {feature.name: feature.width for feature in info.features} | {"timestamp": 1}
    table = read_table(path, [*widths, "episode_index", "frame_index"])
    index, frame = (integer_column(table, name, path) for name in ("episode_index", "frame_index"))
    columns = {name: float_column(table, name, width, path) for name, width in widths.items()}
    episodes: list[Episode] = []
    for offset, (length, task) in enumerate(zip(lengths, tasks, strict=True)):
        rows = np.flatnonzero(index == first + offset)
        if not np.array_equal(frame[rows], np.arange(length)):
            raise UserError(
                f"{path}: episode {first + offset} should have {length} samples in order "
                f"and has {len(rows)}; the dataset is damaged."
            )
        recorded = {name: values[rows] for name, values in columns.items()}
        episodes.append(_episode(recorded, task, info.provenance_of(first + offset)))
    return episodes


def _episode(columns: dict[str, FloatArray], task: str, provenance: Provenance | None) -> Episode:
    state, timestamp = columns.pop(STATE), columns.pop("timestamp")[:, 0]
    return Episode(
        state=state,
        timestamp=timestamp,
        action=columns.pop(ACTION, None),
        task=task,
        extras=columns,
        provenance=provenance,
    )


V2_EPISODES_PATH: Final = Path("meta/episodes.jsonl")
V2_DATA_PATTERN: Final = "data/chunk-{chunk:03d}/episode_{episode:06d}.parquet"


def read_episodes_v2(root: Path, info: Info) -> tuple[Episode, ...]:
    """Every episode of a v2 layout with all its float features."""
    path = root / V2_EPISODES_PATH
    lines = read_bytes(path, MOST_BYTES).splitlines()
    if len(lines) != info.episodes:
        raise UserError(f"{path} is damaged: it lists {len(lines)} episodes and not {info.episodes}.")
    size = sum(file.lstat().st_size for file in root.glob("data/*/*.parquet"))
    with bounded_memory(str(root), size):
        episodes: list[Episode] = []
        for number, line in enumerate(lines):
            length, task = _v2_entry(parse_object(line, f"{path}, line {number + 1},"), number, path)
            if not 0 < length <= info.frames:
                raise UserError(f"{path} is damaged: episode {number} cannot have {length} samples.")
            name = V2_DATA_PATTERN.format(chunk=number // info.chunk_files, episode=number)
            episodes += read_file(root / name, info, number, [length], [task])
        if sum(len(episode.timestamp) for episode in episodes) != info.frames:
            raise UserError(f"{path} is damaged: its episodes do not hold {info.frames} samples.")
        return tuple(episodes)


def _v2_entry(entry: dict[str, Any], number: int, path: Path) -> tuple[int, str]:
    length, tasks = entry.get("length"), entry.get("tasks")
    if entry.get("episode_index") != number or not isinstance(length, int) or not isinstance(tasks, list):
        raise UserError(f"{path} is damaged: line {number + 1} does not describe episode {number}.")
    return length, "; ".join(str(task) for task in tasks)
