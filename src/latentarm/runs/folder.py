"""What a run folder says of itself: the dataset, the robot, the episodes that the model never saw."""

import hashlib
import json
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np

from latentarm.demonstrations.dataset import read_dataset
from latentarm.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.types import Demonstrations


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

    def dataset(self, moved_to: Path | None = None) -> Demonstrations:
        """The dataset that the model was trained on.

        Args:
            moved_to: where it lies now, if it was moved.

        Raises:
            UserError: it is not there, cannot be read, or is another dataset.
        """
        path = moved_to or self.demonstrations
        if not path.exists():
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


def run_facts(run: Run) -> dict[str, object]:
    """What `read_run` needs, as keys of the run's ``config.json``."""
    return {
        "demonstrations": str(run.demonstrations.resolve()),
        "held_out": list(run.held_out),
        "kind": run.model,
        "context": run.context,
        "robot": run.robot,
        "end_effector": run.end_effector,
        "fingerprint": run.fingerprint,
    }


def read_run(folder: Path) -> Run:
    """Read a run folder's own description; the model itself is checked when it is loaded.

    Raises:
        UserError: the folder is not a run, or its ``config.json`` is damaged.
    """
    config = _read_config(folder)
    try:
        end_effector = config["end_effector"]
        return Run(
            folder=folder,
            demonstrations=Path(str(config["demonstrations"])),
            held_out=tuple(int(index) for index in cast(list[int], config["held_out"])),
            model=str(config["kind"]),
            context=str(config["context"]),
            robot=str(config["robot"]),
            end_effector=None if end_effector is None else str(end_effector),
            fingerprint=str(config["fingerprint"]),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise UserError(
            f"{folder / 'config.json'} does not describe a run ({error} is missing or damaged):"
            " train it anew with `latentarm train`."
        ) from error


def robot_of(run: Run) -> Robot:
    """The robot that a run's dataset was recorded on.

    Raises:
        UserError: the dataset did not say, or that robot is not to be had here.
    """
    if not run.robot:
        raise UserError(
            f"{run.demonstrations} does not say which robot it is of: import it again with --robot."
        )
    return load_robot(run.robot, run.end_effector)


def git_commit() -> str | None:
    """The commit that this package stands at, where it is run from a clone."""
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "HEAD"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=5)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def _read_config(folder: Path) -> Mapping[str, object]:
    path = folder / "config.json"
    try:
        config: object = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise UserError(f"{folder} is not a run: it has no config.json (see `latentarm train`).") from error
    except OSError as error:
        raise UserError(f"{path} cannot be read: {error.strerror or error}.") from error
    except ValueError as error:
        raise UserError(f"{path} is damaged: it is no JSON. Train the run anew.") from error
    if not isinstance(config, dict):
        raise UserError(f"{path} does not describe a run: train it anew with `latentarm train`.")
    return cast(Mapping[str, object], config)
