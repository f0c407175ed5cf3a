"""What a run folder says of itself: the dataset, the robot, the episodes that the model never saw."""

import json
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from latentarm.errors import UserError


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
    """

    folder: Path
    demonstrations: Path
    held_out: tuple[int, ...]
    model: str
    context: str
    robot: str
    end_effector: str | None


def run_facts(run: Run) -> dict[str, object]:
    """What `read_run` needs, as keys of the run's ``config.json``."""
    return {
        "demonstrations": str(run.demonstrations.resolve()),
        "held_out": list(run.held_out),
        "kind": run.model,
        "context": run.context,
        "robot": run.robot,
        "end_effector": run.end_effector,
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
        )
    except (KeyError, TypeError, ValueError) as error:
        raise UserError(
            f"{folder / 'config.json'} does not describe a run ({error} is missing or damaged):"
            " train it anew with `latentarm train`."
        ) from error


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
    except (OSError, ValueError) as error:
        raise UserError(f"{path} cannot be read: {error}.") from error
    if not isinstance(config, dict):
        raise UserError(f"{path} does not describe a run: train it anew with `latentarm train`.")
    return cast(Mapping[str, object], config)
