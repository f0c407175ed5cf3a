"""Importing demonstrations of any known format into a native dataset."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, StrPath
from latentarm.core.untrusted.memory import bounded_memory
from latentarm.core.untrusted.opening import is_missing, opened
from latentarm.demonstrations.bounds import MAX_FILE_BYTES
from latentarm.demonstrations.dataset import write_dataset
from latentarm.demonstrations.folders import check_vacant
from latentarm.demonstrations.importers.bag_file import MCAP, ROS1, read_bag
from latentarm.demonstrations.importers.csv_file import read_csv
from latentarm.demonstrations.importers.harmonic import harmonic_runs, read_harmonic
from latentarm.demonstrations.importers.lerobot import read_lerobot
from latentarm.demonstrations.importers.npz_file import read_npz
from latentarm.demonstrations.importers.options import ActionChoice, ImportOptions
from latentarm.demonstrations.importers.robot_names import is_so_arm
from latentarm.demonstrations.importers.source import SourceData, join_files
from latentarm.demonstrations.importers.translation import translate
from latentarm.demonstrations.info import INFO_PATH
from latentarm.demonstrations.plausibility import check_rate, speed_warning
from latentarm.demonstrations.timing import check_one_rate, resampled, split_at_gaps
from latentarm.demonstrations.validation import validate
from latentarm.robots.robot import Robot

FOREIGN: Final = {
    b"\x80": "a pickle, which is never opened",
    b"\x93NUMPY": "a single array; an .npz with the arrays q, episode_ends and rate_hz is needed",
    b"PAR1": "a single Parquet file; give the dataset's folder",
    b"SQLite format 3": "a SQLite database; export it to a dataset first",
}


FILES: Final = (".csv", ".csv.gz", ".npz", ".hdf5", ".h5", ".bag", ".mcap", ".db3")
"""Ends of the names of the files that are read in a folder."""

BAG_INFO: Final = "metadata.yaml"  # in the folder of a bag of ROS 2


def import_demonstrations(
    source: StrPath, robot: Robot | None = None, options: ImportOptions | None = None
) -> Demonstrations:
    """Read demonstrations from a file or folder of any known kind, and check them.

    The format is recognised by content: a folder with a LeRobot layout (v2.0, v2.1, v3.0) or with runs of
    HARMONIC, a NumPy archive, an HDF5 file in robomimic's or ALOHA's layout, a bag of ROS 1 or ROS 2, an MCAP
    or a CSV file, or a folder of such files. The result's ``import_record`` lists all decisions.

    Args:
        source: the file or folder.
        robot: the recorded arm: its joints are found among the columns, and its limits are checked. Without
            one, every column counts as a joint in rad.
        options: see `ImportOptions`.

    Raises UserError with one sentence naming the file and, where it applies, the episode and the sample.
    """
    options = options or ImportOptions()
    source = Path(source)
    where = str(source)
    data = _read(source, robot, options)
    if options.leave_out:
        data = data.without(options.leave_out, where)
    data = split_at_gaps(data, options.gaps, where)
    actions = options.actions
    if actions != "known" and any(one.action is None for one in data.demonstrations.episodes):
        raise UserError(f"{source} has no 'action' for the columns of its states.")
    if robot is None:
        demonstrations = _without_robot(data, actions, source)
    else:
        demonstrations = translate(data, robot, options, where)
    names = data.episode_names
    validate(demonstrations, where, None if robot is None else robot.limits, names)
    record = dict(demonstrations.import_record)
    rate_hz = options.resample_hz
    if rate_hz is None:
        check_one_rate(demonstrations, names, where)
    else:
        demonstrations = resampled(demonstrations, rate_hz, names, where)
        record["resampled"] = f"to {rate_hz:g} Hz: joints by linear interpolation, all else as recorded last"
    check_rate(demonstrations, where)
    if robot is not None:
        warnings = record.get("warning"), speed_warning(demonstrations, robot, where, names)
        record["warning"] = "; ".join(filter(None, warnings))
    return replace(demonstrations, import_record={subject: said for subject, said in record.items() if said})


def import_to(
    source: Path, destination: Path, robot: Robot | None = None, options: ImportOptions | None = None
) -> Demonstrations:
    """`import_demonstrations`, then `write_dataset`; on any error nothing is written to ``destination``."""
    check_vacant(destination)
    demonstrations = import_demonstrations(source, robot, options)
    write_dataset(demonstrations, destination)
    return demonstrations


def _without_robot(data: SourceData, actions: ActionChoice, source: Path) -> Demonstrations:
    """All columns as joints in rad, if that is possible."""
    given = data.demonstrations
    if not data.in_rad and is_so_arm(given.robot):
        raise UserError(f"{source} was recorded on {given.robot!r}, not in rad: name the robot with --robot.")
    if "velocity" in (actions.removeprefix("joint_"), data.actions):
        return given
    return replace(given, episodes=tuple(replace(one, action=None) for one in given.episodes))


def _read(source: Path, robot: Robot | None, options: ImportOptions) -> SourceData:
    rate_hz = options.rate_hz
    if rate_hz is not None and not 0 < rate_hz < float("inf"):
        raise UserError(f"The sampling rate is {rate_hz:g} Hz; it must be a finite number above zero.")
    start, size = _beginning(source)
    if start is None:
        return _read_folder(source, robot, options)
    if not start:
        raise UserError(f"{source} is an empty file.")
    with bounded_memory(str(source), size):
        return _read_file(source, start, robot, options)


def _read_file(source: Path, start: bytes, robot: Robot | None, options: ImportOptions) -> SourceData:
    if start.startswith((ROS1, MCAP)) or source.suffix == ".db3":
        return read_bag([source], options)
    for magic, what in FOREIGN.items():
        if start.startswith(magic):
            raise UserError(f"{source} is {what}.")
    if start.startswith(b"PK"):
        return read_npz(source, options)
    if start.startswith(b"\x89HDF\r\n\x1a\n"):
        return _read_hdf5(source, options)
    if source.suffix.lower() in {".npz", ".hdf5", ".h5"}:
        raise UserError(f"{source} does not hold what its name says; it is truncated or damaged.")
    names = () if robot is None or options.joints else robot.joint_names
    return read_csv(source, names, options)


def _read_hdf5(source: Path, options: ImportOptions) -> SourceData:
    try:
        from latentarm.demonstrations.importers.aloha import is_aloha, read_aloha
        from latentarm.demonstrations.importers.robomimic import read_robomimic
    except ModuleNotFoundError as error:
        raise UserError(f"{source} is an HDF5 file: pip install 'latentarm[hdf5]' to read it.") from error
    return (read_aloha if is_aloha(source) else read_robomimic)(source, options)


def _read_folder(source: Path, robot: Robot | None, options: ImportOptions) -> SourceData:
    if not is_missing(source / INFO_PATH):
        data = read_lerobot(source)
        rate_hz = options.rate_hz or data.demonstrations.rate_hz
        return replace(data, demonstrations=replace(data.demonstrations, rate_hz=rate_hz))
    if runs := harmonic_runs(source):
        return read_harmonic(runs, options)
    entries = sorted(source.iterdir(), key=lambda entry: (len(entry.name), entry.name))  # 2 before 10
    files = [entry for entry in entries if entry.name.lower().endswith(FILES)]
    if files and not is_missing(source / BAG_INFO):
        with bounded_memory(str(source), sum(file.stat().st_size for file in files)):
            return read_bag(files, options)
    files += [entry for entry in entries if not is_missing(entry / BAG_INFO)]
    if not files:
        raise UserError(
            f"{source} holds no recordings: neither a dataset's {INFO_PATH} nor a file ending in"
            f" {', '.join(FILES)}."
        )
    return join_files({file.name: _read(file, robot, options) for file in files}, str(source))


def _beginning(source: Path) -> tuple[bytes | None, int]:
    """The first bytes of a file and its size; None for a folder."""
    try:
        if source.is_dir():
            return None, 0
    except OSError as error:
        raise UserError(f"{source} cannot be read: {error.strerror or error}.") from error
    with opened(source, MAX_FILE_BYTES) as stream:
        return stream.read(16), os.fstat(stream.fileno()).st_size
