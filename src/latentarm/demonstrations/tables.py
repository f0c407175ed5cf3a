"""The dataset's Parquet tables, in the columns of LeRobot v3.0: samples, episodes, tasks, statistics."""

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO, Final, TypeAlias, cast

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from latentarm.core.errors import UserError
from latentarm.core.types import Episode, FloatArray, IntArray
from latentarm.core.untrusted.memory import bounded_memory
from latentarm.core.untrusted.opening import is_missing, opened
from latentarm.demonstrations.bounds import MAX_FILE_BYTES, check_values
from latentarm.demonstrations.info import ACTION, INDEX_DTYPES, STATE, Feature

Table: TypeAlias = Any  # a `pyarrow.Table`: the library ships no types
TASK_COLUMN: Final = "__index_level_0__"  # pandas' name for an unnamed index, in which readers look tasks up
MAX_TABLE_COLUMNS: Final = 10_000  # the table of episodes has some ten for each feature
INTEGER_COLUMNS: Final = tuple(name for name, dtype in INDEX_DTYPES.items() if dtype == "int64")


def sample_columns(
    episode: Episode, features: Sequence[Feature], *, episode_index: int, first_index: int, task_index: int
) -> dict[str, FloatArray]:
    """One episode's columns, (T, k), by name in the layout's order and precision."""
    samples = len(episode.timestamp)
    recorded = {STATE: episode.state, ACTION: episode.action, **episode.extras}
    columns = {feature.name: cast(FloatArray, recorded[feature.name]) for feature in features}
    columns["timestamp"] = episode.timestamp[:, None]
    columns = {name: values.astype(np.float32).astype(np.float64) for name, values in columns.items()}
    counted = {
        "frame_index": np.arange(samples),
        "episode_index": np.full(samples, episode_index),
        "index": first_index + np.arange(samples),
        "task_index": np.full(samples, task_index),
    }
    return columns | {name: values[:, None].astype(np.float64) for name, values in counted.items()}


def sample_table(columns: dict[str, FloatArray]) -> Table:
    """Columns as one Arrow table: vectors are fixed-size lists of float32, scalars plain columns."""
    arrays: dict[str, pa.Array] = {}
    described: dict[str, object] = {}
    for name, values in columns.items():
        width = values.shape[1]
        dtype = "int64" if name in INTEGER_COLUMNS else "float32"
        flat = pa.array(np.ascontiguousarray(values, dtype=dtype).ravel())
        arrays[name] = flat if width == 1 else pa.FixedSizeListArray.from_arrays(flat, width)
        value = {"dtype": dtype, "_type": "Value"}
        described[name] = value if width == 1 else {"feature": value, "length": width, "_type": "List"}
    metadata = {"huggingface": json.dumps({"info": {"features": described}})}
    return pa.table(arrays).replace_schema_metadata(metadata)


def episode_row(
    columns: dict[str, FloatArray], task: str, *, data_place: tuple[int, int], episodes_place: tuple[int, int]
) -> Table:
    """One episode's row in the table of episodes; places are chunk and file."""
    index = columns["index"]
    plain = {
        "episode_index": int(columns["episode_index"][0, 0]),
        "tasks": [task],
        "length": len(index),
        "data/chunk_index": data_place[0],
        "data/file_index": data_place[1],
        "dataset_from_index": int(index[0, 0]),
        "dataset_to_index": int(index[-1, 0]) + 1,
    }
    arrays: dict[str, pa.Array] = {
        name: pa.array([value], type=pa.list_(pa.string()) if name == "tasks" else pa.int64())
        for name, value in plain.items()
    }
    for name, measures in episode_statistics(columns).items():
        for measure, values in measures.items():
            integral = measure == "count" or (measure in {"min", "max"} and name in INTEGER_COLUMNS)
            kind = np.int64 if integral else np.float64
            arrays[f"stats/{name}/{measure}"] = pa.array([values.astype(kind)])
    arrays["meta/episodes/chunk_index"] = pa.array([episodes_place[0]], type=pa.int64())
    arrays["meta/episodes/file_index"] = pa.array([episodes_place[1]], type=pa.int64())
    return pa.table(arrays)


def statistics_json(episodes: Table) -> str:
    """``meta/stats.json`` from the rows of the table of episodes."""
    names = [column.split("/")[1] for column in episodes.column_names if column.endswith("/mean")]
    document: dict[str, dict[str, list[Any]]] = {}
    for name in names:
        measures: dict[str, FloatArray] = {}
        for measure in MEASURES:
            column = episodes.column(f"stats/{name}/{measure}").combine_chunks()
            try:
                measures[measure] = column.flatten().to_numpy(zero_copy_only=False).reshape(len(column), -1)
            except ValueError as error:
                raise UserError(f"The dataset's statistics of {name} are damaged; import it anew.") from error
        values = pooled(measures)
        integral = {"count", "min", "max"} if name in INTEGER_COLUMNS else {"count"}
        document[name] = {
            measure: values[measure].astype(np.int64 if measure in integral else np.float64).tolist()
            for measure in MEASURES
        }
    return json.dumps(document, indent=4, allow_nan=False)


