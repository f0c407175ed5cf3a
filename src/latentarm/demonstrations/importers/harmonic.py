"""Importing runs of the HARMONIC dataset: people who bring a fork over marshmallows with a Kinova Mico.

Newman, Aronson, Srinivasa, Kitani and Admoni, "HARMONIC: A multimodal dataset of assistive human-robot
collaboration", 2022. Each run is a folder. ``text_data/joint_positions.csv`` has ``timestamp``, s, and
``mico_joint_1_pos`` to ``mico_joint_6_pos``, rad, optionally with ``_vel``, rad/s, and ``_eff``, N m.
``text_data/assistance_info.csv`` has ``timestamp`` and the robot's belief ``p_goal_0`` to ``p_goal_2``.
``text_data/ada_joy.csv`` has ``timestamp`` and the stick, ``axes_x`` and ``axes_y``.
``text_data/morsel.yaml`` has ``morsel0`` to ``morsel2``, each a matrix (4, 4) in the base frame, m, or null
where unseen; the number ``stated_goal``; ``goal_success`` and ``any_success``. ``stats/run_info.yaml`` has
pairs of a name and a value, including ``start_time`` and ``end_time``.

The layout follows the dataset's published readers; it has been tested on files made in this layout only.
"""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, cast

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray, Pose
from latentarm.core.untrusted.opening import is_missing, read_bytes
from latentarm.core.untrusted.yaml_file import parse_yaml
from latentarm.demonstrations.bounds import MAX_EPISODES, check_values
from latentarm.demonstrations.importers.csv_lines import CsvTable
from latentarm.demonstrations.importers.options import ImportOptions
from latentarm.demonstrations.importers.source import SourceData
from latentarm.demonstrations.things import ENVIRONMENT
from latentarm.demonstrations.timing import typical_rate_hz
from latentarm.robots.kinematics.pose_rows import stored_rows

JOINTS: Final = tuple(f"mico_joint_{number}" for number in range(1, 7))
MORSELS: Final = ("morsel0", "morsel1", "morsel2")
BELIEFS: Final = tuple(f"p_goal_{number}" for number in range(len(MORSELS)))
STICK: Final = ("axes_x", "axes_y")
MEASURED: Final = {"observation.velocity": "_vel", "observation.effort": "_eff"}
SUCCESS: Final = {"next.success": "goal_success", "next.any_success": "any_success"}
_POSITIONS: Final = Path("text_data/joint_positions.csv")
_DEEPEST: Final = 4  # levels of folders above a run
_MOST_YAML_BYTES: Final = 1 << 16
_RIGID: Final = 1e-3  # tolerance of a pose's rotation


def harmonic_runs(source: Path) -> tuple[Path, ...]:
    """The runs in a folder, or the folder itself if it is one, by name."""
    runs: list[Path] = []
    for folder, inner, _ in os.walk(source):
        here = Path(folder)
        if not is_missing(here / _POSITIONS):
            runs.append(here)
            inner.clear()
        elif len(here.relative_to(source).parts) >= _DEEPEST:
            inner.clear()
        inner.sort()
        if len(runs) > MAX_EPISODES:
            raise UserError(f"{source} holds more than {MAX_EPISODES:,} runs; import them in parts.")
    return tuple(runs)


def read_harmonic(runs: Sequence[Path], options: ImportOptions) -> SourceData:
    """Read runs of HARMONIC, each as an episode of six joints; the task is the stated goal by default.

    Further features are the belief, the stick as ``input.u``, the poses of the morsels, which are the goals,
    and success at an episode's last sample: ``next.success`` at the stated goal, ``next.any_success`` at any.
    Each sample takes the latest values before it. Fingers, gaze, muscles and positions of links are omitted,
    and so are runs with an unseen morsel.
    """
    episodes: list[Episode] = []
    unseen = count = 0
    for run in runs:
        morsels = _mapping(run / "text_data/morsel.yaml")
        if any(morsels.get(name) is None for name in MORSELS):
            unseen += 1
            continue
        episodes.append(_episode(run, morsels, options.instruction))
        count += sum(values.size for values in (episodes[-1].state, *episodes[-1].extras.values()))
        check_values(run, "with the runs before it", count)
    if not episodes:
        raise UserError(f"{runs[0]}: no run has the poses of all three morsels.")
    rate_hz = options.rate_hz or typical_rate_hz(episodes)
    if not rate_hz:
        raise UserError(f"{runs[0]}: its timestamps do not grow; say the sampling rate.")
    return SourceData(
        Demonstrations(
            episodes=tuple(episodes),
            rate_hz=rate_hz,
            joint_names=JOINTS,
            robot="mico",
            objects=MORSELS,
            import_record={"runs": f"{len(episodes)}; {unseen} without the pose of a morsel left out"},
        ),
        layout="HARMONIC",
        in_rad=True,
    )


