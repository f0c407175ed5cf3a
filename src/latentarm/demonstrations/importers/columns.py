"""Matches the columns of a file to the joints of the robot.

Columns match by name: exactly, or else by their words, without case, separators, ``pos``, ``joint`` and a
common prefix (``panda_joint1`` is ``Joint 1``, ``main_elbow_flex`` is ``elbow_flex.pos``). As many numbered
columns as joints are taken from the base to the tool. The user must state anything else.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.demonstrations.info import default_joint_names

_GRIPPERS: Final = frozenset({"gripper", "finger", "fingers", "jaw", "hand"})
_FILLERS: Final = frozenset({"pos", "position", "joint", "joints", "deg", "degrees", "rad", "radians"})


@final
@dataclass(frozen=True)
class Columns:
    """The used columns of the states, counted from zero."""

    joints: tuple[int, ...]  # n columns, in the order of the robot's joints
    gripper: int | None
    dropped: tuple[int, ...]  # unused columns
    how: str  # how the joints were found, for people


def is_gripper(name: str) -> bool:
    """Whether a name is a gripper's."""
    return not _GRIPPERS.isdisjoint(_words(name))


def is_width(name: str) -> bool:
    """Whether a gripper's name says that its column is an opening, m."""
    return "width" in _words(name)


def find_columns(
    names: Sequence[str], joints: Sequence[str], told: Sequence[str], gripper: str | None, source: str
) -> Columns:
    """Find the column of each joint, by name where ``told`` is empty.

    ``told`` is ``JOINT=COLUMN`` for every joint, or one column for every joint in the robot's order; a column
    is a name or a number, counted from zero. ``gripper`` is the gripper's column, or None to find it by name.
    """
    for joint in joints:
        if is_gripper(joint):
            raise UserError(
                f"The robot's joint {joint} drives its gripper, which is not one of the arm's joints: name an"
                " end-effector before it with --end-effector."
            )
    grippers = [index for index, name in enumerate(names) if is_gripper(name)]
    found_gripper = grippers[0] if len(grippers) == 1 else None
    if gripper is not None:
        found_gripper = _column(gripper, names, source)
    if told:
        found, how = _as_told(names, joints, told, source), "as told"
    else:
        excluded = {*grippers, found_gripper}
        candidates = [index for index in range(len(names)) if index not in excluded]
        found, how = _by_name(names, candidates, joints, source)
    if found_gripper in found:
        if gripper is not None:
            raise UserError(f"{source}: the column {names[found_gripper]} cannot be both gripper and joint.")
        found_gripper = None
    used = {*found, found_gripper}
    dropped = tuple(index for index in range(len(names)) if index not in used)
    return Columns(tuple(found), found_gripper, dropped, how)


def _as_told(names: Sequence[str], joints: Sequence[str], told: Sequence[str], source: str) -> list[int]:
    if all("=" in entry for entry in told):
        pairs = dict(entry.split("=", 1) for entry in told)
        if set(pairs) != set(joints) or len(pairs) != len(told):
            raise UserError(
                f"--joints must give one column for each joint of the robot:"
                f" {' '.join(f'{one}=COLUMN' for one in joints)}."
            )
        columns = [pairs[joint] for joint in joints]
    elif len(told) == len(joints) and not any("=" in entry for entry in told):
        columns = list(told)
    else:
        raise UserError(
            f"--joints must name {len(joints)} columns, for {', '.join(joints)} in this order, or be pairs"
            f" such as {joints[0]}=COLUMN."
        )
    found = [_column(column, names, source) for column in columns]
    for index in found:
        if found.count(index) > 1:
            raise UserError(f"--joints takes the column {names[index]} for more than one joint.")
    return found


def _column(column: str, names: Sequence[str], source: str) -> int:
    if column in names:
        return names.index(column)
    if re.fullmatch(r"\d{1,6}", column) and int(column) < len(names):
        return int(column)
    raise UserError(f"{source} has no column {column!r}; it has {', '.join(names)}.")


def _by_name(
    names: Sequence[str], candidates: Sequence[int], joints: Sequence[str], source: str
) -> tuple[list[int], str]:
    if len(candidates) == len(joints) and tuple(names) == default_joint_names(len(names)):
        return list(candidates), "the file names no columns: its order is taken as base to tool"
    place = {names[index]: index for index in candidates}
    if all(joint in place for joint in joints):
        return [place[joint] for joint in joints], "by name"
    keys = _keys([names[index] for index in candidates])
    wanted = _keys(joints)
    if len(set(wanted)) == len(wanted) and all(keys.count(key) == 1 for key in wanted):
        return [candidates[keys.index(key)] for key in wanted], "by name, though spelled differently"
    if len(candidates) == len(joints) and _numbered(keys):
        how = "by number: the names carry no meaning, so the file's order is taken as base to tool"
        return list(candidates), how
    if len(candidates) < len(joints):
        listed = ", ".join(names[index] for index in candidates)
        raise UserError(
            f"{source}: the states have {len(candidates)} joints ({listed}),"
            f" but the robot has {len(joints)} ({', '.join(joints)}); choose the robot that was recorded."
        )
    suggestion = " ".join(names[index] for index in candidates[: len(joints)])
    raise UserError(
        f"{source}: the columns {', '.join(names)} cannot be matched to the robot's joints"
        f" {', '.join(joints)}. Choose the robot that was recorded with --robot, or name the column of each"
        f" joint in the robot's order, as in --joints {suggestion}."
    )


def _numbered(keys: Sequence[tuple[str, ...]]) -> bool:
    """Whether the keys are consecutive numbers and nothing else."""
    if not all(len(key) == 1 and key[0].isdecimal() for key in keys):
        return False
    numbers = [int(key[0]) for key in keys]
    return numbers == list(range(numbers[0], numbers[0] + len(numbers))) and numbers[0] in (0, 1)


def _words(name: str) -> list[str]:
    return re.findall(r"[a-z]+|[0-9]{1,9}", name.lower())


def _keys(names: Sequence[str]) -> list[tuple[str, ...]]:
    """Words of each name, without fillers and the common prefix."""
    words = [[word for word in _words(name) if word not in _FILLERS] for name in names]
    while len(words) > 1 and all(len(one) > 1 for one in words) and len({one[0] for one in words}) == 1:
        words = [one[1:] for one in words]
    return [tuple(one) for one in words]
