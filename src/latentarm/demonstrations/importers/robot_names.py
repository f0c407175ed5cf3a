"""Compares a file's name for its robot with the user's robot."""

import re
from pathlib import Path
from typing import Final

from latentarm.robots.robot import Robot

SO_ARMS: Final = ("so100", "so101", "soarm100", "soarm101")
"""Names of the arms whose positions LeRobot records in degrees or in -100 to 100."""

_ALIASES: Final = {
    "franka": "panda",
    "frankaemika": "panda",
    "frankaemikapanda": "panda",
    "frankapanda": "panda",
    "mountedpanda": "panda",
    "onthegroundpanda": "panda",
    "kinova3": "gen3",
    "soarm100": "so100",
    "soarm101": "so101",
}
_ROLES: Final = re.compile(r"follower|leader|robot|arm$")


def key_of(name: str) -> str:
    """A robot's name without case, separators and role: ``so101_follower`` is ``so101``."""
    plain = re.sub(r"[^a-z0-9]", "", name.lower())
    key = _ROLES.sub("", plain) or plain
    return _ALIASES.get(key, key)


def is_so_arm(name: str) -> bool:
    """Whether a file names an SO-100 or SO-101."""
    return key_of(name) in {key_of(arm) for arm in SO_ARMS}


def may_be(named: str, robot: Robot) -> bool:
    """Whether a file's name for its robot can mean this robot, by its name, file, folder or model."""
    if named == robot.name:
        return True
    path = Path(robot.name)
    model = re.search(r'<mujoco model="([^"]*)"', robot.mjcf)
    known = {run for one in (path.stem, path.parent.name, model[1] if model else "") for run in _runs(one)}
    return key_of(Path(named).stem if "/" in named else named) in known


def _runs(name: str) -> set[str]:
    """Keys of all runs of words in a name: of ``so101_new_calib`` also ``so101``."""
    words = re.findall(r"[a-z0-9]+", name.lower())
    return {
        key_of("".join(words[start:end]))
        for start in range(len(words))
        for end in range(start + 1, len(words) + 1)
    }
