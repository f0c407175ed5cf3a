"""``meta/info.json`` of the LeRobotDataset v3.0 layout, typed.

The ``latentarm`` key holds data that the layout has no place for, such as goals; other readers ignore it.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeVar, cast, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Goal, Pose, Provenance
from latentarm.core.untrusted.documents import read_object
from latentarm.core.untrusted.opening import is_missing
from latentarm.demonstrations.bounds import check_values
from latentarm.demonstrations.provenance import parse_provenance, provenance_json
from latentarm.demonstrations.things import AGE, ENVIRONMENT, entry_names, object_names
from latentarm.robots.limits_file import limits_document, parse_limits

CODEBASE_VERSION: Final = "v3.0"
OLDER_VERSIONS: Final = ("v2.0", "v2.1")  # importable layouts, see `read_episodes_v2`
STATE: Final = "observation.state"
ACTION: Final = "action"
MAX_RATE_HZ: Final = 1e9
INFO_PATH: Final = Path("meta/info.json")
CHUNK_FILES: Final = 1000
DATA_FILE_MB: Final = 100
VIDEO_FILE_MB: Final = 200
DATA_PATTERN: Final = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
EPISODES_PATTERN: Final = "meta/episodes/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_INDICES: Final = ("frame_index", "episode_index", "index", "task_index")
INDEX_DTYPES: Final = {"timestamp": "float32"} | dict.fromkeys(_INDICES, "int64")

T = TypeVar("T")


@final
@dataclass(frozen=True)
class Feature:
    """One float32 vector in every sample."""

    name: str  # of the layout, such as ``observation.state``
    width: int
    names: tuple[str, ...] | None = None  # for each entry


@final
@dataclass(frozen=True)
class Info:
    """The contents of ``meta/info.json``. Its totals are authoritative: rows beyond them do not exist."""

    episodes: int  # number of whole episodes
    frames: int  # samples in them
    tasks: int  # number of distinct task texts
    features: tuple[Feature, ...]  # float vectors; pictures, text and integers of other writers are omitted
    about: Demonstrations  # all that is the same for every episode; it has none itself
    version: str = CODEBASE_VERSION  # of the layout, such as ``v3.0``
    native: bool = True  # whether this package wrote the dataset (its actions are joint velocities then)
    chunk_files: int = CHUNK_FILES  # files in one chunk folder
    data_file_mb: int = DATA_FILE_MB  # size at which the next data file begins
    # of each episode, as far as known: one entry each, or fewer
    provenance: tuple[Provenance | None, ...] = ()

    def provenance_of(self, episode: int) -> Provenance | None:
        """Provenance of an episode; None where unknown, as after another program's append."""
        return self.provenance[episode] if episode < len(self.provenance) else None


def default_joint_names(dof: int) -> tuple[str, ...]:
    """Names for unnamed joints."""
    return tuple(f"joint_{joint + 1}" for joint in range(dof))


def features_of(demonstrations: Demonstrations) -> tuple[Feature, ...]:
    """The features of a dataset of these demonstrations, in the order of its columns."""
    names = demonstrations.joint_names
    first = demonstrations.episodes[0]
    action = () if first.action is None else (Feature(ACTION, len(names), names),)
    objects = demonstrations.objects
    named = {ENVIRONMENT: entry_names(objects) or None}
    named |= {one: objects for one in first.extras if one.startswith(AGE)}
    extras = tuple(Feature(one, first.extras[one].shape[1], named.get(one)) for one in sorted(first.extras))
    return (Feature(STATE, len(names), names), *action, *extras)


def info_json(info: Info) -> str:
    """The document in the form of other writers of the layout, with the ``latentarm`` key added."""
    features: dict[str, object] = {
        feature.name: {
            "dtype": "float32",
            "shape": [feature.width],
            "names": None if feature.names is None else list(feature.names),
        }
        for feature in info.features
    }
    features |= {name: {"dtype": dtype, "shape": [1], "names": None} for name, dtype in INDEX_DTYPES.items()}
    about = info.about
    rate_hz = float(about.rate_hz)
    document = {
        "codebase_version": CODEBASE_VERSION,
        "robot_type": about.robot or None,
        "total_episodes": info.episodes,
        "total_frames": info.frames,
        "total_tasks": info.tasks,
        "chunks_size": info.chunk_files,
        "data_files_size_in_mb": info.data_file_mb,
        "video_files_size_in_mb": VIDEO_FILE_MB,
        "fps": int(rate_hz) if rate_hz.is_integer() else rate_hz,
        "splits": {"train": f"0:{info.episodes}"},
        "data_path": DATA_PATTERN,
        "video_path": None,
        "features": features,
        "latentarm": {
            "format": 1,
            "action": "joint velocity, rad/s",
            "end_effector": about.end_effector,
            "limits": None if about.limits is None else limits_document(about.limits),
            "goals": goals_document(about.goals),
            "import": dict(about.import_record),
            "provenance": [None if one is None else provenance_json(one) for one in info.provenance],
        },
    }
    return json.dumps(document, indent=4, ensure_ascii=False, allow_nan=False)


