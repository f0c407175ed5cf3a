"""Robots of the MuJoCo Menagerie, where the optional package `mujoco-menagerie` is installed."""

import importlib
from pathlib import Path
from typing import Any

from latentarm.errors import UserError


def menagerie_file(name: str) -> Path | None:
    """The MJCF file of a Menagerie robot, from the package's cache or downloaded into it.

    Args:
        name: a name in the Menagerie, such as "kinova_gen3".

    Returns:
        The file, or None where the package is not installed or has no such robot.

    Raises:
        UserError: the robot is neither in the cache nor can it be downloaded.
    """
    try:
        menagerie: Any = importlib.import_module("mujoco_menagerie")
    except ModuleNotFoundError:
        return None
    if name not in menagerie.names():
        return None
    robot = menagerie.get(name)
    try:
        # No progress on standard output, which may be a JSON document.
        folder = robot.path(progress=None)
    except (menagerie.MenagerieError, OSError) as error:
        raise UserError(
            f"Robot {name!r} is not in MuJoCo Menagerie's cache and cannot be downloaded"
            f" ({' '.join(str(error).split())}): go online once, or give the path of a model file."
        ) from error
    return Path(folder) / robot.entry(robot.default_model).file
