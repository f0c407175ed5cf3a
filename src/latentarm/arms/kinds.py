"""Kinds of arms by the names that makers and people give them."""

import re
from pathlib import Path
from typing import Final

from latentarm.robots.robot import Robot

_KINDS: Final = {
    "Franka Research 3": r"fr3|research.?3",
    "Franka Emika Panda": r"panda|emika|(^|_)fer(_|$)",
    "xArm 5": r"xarm.?5",
    "xArm 6": r"xarm.?6",
    "xArm 7": r"xarm.?7",
    "Lite 6": r"lite.?6",
    "850": r"(uf|^).?850",
    "SO-100": r"so.{0,5}100",
    "SO-101": r"so.{0,5}101",
    "Koch": r"koch",
    "OMX": r"omx",
}


def kind_of(name: str) -> str | None:
    """The kind that a name names, or None."""
    return next((kind for kind, said in _KINDS.items() if re.search(said, name, re.IGNORECASE)), None)


def kind_misfit(told: str, robot: Robot) -> tuple[str, ...]:
    """Why an arm that says what it is, is not this robot: a sentence, or nothing where one is not known."""
    theirs, ours = kind_of(told), kind_of(Path(robot.name).name)
    if theirs is None or ours is None or theirs == ours:
        return ()
    return (
        f"The arm says that its type is {theirs}, and {robot.name} is {ours} by its name: name the arm's own"
        " model with --robot.",
    )
