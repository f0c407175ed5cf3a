"""The description in a run's folder: its task, its robot, and the dataset that it was trained on.

A run from elsewhere is read with bounded readers, and nothing outside its folder is opened but the dataset
that it names, for the parts that it does not keep.
"""

import hashlib
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from latentarm.core.context import feature_names
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, FloatArray, Goal, StatedLimits, StrPath
from latentarm.core.untrusted.opening import is_missing, read_bytes
from latentarm.demonstrations.dataset import read_dataset
from latentarm.demonstrations.info import goals_document, parse_goals
from latentarm.demonstrations.validation import check_goal
from latentarm.models.reading import Section
from latentarm.models.saving import CONFIG_LIMIT, WEIGHTS_NAME
from latentarm.robots.assemble import restate
from latentarm.robots.catalogue import load_robot
from latentarm.robots.end_effector import AmbiguousEndEffectorError
from latentarm.robots.limits_file import limits_document, parse_limits
from latentarm.robots.model_copy import COPIES, load_copy
from latentarm.robots.robot import Robot
from latentarm.tasks.catalogue import HELD_OUT, SCENE_TASKS, TASKS

ROBOT: Final = "robot"  # folder of a run that holds the copy of its robot's model
_LARGEST_WEIGHTS: Final = 1 << 30  # bytes


@dataclass(frozen=True, eq=False)
class Run:
    """A trained run, without its weights."""

    folder: Path
    demonstrations: Path  # where the dataset was that the model was trained on
    held_out: tuple[int, ...]
    model: str  # the model's name
    context: tuple[str, ...]  # the features that its decoder sees, in order
    robot: str  # name or model file of the robot, or "" where it is unknown
    end_effector: str | None  # which site, body or link of a model file is the end-effector
    fingerprint: str  # of the dataset's states, so that another dataset is not taken for it
    limits: StatedLimits | None = None  # limits of the robot that a person stated, or None
    robot_model: str | None = None
    """Name of the copy of the robot's model file in the folder `ROBOT`; None for a robot of the catalogue,
    and where no copy was kept."""
    task: str | None = None  # the task that it was trained for; None in older runs, which kept none
    goals: tuple[Goal, ...] = ()
    routes: tuple[FloatArray, ...] | None = None
    """The ways of the held-out episodes, see `latentarm.tasks.replay.routes_of`; None where the run does not
    keep them."""
    open_at: tuple[FloatArray, ...] = ()
    """What the gripper does along them, see `latentarm.tasks.replay.GripperRoutes`; empty where the model
    does not see it."""

    def dataset(self, moved_to: Path | None = None, wanted: str = "", option: bool = True) -> Demonstrations:
        """The dataset that the model was trained on, or ``moved_to`` if it was moved.

        ``wanted`` names, for the message, the part that the run does not keep, and ``option`` tells whether
        the user can name the dataset with ``--demonstrations``.

        Raises UserError where it is not there, cannot be read, or is another dataset.
        """
        path = moved_to or self.demonstrations
        if is_missing(path):
            keeps = f"{self.folder} does not keep {wanted}, and its dataset" if wanted else "The dataset"
            remedy = (
                "say where with --demonstrations" if option else "put it back there, or train the run again"
            )
            raise UserError(f"{keeps} is not at {path} any more: {remedy}.")
        demonstrations = read_dataset(path)
        if fingerprint(demonstrations) != self.fingerprint:
            named = "Name that one with --demonstrations" if option else "Put that one there"
            raise UserError(
                f"{path} is not the dataset that {self.folder} was trained on: its states differ. {named}, or"
                " train anew."
            )
        return demonstrations


def fingerprint(demonstrations: Demonstrations) -> str:
    """SHA-256 of all states, episode by episode, in the precision that they are stored in."""
    digest = hashlib.sha256()
    for episode in demonstrations.episodes:
        digest.update(str(episode.state.shape).encode())
        digest.update(np.ascontiguousarray(episode.state, dtype=np.float32).tobytes())
    return digest.hexdigest()


def weights_fingerprint(run: Path) -> str:
    """SHA-256 of a run's weights, to tell models of one name apart; UserError without a model."""
    return hashlib.sha256(read_bytes(run / WEIGHTS_NAME, _LARGEST_WEIGHTS)).hexdigest()


