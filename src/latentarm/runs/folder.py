"""What a run folder says of itself: the dataset, the robot, the episodes that the model never saw."""

import hashlib
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from latentarm.demonstrations.dataset import read_dataset
from latentarm.errors import UserError
from latentarm.models.reading import Section
from latentarm.models.saving import CONFIG_LIMIT, WEIGHTS_NAME
from latentarm.robots.catalogue import load_robot
from latentarm.robots.end_effector import AmbiguousEndEffectorError
from latentarm.robots.limits_file import limits_document, parse_limits
from latentarm.robots.robot import Robot
from latentarm.types import Demonstrations, StatedLimits
from latentarm.untrusted.opening import is_missing, read_bytes

_LARGEST_WEIGHTS: Final = 1 << 30
"""Bytes."""


@dataclass(frozen=True)
class Run:
    """A trained run, without its weights.

    Attributes:
        folder: the run folder.
        demonstrations: the dataset that the model was trained on.
        held_out: episodes that neither trained nor stopped it.
        model: the model's name.
        context: what its decoder sees, ``state`` or ``state_belief``.
        robot: name or model file of the robot, or "" where it is unknown.
        end_effector: which site, body or link of a model file is the end-effector.
        limits: what was stated of the robot's limits, or None.
        fingerprint: of the dataset's states, so that another dataset is not taken for it.
    """

    folder: Path
    demonstrations: Path
    held_out: tuple[int, ...]
    model: str
    context: str
    robot: str
    end_effector: str | None
    fingerprint: str
    limits: StatedLimits | None = None

    def dataset(self, moved_to: Path | None = None) -> Demonstrations:
        """The dataset that the model was trained on.

        Args:
            moved_to: where it lies now, if it was moved.

        Raises:
            UserError: it is not there, cannot be read, or is another dataset.
        """
        path = moved_to or self.demonstrations
        if is_missing(path):
            raise UserError(
                f"The dataset of {self.folder} is not at {path} any more: say where with --demonstrations."
            )
        demonstrations = read_dataset(path)
        if fingerprint(demonstrations) != self.fingerprint:
            raise UserError(
                f"{path} is not the dataset that {self.folder} was trained on: its states differ. Name that"
                " one with --demonstrations, or train anew."
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
    """SHA-256 of a run's weights, so that another model of the same name is not taken for it.

    Raises:
        UserError: the run has no model.
    """
    return hashlib.sha256(read_bytes(run / WEIGHTS_NAME, _LARGEST_WEIGHTS)).hexdigest()


def run_facts(run: Run) -> dict[str, object]:
    """What `read_run` needs, as keys of the run's ``config.json``."""
    return {
        "demonstrations": str(run.demonstrations.resolve()),
        "held_out": list(run.held_out),
        "kind": run.model,
        "context": run.context,
        "robot": run.robot,
        "end_effector": run.end_effector,
        "limits": None if run.limits is None else limits_document(run.limits),
        "fingerprint": run.fingerprint,
    }


def read_run(folder: Path) -> Run:
    """Read a run folder's own description; the model itself is checked when it is loaded.

    Raises:
        UserError: the folder is not a run, or its ``config.json`` is damaged.
    """
    path = folder / "config.json"
    if is_missing(path):
        raise UserError(f"{folder} is not a run: it has no config.json (see `latentarm train`).")
    config = Section.of_file(path, CONFIG_LIMIT)
    # Runs from before limits could be stated have none.
    limits = config.plain().get("limits")
    return Run(
        folder=folder,
        demonstrations=Path(config.text("demonstrations")),
        held_out=tuple(config.integers("held_out", 0)),
        model=config.text("kind"),
        context=config.text("context"),
        robot=config.text("robot"),
        end_effector=None if config.plain().get("end_effector") is None else config.text("end_effector"),
        fingerprint=config.text("fingerprint"),
        limits=None if limits is None else parse_limits(limits, f"{path}, limits"),
    )


def robot_of(run: Run) -> Robot:
    """The robot that a run's dataset was recorded on.

    Raises:
        UserError: the dataset did not say, or that robot is not to be had here.
    """
    if not run.robot:
        raise UserError(
            f"{run.demonstrations} does not say which robot it is of: import it again with --robot."
        )
    try:
        return load_robot(run.robot, run.end_effector, run.limits)
    except AmbiguousEndEffectorError as error:
        command = f"latentarm train --demonstrations {run.demonstrations} --end-effector NAME"
        raise UserError(
            f"{run.folder} does not say which end-effector of {run.robot} it was trained for: train it anew"
            f" with `{command}`, where NAME is one of {error.choices}."
        ) from error


def git_commit() -> str | None:
    """The commit that this package stands at, where it is run from a clone."""
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=5)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() if done.returncode == 0 else None
