"""Saved poses, such as "Drink"; per robot and person, a file each."""

from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import Field

from latentarm.core.errors import UserError
from latentarm.core.untrusted.names import MOST_CHARACTERS, clean_name, same_name
from latentarm.web.protocol.notice import Message, NoticeError
from latentarm.web.records.record_files import read_record, write_record

MOST_POSES: Final = 30  # of a person, on all robots
POSES_NAME: Final = "poses.json"


class SavedPose(Message):
    """A pose; ``q``: (n,), joint positions, rad."""

    robot: Annotated[str, Field(max_length=200)]
    name: Annotated[str, Field(min_length=1, max_length=MOST_CHARACTERS)]
    q: Annotated[tuple[float, ...], Field(min_length=1, max_length=64)]


class PosesRecord(Message):
    """All poses of a person, in the order in which they were saved."""

    version: Literal[1] = 1
    poses: Annotated[tuple[SavedPose, ...], Field(max_length=MOST_POSES)] = ()


def read_poses(folder: Path) -> tuple[SavedPose, ...]:
    """The poses in a folder; none where there is no file."""
    path = folder / POSES_NAME
    return read_record(PosesRecord, path).poses if path.exists() else ()


def write_poses(folder: Path, poses: tuple[SavedPose, ...]) -> None:
    """Write poses to a folder, whole or not at all."""
    write_record(PosesRecord(poses=poses), folder / POSES_NAME)


def with_pose(
    poses: tuple[SavedPose, ...], robot: str, name: str, q: tuple[float, ...]
) -> tuple[SavedPose, ...]:
    """The poses with one more; replaces one of that name for that robot.

    Raises UserError if the name is invalid, or there are too many.
    """
    try:
        clean = clean_name(name)
    except UserError as error:
        raise NoticeError("pose_name_invalid", count=MOST_CHARACTERS) from error
    others = without_pose(poses, robot, clean)
    if len(others) >= MOST_POSES:
        raise NoticeError("too_many_poses", count=MOST_POSES)
    return (*others, SavedPose(robot=robot, name=clean, q=q))


def without_pose(poses: tuple[SavedPose, ...], robot: str, name: str) -> tuple[SavedPose, ...]:
    """The poses without that of a name for a robot."""
    return tuple(one for one in poses if one.robot != robot or not same_name(one.name, name))