def run_facts(run: Run) -> dict[str, object]:
    """The keys of the run's ``config.json`` that `read_run` needs."""
    return {
        "demonstrations": str(run.demonstrations.resolve()),
        "held_out": list(run.held_out),
        "kind": run.model,
        "context": list(run.context),
        "robot": run.robot,
        "end_effector": run.end_effector,
        "limits": None if run.limits is None else limits_document(run.limits),
        "fingerprint": run.fingerprint,
        "robot_model": run.robot_model,
        "task": run.task,
        "goals": goals_document(run.goals),
        "routes": None if run.routes is None else [route.tolist() for route in run.routes],
        "open_at": [one.tolist() for one in run.open_at],
    }


def read_run(folder: StrPath) -> Run:
    """Read a run folder's own description; the model itself is checked when it is loaded.

    Raises UserError where the folder is not a run, or its ``config.json`` is damaged.
    """
    folder = Path(folder)
    path = folder / "config.json"
    if is_missing(path):
        raise UserError(f"{folder} is not a run: it has no config.json (see `latentarm train`).")
    config = Section.of_file(path, CONFIG_LIMIT)
    plain = config.plain()
    limits = plain.get("limits")
    later = ("robot_model", "task", "goals", "routes", "open_at")  # runs of earlier versions lack these
    kept = {key: plain[key] for key in later if plain.get(key) is not None}
    dof = config.section("model").section("dimensions").integer("action", 1) if kept else 0
    goals = parse_goals(kept.get("goals", []), str(path))
    for index, goal in enumerate(goals):
        check_goal(goal, index, dof, str(path))
    routes = _routes(config, dof) if "routes" in kept else None
    return Run(
        folder=folder,
        demonstrations=Path(config.text("demonstrations")),
        held_out=tuple(config.integers("held_out", 0)),
        model=config.text("kind"),
        context=_context(config),
        robot=config.text("robot"),
        end_effector=None if config.plain().get("end_effector") is None else config.text("end_effector"),
        fingerprint=config.text("fingerprint"),
        limits=None if limits is None else parse_limits(limits, f"{path}, limits"),
        robot_model=config.choice("robot_model", COPIES) if "robot_model" in kept else None,
        task=config.choice("task", (*TASKS, *SCENE_TASKS, HELD_OUT)) if "task" in kept else None,
        goals=goals,
        routes=routes,
        open_at=_open_at(config, routes or ()) if kept.get("open_at") else (),
    )


def _context(config: Section) -> tuple[str, ...]:
    """Names of features; earlier versions wrote one name for all."""
    given = config.plain().get("context")
    named = config.text("context") if isinstance(given, str) else config.texts("context")
    try:
        return feature_names(named)
    except UserError as error:
        raise UserError(f"{config.where}: {error}") from error


def _routes(config: Section, dof: int) -> tuple[FloatArray, ...]:
    """Arrays (K + 1, n), each with a start and at least one waypoint."""
    routes: list[FloatArray] = []
    for number, route in enumerate(config.entries("routes")):
        one = Section(f"{config.where}, 'routes'", {str(number): route}).array(str(number), (None, dof))
        if len(one) < 2:
            raise UserError(f"{config.where}: route {number} has no waypoint: the run is damaged.")
        routes.append(one)
    return tuple(routes)


def _open_at(config: Section, routes: Sequence[FloatArray]) -> tuple[FloatArray, ...]:
    """Whether the gripper is to be open, 1 or 0, from each state of the routes on."""
    entries = config.entries("open_at")
    if len(entries) != len(routes):
        raise UserError(f"{config.where}: 'open_at' has {len(entries)} entries for {len(routes)} routes.")
    return tuple(
        Section(f"{config.where}, 'open_at'", {str(number): one}).array(str(number), (len(routes[number]),))
        for number, one in enumerate(entries)
    )


def robot_of(run: Run) -> Robot:
    """The robot of a run's dataset; UserError where the dataset named none, or it cannot be loaded."""
    if not run.robot:
        raise UserError(f"{run.demonstrations} does not name its robot: import it again with --robot.")
    try:
        if run.robot_model is None:
            return load_robot(run.robot, run.end_effector, run.limits)
        robot = load_copy(run.folder / ROBOT / run.robot_model, run.end_effector)
        return robot if run.limits is None else restate(robot, run.limits)
    except AmbiguousEndEffectorError as error:
        command = f"latentarm train --demonstrations {run.demonstrations} --end-effector NAME"
        raise UserError(
            f"{run.folder} does not say which end-effector of {run.robot} it was trained for: train it anew"
            f" with `{command}`, where NAME is one of {error.choices}."
        ) from error


def git_commit() -> str | None:
    """The commit of this package, where it is run from a clone."""
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=5)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() if done.returncode == 0 else None