def task_table(tasks: Sequence[str]) -> Table:
    """The table of tasks, with the note that tells pandas its index."""
    keys = ("name", "field_name", "pandas_type", "numpy_type", "metadata")
    values = (
        (None, None, "unicode", "object", {"encoding": "UTF-8"}),
        ("task_index", "task_index", "int64", "int64", None),
        (None, TASK_COLUMN, "unicode", "object", None),
    )
    index, *columns = (dict(zip(keys, one, strict=True)) for one in values)
    note = {
        "index_columns": [TASK_COLUMN],
        "column_indexes": [index],
        "columns": columns,
        "attributes": {},
        "creator": {"library": "pyarrow", "version": pa.__version__},
        "pandas_version": "2.2.0",
    }
    numbers, texts = pa.array(range(len(tasks)), type=pa.int64()), pa.array(list(tasks), type=pa.string())
    table = pa.table({"task_index": numbers, TASK_COLUMN: texts})
    return table.replace_schema_metadata({"pandas": json.dumps(note)})


def read_table(path: Path, columns: Sequence[str] | None = None) -> Table:
    """Read a Parquet file, or named columns of it, if its size is bearable."""
    if is_missing(path):
        raise UserError(f"{path} is missing; the dataset is damaged.")
    with opened(path, MAX_FILE_BYTES) as stream, bounded_memory(str(path), os.fstat(stream.fileno()).st_size):
        return _read_stored(path, stream, columns)


def _read_stored(path: Path, stream: BinaryIO, columns: Sequence[str] | None) -> Table:
    try:
        with pq.ParquetFile(stream, page_checksum_verification=True) as stored:
            if stored.metadata.num_columns > MAX_TABLE_COLUMNS:
                raise UserError(f"{path} has more than {MAX_TABLE_COLUMNS:,} columns.")
            present = set(stored.schema_arrow.names)
            for name in columns or ():
                if name not in present:
                    raise UserError(f"{path} has no column {name}; the dataset is damaged.")
            check_values(path, "it", _stored_values(stored.metadata, columns))
            return stored.read(columns=None if columns is None else list(columns), use_threads=False)
    except MemoryError:
        raise  # Arrow's own is an `ArrowException` too
    except (pa.ArrowException, OSError, ValueError) as error:
        raise UserError(f"{path} is not a whole Parquet file; it is truncated or damaged.") from error


def _stored_values(metadata: Any, columns: Sequence[str] | None) -> int:
    """Numbers that reading the columns would hold, from the file's footer alone."""
    total = 0
    for group in range(metadata.num_row_groups):
        row_group = metadata.row_group(group)
        for index in range(row_group.num_columns):
            column = row_group.column(index)
            # A nested column's path goes on with ".list.element"; names themselves hold dots too.
            if columns is None or any(
                column.path_in_schema == name or column.path_in_schema.startswith(f"{name}.list")
                for name in columns
            ):
                total += column.num_values
    return total


def float_column(table: Table, name: str, width: int, path: Path) -> FloatArray:
    """A column of vectors (or of scalars, where the width is 1) as an array (N, width)."""
    column = table.column(name).combine_chunks()
    kind = column.type
    if pa.types.is_fixed_size_list(kind):
        ragged, values = kind.list_size != width, column.flatten()
    elif pa.types.is_list(kind):
        ragged, values = bool(np.any(np.diff(column.offsets.to_numpy()) != width)), column.flatten()
    else:
        ragged, values = width != 1, column
    ragged |= bool(column.null_count) or len(values) != len(column) * width
    if ragged or not pa.types.is_floating(values.type):
        raise UserError(f"{path}: the column {name} is ragged: every entry must hold {width} numbers.")
    return values.to_numpy(zero_copy_only=False).astype(np.float64).reshape(-1, width)


def integer_column(table: Table, name: str, path: Path) -> IntArray:
    """A column of whole numbers as an array (N,)."""
    column = table.column(name)
    if column.null_count or not pa.types.is_integer(column.type):
        raise UserError(f"{path}: the column {name} must hold whole numbers.")
    return column.to_numpy().astype(np.int64)


# Statistics of a feature, in the form of `meta/stats.json`.
QUANTILES: Final = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}
MEASURES: Final = ("min", "max", "mean", "std", "count", *QUANTILES)


def episode_statistics(columns: Mapping[str, FloatArray]) -> dict[str, dict[str, FloatArray]]:
    """For each feature, (T, k), and each of `MEASURES` an array (k,); ``count`` is (1,)."""
    return {
        name: {
            "min": values.min(axis=0),
            "max": values.max(axis=0),
            "mean": values.mean(axis=0),
            "std": values.std(axis=0),
            "count": np.array([float(len(values))]),
            **dict(zip(QUANTILES, np.quantile(values, list(QUANTILES.values()), axis=0), strict=True)),
        }
        for name, values in columns.items()
    }


def pooled(measures: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Pool the episodes' measures (E, k) of one feature into (k,), without their samples.

    Minimum, maximum, mean and deviation are exact; quantiles are means of the episodes' quantiles weighted by
    samples, as by other writers of the layout.
    """
    count = measures["count"]
    weight = count / count.sum()
    mean = (weight * measures["mean"]).sum(axis=0)
    variance = (weight * (measures["std"] ** 2 + (measures["mean"] - mean) ** 2)).sum(axis=0)
    return {
        "min": measures["min"].min(axis=0),
        "max": measures["max"].max(axis=0),
        "mean": mean,
        "std": np.sqrt(variance),
        "count": count.sum(axis=0),
        **{name: (weight * measures[name]).sum(axis=0) for name in QUANTILES},
    }
