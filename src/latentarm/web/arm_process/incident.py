"""Incident files: what an arm was told in the last minutes, with all that is needed to decide it again."""

import base64
import hashlib
import json
import platform
import sys
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath
from typing import Any, Final

import numpy as np
from threadpoolctl import threadpool_info

from latentarm import __version__
from latentarm.alignment.profile import folder_of
from latentarm.control.call_log import MOST_FILE_BYTES, CallLog
from latentarm.control.exact_json import of_json, to_json
from latentarm.control.journal_limits import JournalLimits
from latentarm.control.safety.zones import Zone
from latentarm.errors import UserError
from latentarm.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere
from latentarm.models.saving import CONFIG_NAME, WEIGHTS_NAME
from latentarm.robots.model_copy import MOST_COPIED
from latentarm.runs.folder import ROBOT
from latentarm.untrusted.opening import read_bytes
from latentarm.web.arm_process.beginning import RobotOptions
from latentarm.web.arm_process.drive_setup import DriveSetup, Spec, load_setup
from latentarm.web.arm_process.speeds import Speeds

SUFFIX: Final = ".incident.gz"

KEPT_BYTES: Final = 512 << 20
"""Of all incident files in a folder; the oldest go first."""

_RUN: Final = "run"
_LIMITS: Final = "limits"
_PART_BYTES: Final = 30_000
_KINDS: Final[dict[str, type]] = {
    kind.__name__: kind
    for kind in (Spec, JournalLimits, RobotOptions, Speeds, Zone, HalfSpace, Sphere, Capsule, Box)
}


def begin_incident(setup: DriveSetup) -> CallLog | None:
    """A new incident file for a drive that begins; None where nothing is to be kept, or it cannot be.

    Args:
        setup: what is driven.
    """
    spec = setup.spec
    if not spec.incidents:
        return None
    folder = spec.out / "incidents"
    limits = JournalLimits(MOST_FILE_BYTES, spec.journal.least_free_bytes)
    try:
        room = KEPT_BYTES - MOST_FILE_BYTES
        for file in sorted(folder.glob(f"*{SUFFIX}"), reverse=True):
            room -= file.stat().st_size
            if room < 0:
                file.unlink()
        return CallLog(folder / f"{datetime.now(UTC):%Y%m%d-%H%M%S-%f}{SUFFIX}", limits, _head(setup))
    except (OSError, UserError) as error:
        sys.stderr.write(f"latentarm: no incident file is written: {error}.\n")
        return None


def computer() -> dict[str, str]:
    """What the last bits of a result depend on."""
    kernels = {f"{one['internal_api']} {one.get('architecture')}" for one in threadpool_info()}
    versions = f"Python {platform.python_version()}, NumPy {np.__version__}"
    return {
        "latentarm": __version__,
        "platform": f"{platform.system()} {platform.machine()}, {versions}, {', '.join(sorted(kernels))}",
    }


def rebuild(head: Mapping[str, Any], folder: Path, where: str) -> DriveSetup:
    """What was driven, loaded again.

    Args:
        head: the first line of a file.
        folder: where its copies are.
        where: what errors call it.

    Raises:
        UserError: something that it names is missing here, or differs.
    """
    try:
        spec: Spec = of_json(head["spec"], _KINDS)
        robot = spec.robot
        if robot.limits is not None:
            robot = replace(robot, limits=folder / _LIMITS)
        spec = replace(spec, run=None if spec.run is None else folder / _RUN, robot=robot)
        start, parts = of_json(head["start"], {}), dict[str, str](head["parts"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise UserError(f"{where} does not say what was driven: it is damaged.") from error
    setup = replace(load_setup(spec), start=start)
    here = _parts(setup)
    if differing := [name for name in here if here[name] != parts.get(name)]:
        raise UserError(
            f"{where} cannot be replayed: here its {' and '.join(differing)} differ from what was driven. Use"
            f" latentarm {head.get('latentarm')} with the same robot's model and plug-ins."
        )
    return setup


def unpack(line: Mapping[str, Any], folder: Path, where: str) -> None:
    """Write a part of a copied file.

    Args:
        line: of the file.
        folder: where copies go.
        where: what errors call it.

    Raises:
        UserError: it belongs elsewhere, or is damaged.
    """
    name = PurePosixPath(str(line["file"]))
    if name.parts[:1] not in ((_RUN,), (_LIMITS,)) or ".." in name.parts:
        raise UserError(f"{where} holds {str(name)!r}, which is no file of a run: it is damaged.")
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("ab") as file:
        file.write(base64.b64decode(str(line.get("data"))))


def _head(setup: DriveSetup) -> list[dict[str, Any]]:
    """What was driven, then copies of the files that say so."""
    spec = setup.spec
    copied: dict[str, Path] = {} if spec.robot.limits is None else {_LIMITS: spec.robot.limits}
    if spec.run is not None:
        kept = [spec.run / CONFIG_NAME, spec.run / WEIGHTS_NAME, *(spec.run / ROBOT).glob("*")]
        if spec.profile is not None:
            kept += folder_of(spec.run, spec.profile).glob("*")
        copied |= {f"{_RUN}/{file.relative_to(spec.run).as_posix()}": file for file in kept}
    named = replace(spec, run=spec.run and Path(spec.run.name), out=Path())
    first = {
        "incident": 1,
        **computer(),
        "began_utc": datetime.now(UTC).isoformat(timespec="seconds"),
        "spec": to_json(named),
        "start": to_json(setup.start),
        "parts": _parts(setup),
    }
    lines = [first]
    for name, path in copied.items():
        content = read_bytes(path, MOST_COPIED)
        for at in range(0, len(content), _PART_BYTES):
            data = base64.b64encode(content[at : at + _PART_BYTES]).decode()
            lines.append({"file": name, "data": data})
    return lines


def _parts(setup: DriveSetup) -> dict[str, str]:
    """Digests of what commands follow from, by what a person would call it."""
    robot = setup.task.robot
    arm = (robot.chain, robot.limits, robot.capsules, robot.self_pairs, robot.gripper, robot.home)
    return {
        "robot": _digest(arm),
        "goals": _digest(setup.task.goals),
        "safety limits": _digest(setup.safety),
        "model": _digest((setup.run_fingerprint, setup.controller.modes, setup.controller.objects)),
    }


def _digest(value: object) -> str:
    return hashlib.sha256(json.dumps(to_json(value)).encode()).hexdigest()
