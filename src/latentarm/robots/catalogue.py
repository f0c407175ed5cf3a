"""Robots by name, including the MuJoCo Menagerie's where `mujoco-menagerie` is installed."""

import importlib
from collections.abc import Callable
from functools import cache
from os import fspath
from pathlib import Path
from typing import Any

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, StatedLimits, StrPath
from latentarm.robots.assemble import restate
from latentarm.robots.end_effector import AmbiguousEndEffectorError
from latentarm.robots.fork import with_fork
from latentarm.robots.model_file import load_model_file
from latentarm.robots.panda import fr3, panda
from latentarm.robots.planar import planar
from latentarm.robots.robot import Robot

ROBOTS: dict[str, Callable[[], Robot]] = {
    "panda": panda,
    "planar": planar,
    "planar2": lambda: planar(arms=2),
    "panda_fork": cache(lambda: with_fork(panda())),
    "fr3": fr3,
}
"""The built-in robots."""


def load_robot(
    name_or_path: StrPath, end_effector: str | None = None, limits: StatedLimits | None = None
) -> Robot:
    """A robot from the catalogue, or one from an MJCF or URDF file.

    Args:
        name_or_path: a name in `ROBOTS`, the path of an .xml or .urdf file, or a name in the MuJoCo
            Menagerie where the package `mujoco-menagerie` is installed.
        end_effector: site or body of a file's model; see `load_model_file`.
        limits: stated limits, in place of known or assumed ones.

    Raises:
        AmbiguousEndEffectorError: the model's end-effector must be named.
        UserError: the name is unknown, an end-effector is given for a named robot, the file cannot be
            used, or the limits are not those of its joints.
    """
    robot = _load(fspath(name_or_path), end_effector)
    return robot if limits is None else restate(robot, limits)


def load_recorded_robot(demonstrations: Demonstrations, dataset: str = "") -> Robot:
    """The robot of a recording, with the end-effector and limits that its dataset names."""
    whose = dataset or "The dataset"
    if not demonstrations.robot:
        raise UserError(f"{whose} does not name its robot: import it again with --robot.")
    try:
        return load_robot(demonstrations.robot, demonstrations.end_effector, demonstrations.limits)
    except AmbiguousEndEffectorError as error:
        command = (
            f"latentarm import {dataset or 'DATASET'} NEW --robot {demonstrations.robot} --end-effector NAME"
        )
        raise UserError(
            f"{whose} does not say which end-effector of {demonstrations.robot} was recorded. Add it with"
            f" `{command}`, where NAME is one of {error.choices}."
        ) from error


def _load(name_or_path: str, end_effector: str | None) -> Robot:
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


def menagerie_file(name: str) -> Path | None:
    """The MJCF file of a Menagerie robot, downloaded if need be; None if robot or package is missing."""
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