def read_info(root: Path) -> Info:
    """Read and check ``meta/info.json`` in a dataset's folder."""
    path = root / INFO_PATH
    if is_missing(path):
        raise UserError(f"{root} is not a dataset: it has no {INFO_PATH}.")
    mapping = read_object(path)
    version = _field(mapping, "codebase_version", str, path)
    version = f"v{version.removeprefix('v')}"
    if not version.startswith(("v3.", *OLDER_VERSIONS)):
        raise UserError(
            f"{path}: the dataset is of LeRobot layout {version}; {CODEBASE_VERSION} and"
            f" {' and '.join(OLDER_VERSIONS)} can be read: convert it with LeRobot first."
        )
    entry = mapping.get("latentarm")
    ours = cast(Mapping[str, Any], entry) if isinstance(entry, dict) else {}
    stated, end_effector = ours.get("limits"), ours.get("end_effector")
    robot = mapping.get("robot_type")
    features = _read_features(_field(mapping, "features", dict, path), path)
    state = next((feature for feature in features if feature.name == STATE), None)
    if state is None:
        raise UserError(f"{path}: the dataset has no {STATE} of floats, so it holds no joint positions.")
    rate = mapping.get("fps")
    if isinstance(rate, bool) or not isinstance(rate, int | float) or not abs(rate) < MAX_RATE_HZ:
        raise UserError(f"{path}: the rate 'fps' is missing or not a sensible number.")
    episodes, frames = _count(mapping, "total_episodes", path), _count(mapping, "total_frames", path)
    check_values(path, "it", max(episodes, frames) * (len(INDEX_DTYPES) + sum(one.width for one in features)))
    return Info(
        episodes=episodes,
        frames=frames,
        tasks=_count(mapping, "total_tasks", path),
        features=features,
        about=Demonstrations(
            episodes=(),
            rate_hz=float(rate),
            joint_names=state.names or default_joint_names(state.width),
            robot=robot if isinstance(robot, str) else "",
            goals=parse_goals(ours.get("goals", []), str(path)),
            import_record=_read_import_record(ours, path),
            end_effector=None if end_effector is None else _field(ours, "end_effector", str, path),
            limits=None if stated is None else parse_limits(stated, f"{path}, limits"),
            objects=next((object_names(one.names or ()) for one in features if one.name == ENVIRONMENT), ()),
        ),
        version=version,
        native=isinstance(entry, dict) and version not in OLDER_VERSIONS,
        chunk_files=max(_count(mapping, "chunks_size", path), 1),
        data_file_mb=0 if version in OLDER_VERSIONS else _count(mapping, "data_files_size_in_mb", path),
        provenance=_read_provenance(ours, path),
    )


def goals_document(goals: Sequence[Goal]) -> list[dict[str, object]]:
    """The document that `parse_goals` reads."""
    return [
        {
            "name": goal.name,
            "configuration": goal.configuration.tolist(),
            "position": goal.pose.position.tolist(),
            "rotation": goal.pose.rotation.tolist(),
        }
        for goal in goals
    ]


def parse_goals(entries: object, where: str) -> tuple[Goal, ...]:
    """The goals in a dataset or a run."""
    try:
        return tuple(
            Goal(
                name=str(entry["name"]),
                configuration=np.asarray(entry["configuration"], dtype=np.float64),
                pose=Pose(
                    position=np.asarray(entry["position"], dtype=np.float64),
                    rotation=np.asarray(entry["rotation"], dtype=np.float64),
                ),
            )
            for entry in cast(Sequence[Mapping[str, Any]], entries)
        )
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise UserError(f"{where}: its goals are damaged.") from error


def _field(mapping: Mapping[str, Any], key: str, kind: type[T], path: Path) -> T:
    value = mapping.get(key)
    if not isinstance(value, kind):
        raise UserError(f"{path}: the entry '{key}' is missing or not what it should be.")
    return value


def _count(mapping: Mapping[str, Any], key: str, path: Path) -> int:
    value = _field(mapping, key, int, path)
    if value < 0:
        raise UserError(f"{path}: the entry '{key}' is {value}; it cannot be below zero.")
    return value


def _read_features(mapping: Mapping[str, Any], path: Path) -> tuple[Feature, ...]:
    """The one-dimensional float features, in the order of the document."""
    features: list[Feature] = []
    for name, spec in mapping.items():
        if not isinstance(spec, dict):
            raise UserError(f"{path}: the feature {name!r} is not described.")
        shape = cast(Mapping[str, Any], spec).get("shape")
        if name in INDEX_DTYPES or spec.get("dtype") not in {"float32", "float64"}:
            continue
        if isinstance(shape, list) and len(shape) == 1 and isinstance(shape[0], int) and shape[0] > 0:
            features.append(Feature(name, shape[0], _entry_names(spec.get("names"), shape[0])))
    return tuple(features)


def _entry_names(names: object, width: int) -> tuple[str, ...] | None:
    """Names of a feature's entries; some writers put the list into a mapping of one group."""
    if isinstance(names, dict) and len(names) == 1:
        names = next(iter(cast(dict[str, object], names).values()))
    if isinstance(names, list) and len(names) == width and all(isinstance(name, str) for name in names):
        return tuple(cast(Sequence[str], names))
    return None


def _read_import_record(ours: Mapping[str, Any], path: Path) -> Mapping[str, str]:
    record: object = ours.get("import", {})
    texts = cast(Mapping[str, object], record).values() if isinstance(record, dict) else [None]
    if not all(isinstance(text, str) for text in texts):
        raise UserError(f"{path}: its record of the import is damaged.")
    return cast(Mapping[str, str], record)


def _read_provenance(ours: Mapping[str, Any], path: Path) -> tuple[Provenance | None, ...]:
    listed: object = ours.get("provenance", [])
    try:
        if not isinstance(listed, list):
            raise ValueError
        entries = cast(Sequence[object], listed)
        return tuple(None if entry is None else parse_provenance(entry) for entry in entries)
    except ValueError as error:
        raise UserError(f"{path}: what it says of who recorded its episodes is damaged.") from error
