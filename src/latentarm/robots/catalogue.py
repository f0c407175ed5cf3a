"""Robots by name."""

from collections.abc import Callable
from pathlib import Path

from latentarm.errors import UserError
from latentarm.robots.menagerie import menagerie_file
from latentarm.robots.model_file import load_model_file
from latentarm.robots.panda import panda
from latentarm.robots.planar import planar
from latentarm.robots.robot import Robot

ROBOTS: dict[str, Callable[[], Robot]] = {
    "panda": panda,
    "planar": planar,
    "planar2": lambda: planar(arms=2),
}
"""The robots that come with a plain install."""


def load_robot(name_or_path: str, end_effector: str | None = None) -> Robot:
    """A robot of the catalogue, or any robot whose MJCF or URDF file is given.

    Args:
        name_or_path: a name in `ROBOTS`, the path of an .xml or .urdf file, or a name in the MuJoCo
            Menagerie where the package `mujoco-menagerie` is installed.
        end_effector: site or body of a file's model; see `load_model_file`.

    Returns:
        The robot.

    Raises:
        UserError: the name is unknown, an end-effector is given for a named robot, or the file
            cannot be used.
    """
    if name_or_path in ROBOTS:
        if end_effector is not None:
            raise UserError(
                f"Robot {name_or_path!r} has its own end-effector: name one only for a model file."
            )
        return ROBOTS[name_or_path]()
    if Path(name_or_path).suffix.lower() in (".xml", ".urdf", ".mjcf") or Path(name_or_path).is_file():
        return load_model_file(Path(name_or_path), end_effector)
    if (found := menagerie_file(name_or_path)) is not None:
        return load_model_file(found, end_effector)
    raise UserError(
        f"There is no robot named {name_or_path!r}: use one of {', '.join(ROBOTS)}, or the path of an"
        " MJCF or URDF file."
    )
