"""Incident files: every call of an arm's `Step`, with all that is needed to repeat it.

They are made to be sent to others: no name of a person, no address and no folder of this computer is in them.
"""

import base64
import hashlib
import json
import platform
import sys
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final, cast

import numpy as np
from threadpoolctl import threadpool_info

from latentarm import __version__
from latentarm.alignment.frame_file import FRAME_NAME
from latentarm.alignment.profile import folder_of
from latentarm.arms.address import MARK, is_address, parse_address
from latentarm.core.call_log import MOST_FILE_BYTES, CallLog
from latentarm.core.errors import UserError
from latentarm.core.exact_json import as_text_json, of_json, to_json
from latentarm.core.journal_limits import JournalLimits
from latentarm.core.untrusted.documents import parse_object
from latentarm.core.untrusted.names import clean_name
from latentarm.core.untrusted.opening import read_bytes
from latentarm.models.saving import CONFIG_NAME, WEIGHTS_NAME
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere
from latentarm.robots.model_copy import MOST_COPIED
from latentarm.runs.folder import ROBOT
from latentarm.safety.zones import Zone
from latentarm.web.arm_process.drive_setup import DriveSetup, Spec, load_setup
from latentarm.web.arm_process.initial_state import RobotOptions
from latentarm.web.arm_process.speed_limits import Speeds

VERSION: Final = 2
KEPT_BYTES: Final = 512 << 20  # size of all incident files in a folder; the oldest are deleted first
SUFFIX: Final = ".incident.gz"
FOLDER: Final = "incidents"
_STAMP: Final = "%Y%m%d-%H%M%S-%f"
_RUN: Final = "run"
_PERSON: Final = "person"  # stands for the name of a profile
_LIMITS: Final = "limits"
_PART_BYTES: Final = 30_000
_KINDS: Final = (Spec, JournalLimits, RobotOptions, Speeds, Zone, HalfSpace, Sphere, Capsule, Box)


def begin_incident(setup: DriveSetup) -> CallLog | None:
    """A new incident file for a drive; None if none is wanted, or it cannot be written."""
    if not setup.spec.incidents:
        return None
    folder = setup.spec.out / FOLDER
    limits = JournalLimits(MOST_FILE_BYTES, setup.spec.journal.least_free_bytes)
    try:
        room = KEPT_BYTES - MOST_FILE_BYTES
        for file in sorted(folder.glob(f"*{SUFFIX}"), reverse=True):
            room -= file.stat().st_size
            if room < 0:
                file.unlink()
        path = folder / f"{datetime.now(UTC):{_STAMP}}{SUFFIX}"
        return CallLog(path, limits, _head(setup), parse_address(setup.arm).host if setup.real else "")
    except (OSError, UserError) as error:
        sys.stderr.write(f"latentarm: no incident file is written: {error}.\n")
        return None


def incident_files(path: Path) -> list[Path]:
    """The file itself, or those of a folder, the oldest first. Raises UserError if the folder has none."""
    if not path.is_dir():
        return [path]
    if not (files := sorted([*path.glob(f"*{SUFFIX}"), *path.glob(f"{FOLDER}/*{SUFFIX}")])):
        raise UserError(f"{path} has no incident file: name the folder that `teleop --out` names.")
    return files


def began(file: Path) -> datetime | None:
    """Start of a file, from its name; None if the name has no time."""
    try:
        return datetime.strptime(file.name.removesuffix(SUFFIX), _STAMP).replace(tzinfo=UTC)
    except ValueError:
        return None


def computer() -> str:
    """Versions and hardware that the last bits of a result depend on."""
    kernels = {str(one.get("architecture")) for one in threadpool_info() if one["user_api"] == "blas"}
    programs = f"latentarm {__version__}, Python {platform.python_version()}, NumPy {np.__version__}"
    return f"{programs}, {platform.system()} {platform.machine()}, BLAS for {'/'.join(sorted(kernels))}"