def _episode(run: Path, morsels: Mapping[str, object], task: str | None) -> Episode:
    positions = _Table(run / _POSITIONS)
    time_s = positions.columns(("timestamp",))[:, 0]
    kept = _within(run / "stats/run_info.yaml", time_s)
    if kept.sum() < 2:
        raise UserError(f"{positions.path} has no two samples between the start and the end of its run.")
    time_s = time_s[kept]
    state = positions.columns([f"{joint}_pos" for joint in JOINTS])[kept]
    extras = {
        feature: positions.columns([f"{joint}{suffix}" for joint in JOINTS])[kept]
        for feature, suffix in MEASURED.items()
        if positions.has(f"{JOINTS[0]}{suffix}")
    }
    extras["belief"] = _held(run / "text_data/assistance_info.csv", BELIEFS, time_s)
    extras["input.u"] = _held(run / "text_data/ada_joy.csv", STICK, time_s)
    path = run / "text_data/morsel.yaml"
    poses = np.concatenate([_pose(morsels[name], name, path) for name in MORSELS])
    extras[ENVIRONMENT] = np.tile(poses, (len(time_s), 1))
    for feature, name in SUCCESS.items():
        succeeded = np.zeros((len(time_s), 1))
        succeeded[-1] = _told(morsels, name, path)
        extras[feature] = succeeded
    return Episode(
        state=state,
        timestamp=time_s - time_s[0],
        task=task or f"the fork over morsel {_goal(morsels, path)}",
        extras=extras,
    )


class _Table:
    def __init__(self, path: Path) -> None:
        self.path = path
        self._csv = CsvTable(path)
        self._rows = list(self._csv.rows())

    def has(self, name: str) -> bool:
        """Whether there is a column of that name."""
        return name in self._csv.header

    def columns(self, names: Sequence[str]) -> FloatArray:
        """Columns by name, (T, k)."""
        for name in names:
            if self._csv.header.count(name) != 1:
                raise UserError(f"{self.path} must have one column {name!r}, as runs of HARMONIC have.")
        places = [(name, self._csv.header.index(name)) for name in names]
        rows = ([self._csv.number(one[at], line, name) for name, at in places] for line, one in self._rows)
        return np.array(list(rows))


def _held(path: Path, names: Sequence[str], time_s: FloatArray) -> FloatArray:
    """Columns (T, k) with the latest values before each time; before the first, the first values."""
    table = _Table(path)
    said_s = table.columns(("timestamp",))[:, 0]
    if not (np.diff(said_s) >= 0).all():
        raise UserError(f"{path}: the timestamps fall; times must grow.")
    last = np.searchsorted(said_s, time_s, side="right") - 1
    return table.columns(names)[np.maximum(last, 0)]


def _within(path: Path, time_s: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Whether each time lies within the run, by its file."""
    listed = parse_yaml(read_bytes(path, _MOST_YAML_BYTES), path, "the YAML file of a run")
    pairs = cast(list[object], listed) if isinstance(listed, list) else None
    if pairs is None or not all(isinstance(one, list) and len(cast(list[object], one)) == 2 for one in pairs):
        raise UserError(f"{path} must be a list of pairs of a name and a value.")
    told = {str(name): value for name, value in cast(list[list[object]], pairs)}
    limits: list[float] = []
    for name, default in (("start_time", -np.inf), ("end_time", np.inf)):
        value = told.get(name, default)
        try:
            limits.append(float(cast(str, value)))
        except (TypeError, ValueError) as error:
            raise UserError(f"{path}: {name} is {str(value)[:40]!r}, not a time in s.") from error
    return (time_s >= limits[0]) & (time_s <= limits[1])


def _mapping(path: Path) -> Mapping[str, object]:
    value = parse_yaml(read_bytes(path, _MOST_YAML_BYTES), path, "the YAML file of morsels")
    if not isinstance(value, dict):
        raise UserError(f"{path} must name morsels, the stated goal and the success.")
    return {str(key): entry for key, entry in cast(dict[object, object], value).items()}


def _pose(matrix: object, name: str, path: Path) -> FloatArray:
    try:
        rigid = np.asarray(matrix, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        rigid = np.zeros(0)
    good = rigid.shape == (4, 4) and np.isfinite(rigid).all()
    rotation = rigid[:3, :3] if good else np.zeros((3, 3))
    proper = np.abs(rotation @ rotation.T - np.eye(3)).max() <= _RIGID and np.linalg.det(rotation) > 0
    if not good or not proper or np.abs(rigid[3] - [0, 0, 0, 1]).max() > _RIGID:
        raise UserError(f"{path}: {name} must be a matrix of 4 rows and 4 columns that stands for a pose.")
    return stored_rows(Pose(rigid[:3, 3], rotation))


def _told(morsels: Mapping[str, object], name: str, path: Path) -> bool:
    value = morsels.get(name)
    if not isinstance(value, bool):
        raise UserError(f"{path}: {name} must be true or false.")
    return value


def _goal(morsels: Mapping[str, object], path: Path) -> int:
    value = morsels.get("stated_goal")
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < len(MORSELS):
        raise UserError(f"{path}: stated_goal must be the number of a morsel, 0 to {len(MORSELS) - 1}.")
    return value
