"""Bringing demonstrations of any known kind into a dataset of our own."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Final, Literal

from latentarm.demonstrations.bounds import MAX_FILE_BYTES
from latentarm.demonstrations.csv_file import read_csv
from latentarm.demonstrations.dataset import write_dataset
from latentarm.demonstrations.folders import check_vacant
from latentarm.demonstrations.lerobot import read_lerobot
from latentarm.demonstrations.npz_file import read_npz
from latentarm.demonstrations.robomimic import read_robomimic
from latentarm.demonstrations.validation import validate
from latentarm.errors import UserError
from latentarm.robots.robot import Robot
from latentarm.types import Demonstrations
from latentarm.untrusted.memory import bounded_memory
from latentarm.untrusted.opening import opened

FOREIGN: Final = {
    b"\x80": "a pickle, which is never opened",
    b"\x93NUMPY": "a single array; an .npz with the arrays q, episode_ends and rate_hz is needed",
    b"PAR1": "a single Parquet file; give the dataset's folder",
    b"SQLite format 3": "a SQLite database; export it to a dataset first",
}


def import_demonstrations(
    source: Path,
    robot: Robot | None = None,
    *,
    rate_hz: float | None = None,
    task: str | None = None,
    actions: Literal["known", "joint_velocity"] = "known",
) -> Demonstrations:
    """Read demonstrations from a file or folder of any known kind, and check them.

    What the source is follows from its content: a folder with a LeRobot v3.0 layout, a NumPy
    archive, an HDF5 file in robomimic's layout, or a CSV file.

    Args:
        source: the file or folder.
        robot: the arm that was recorded; with it the number of joints and their limits are checked.
        rate_hz: sampling rate, for files that do not say it.
        task: what was done, in words, for files that do not say it.
        actions: ``"known"`` keeps recorded actions only where the source says that they are joint
            velocities; ``"joint_velocity"`` takes the caller's word for it.

    Raises:
        UserError: one sentence naming the file and, where it applies, the episode and the sample.
    """
    demonstrations = _read(source, robot, rate_hz, task, actions)
    if robot is not None:
        demonstrations = _as_recorded_on(robot, demonstrations, source)
    validate(demonstrations, str(source), None if robot is None else robot.limits)
    return demonstrations


def import_to(
    source: Path,
    destination: Path,
    robot: Robot | None = None,
    *,
    rate_hz: float | None = None,
    task: str | None = None,
    actions: Literal["known", "joint_velocity"] = "known",
) -> Demonstrations:
    """`import_demonstrations`, then `write_dataset`; on any error nothing is at ``destination``.

    Raises:
        UserError: see those two.
    """
    check_vacant(destination)
    demonstrations = import_demonstrations(source, robot, rate_hz=rate_hz, task=task, actions=actions)
    write_dataset(demonstrations, destination)
    return demonstrations


def _read(
    source: Path,
    robot: Robot | None,
    rate_hz: float | None,
    task: str | None,
    actions: Literal["known", "joint_velocity"],
) -> Demonstrations:
    if rate_hz is not None and not 0 < rate_hz < float("inf"):
        raise UserError(f"The sampling rate is {rate_hz:g} Hz; it must be a finite number above zero.")
    start, size = _beginning(source)
    if start is None:
        return read_lerobot(source, actions)
    if not start:
        raise UserError(f"{source} is an empty file.")
    for magic, what in FOREIGN.items():
        if start.startswith(magic):
            raise UserError(f"{source} is {what}.")
    with bounded_memory(str(source), size):
        return _read_file(source, start, robot, rate_hz, task, actions)


def _read_file(
    source: Path,
    start: bytes,
    robot: Robot | None,
    rate_hz: float | None,
    task: str | None,
    actions: Literal["known", "joint_velocity"],
) -> Demonstrations:
    if start.startswith(b"PK"):
        return read_npz(source, rate_hz, task)
    if start.startswith(b"\x89HDF\r\n\x1a\n"):
        return read_robomimic(source, rate_hz, task, actions)
    if source.suffix.lower() in {".npz", ".hdf5", ".h5"}:
        raise UserError(f"{source} does not hold what its name says; it is truncated or damaged.")
    return read_csv(source, () if robot is None else robot.joint_names, rate_hz, task)


def _beginning(source: Path) -> tuple[bytes | None, int]:
    """The first bytes of a file, by which it is known, and its size; None for a folder."""
    try:
        if source.is_dir():
            return None, 0
    except OSError as error:
        raise UserError(f"{source} cannot be read: {error.strerror or error}.") from error
    with opened(source, MAX_FILE_BYTES) as stream:
        return stream.read(16), os.fstat(stream.fileno()).st_size


def _as_recorded_on(robot: Robot, demonstrations: Demonstrations, source: Path) -> Demonstrations:
    """The demonstrations under the robot's name and the names of its joints."""
    names = demonstrations.joint_names
    if len(names) != robot.dof:
        raise UserError(
            f"{source}: the states have {len(names)} joints, but the robot {robot.name} has {robot.dof}; "
            "choose the robot that was recorded."
        )
    if set(names) == set(robot.joint_names) and names != robot.joint_names:
        raise UserError(
            f"{source}: the joints are in the order {', '.join(names)}, "
            f"but the robot {robot.name} has them in the order {', '.join(robot.joint_names)}; reorder them."
        )
    return replace(
        demonstrations,
        robot=robot.name,
        joint_names=robot.joint_names,
        end_effector=robot.end_effector,
        limits=robot.stated_limits,
    )