def rebuild(head: Mapping[str, Any], folder: Path, where: str) -> DriveSetup:
    """Load again what the first line of a file, ``head``, and its copies in ``folder`` name.

    Raises UserError if something that it names is missing here, or differs.
    """
    try:
        spec: Spec = of_json(head["spec"], *_KINDS)
        named = spec.robot
        limits = None if named.limits is None else folder / named.limits
        model = None if named.robot is None else str(Path(named.robot).expanduser())
        run = None if spec.run is None else folder / _RUN
        spec = replace(spec, run=run, out=folder, robot=replace(named, robot=model, limits=limits))
        start, parts = of_json(head["start"]), dict[str, str](head["parts"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise UserError(f"{where} does not say what was driven: it is damaged.") from error
    setup = replace(load_setup(spec), start=start)
    if differing := [name for name, digest in _parts(setup).items() if parts.get(name) != digest]:
        raise UserError(
            f"{where} cannot be replayed here, where its {' and '.join(differing)} would be others: use"
            f" {head.get('computer')}, with the same model of the robot and the same plug-ins."
        )
    return setup


def unpack(line: Mapping[str, Any], folder: Path, where: str) -> None:
    """Append a line's part to its copy in ``folder``. Raises UserError if it does not belong there."""
    path = (folder / str(line["file"])).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise UserError(f"{where} holds {line['file']!r}, which is no file of a run: it is damaged.")
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("ab") as file:
        file.write(base64.b64decode(str(line.get("data"))))


def _head(setup: DriveSetup) -> list[dict[str, Any]]:
    spec, robot = setup.spec, setup.task.robot
    limits = spec.robot.limits
    copied: dict[str, Path] = {} if limits is None else {f"{_LIMITS}{limits.suffix}": limits}
    if spec.run is not None:
        kept = [spec.run / CONFIG_NAME, spec.run / WEIGHTS_NAME, *(spec.run / ROBOT).glob("*")]
        kept += spec.run.glob(FRAME_NAME)
        copied |= {f"{_RUN}/{file.relative_to(spec.run).as_posix()}": file for file in kept}
        if spec.profile is not None:
            copied |= {
                f"{_RUN}/{folder_of(Path(), _PERSON).as_posix()}/{file.name}": file
                for file in folder_of(spec.run, spec.profile).glob("*")
            }
    first = {
        "incident": VERSION,
        "computer": computer(),
        "began_utc": datetime.now(UTC).isoformat(timespec="seconds"),
        "spec": to_json(_unnamed(spec)),
        "settings": setup.settings,
        "robot": {
            "name": Path(robot.name).name,
            "joints": list(robot.joint_names),
            "limits": as_text_json(robot.limits),
        },
        "model": setup.run_fingerprint,
        "start": to_json(setup.start),
        "parts": _parts(setup),
    }
    contents = {name: _content(path, spec.profile) for name, path in copied.items()}
    return [first] + [
        {"file": name, "data": base64.b64encode(content[at : at + _PART_BYTES]).decode()}
        for name, content in contents.items()
        for at in range(0, len(content), _PART_BYTES)
    ]


def _unnamed(spec: Spec) -> Spec:
    """The spec without names of people, addresses, and folders of this computer."""
    named, found, arm = spec.robot, spec.found, spec.arm
    if arm is not None and is_address(arm):
        where = parse_address(arm)
        arm = f"{where.scheme}{MARK}arm"
        found = tuple((name, value.replace(where.host, "...")) for name, value in found)
    home = str(Path.home())
    robot = RobotOptions(
        None if named.robot is None else named.robot.replace(home, "~", 1),
        named.end_effector,
        None if named.limits is None else Path(f"{_LIMITS}{named.limits.suffix}"),
    )
    run, profile = spec.run and Path(_RUN), spec.profile and _PERSON
    return replace(spec, run=run, profile=profile, out=Path(), arm=arm, robot=robot, found=found)


def _content(path: Path, profile: str | None) -> bytes:
    """A file of a run; in a description, folders of this computer and the profile's name are left out."""
    content = read_bytes(path, MOST_COPIED)
    if path.name != CONFIG_NAME:
        return content

    names = () if profile is None else (profile, clean_name(profile))

    def unnamed(value: Any) -> Any:
        match value:
            case str():
                return _PERSON if value in names else Path(value).name if Path(value).is_absolute() else value
            case dict():
                return {key: unnamed(one) for key, one in cast(dict[str, Any], value).items()}
            case list():
                return [unnamed(one) for one in cast(list[Any], value)]
            case _:
                return value

    return json.dumps(unnamed(parse_object(content, str(path)))).encode()


def _parts(setup: DriveSetup) -> dict[str, str]:
    """Digests of what commands depend on, by the names that people use."""
    robot, controller = setup.task.robot, setup.controller
    parts: dict[str, object] = {
        "robot": (robot.chain, robot.limits, robot.capsules, robot.self_pairs, robot.gripper),
        "goals": setup.task.goals,
        "safety limits": setup.step().safety,
        "model": (setup.run_fingerprint, controller.modes, controller.objects),
    }
    return {
        name: hashlib.sha256(json.dumps(to_json(part)).encode()).hexdigest() for name, part in parts.items()
    }
