"""A limits file: a robot's limits in TOML or YAML, with units in the keys.

An example in TOML::

    tool_speed_m_per_s = 1.0

    [joints.shoulder_pan_joint]
    lower_deg = -360
    upper_deg = 360
    velocity_rad_per_s = 3.14
    acceleration_rad_per_s2 = 8.0
    jerk_rad_per_s3 = 500.0
    margin_rad = 0.05

    [gripper]
    joints = ["gripper"]
    width_m = 0.08
    speed_m_per_s = 0.1
    force_n = 10
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, cast

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import StatedGripper, StatedJointLimits, StatedLimits
from latentarm.core.untrusted.hand_written import MOST_BYTES, check_keys, number_of, parse_toml, table_of
from latentarm.core.untrusted.opening import read_bytes
from latentarm.core.untrusted.yaml_file import parse_yaml
from latentarm.robots.limits import JointLimits, Quantity, Source

TOOL_SPEED: Final = "tool_speed_m_per_s"
GRIPPER: Final = "gripper"
_GRIPPER_FIGURES: Final = {"width_m": "width", "speed_m_per_s": "speed", "force_n": "force"}
PER_TIME: Final = {
    "lower": "",
    "upper": "",
    "velocity": "_per_s",
    "acceleration": "_per_s2",
    "jerk": "_per_s3",
    "margin": "",
}
_UNITS: Final = {"rad": 1.0, "deg": math.pi / 180.0, "m": 1.0}
_SPELT: Final = {
    f"{figure}_{unit}{per}": (figure, unit) for figure, per in PER_TIME.items() for unit in _UNITS
}
_MOST: Final = {"lower": 50.0, "upper": 50.0, "velocity": 30.0, "acceleration": 100.0, "jerk": 20_000.0}
"""No joint of an arm has more, in rad or m, and s: a larger figure is in another unit than its key says."""


def read_limits(path: Path) -> StatedLimits:
    """Read a limits file, which ends in .toml, .yaml or .yml."""
    if path.suffix.lower() == ".toml":
        document = parse_toml(read_bytes(path, MOST_BYTES), path, "limits file")
    elif path.suffix.lower() in (".yaml", ".yml"):
        document = parse_yaml(read_bytes(path, MOST_BYTES), path, "a limits file that can be read")
    else:
        raise UserError(f"The limits file {path} must be TOML or YAML: name it .toml, .yaml or .yml.")
    stated = parse_limits(document, str(path))
    for joint, figures in cast("Mapping[str, Any]", document).get("joints", {}).items():
        for key, value in figures.items():
            _check_size(key, value, f"{path}: joints.{joint}.{key}")
    return stated


def _check_size(key: str, value: float, where: str) -> None:
    """Refuse a figure in another unit than its key says: the arm would be too fast to stop in time."""
    figure, unit = _SPELT[key]
    if abs(value) * _UNITS[unit] > _MOST.get(figure, math.inf):
        other = "deg" if unit == "rad" else "rad"
        hint = "give it in m" if unit == "m" else f"if it is in {other}, name it {key.replace(unit, other)}"
        raise UserError(
            f"{where} is {value}, and no joint of an arm has more than {_MOST[figure] / _UNITS[unit]:.6g}:"
            f" {hint}."
        )


def parse_limits(document: object, where: str) -> StatedLimits:
    """Validate the limits in a limits file, a dataset or a run; ``where`` names the file in errors."""
    top = table_of(document, where, "")
    check_keys(top, ("joints", TOOL_SPEED, GRIPPER), where, "")
    joints = table_of(top.get("joints", {}), where, "joints")
    tool_speed = number_of(top[TOOL_SPEED], where, TOOL_SPEED) if TOOL_SPEED in top else None
    if tool_speed is not None and tool_speed <= 0.0:
        raise UserError(f"{where}: {TOOL_SPEED} is {tool_speed:g}; it must be above zero.")
    gripper = _gripper(top[GRIPPER], where) if GRIPPER in top else None
    if not joints and tool_speed is None and gripper is None:
        raise UserError(f"{where} states no limits: give figures under joints, or {TOOL_SPEED}.")
    return StatedLimits(
        joints={name: _joint(entry, where, f"joints.{name}") for name, entry in joints.items()},
        tool_speed=tool_speed,
        gripper=gripper,
    )


def limits_document(stated: StatedLimits) -> dict[str, object]:
    """The document that `parse_limits` reads, in rad or m."""
    joints: dict[str, dict[str, float]] = {}
    for name, one in stated.joints.items():
        figures = {name: getattr(one, name) for name in PER_TIME if name not in ("lower", "upper")}
        if one.position is not None:
            figures |= {"lower": one.position[0], "upper": one.position[1]}
        unit = "m" if one.sliding else "rad"
        joints[name] = {
            f"{figure}_{unit}{PER_TIME[figure]}": value
            for figure, value in figures.items()
            if value is not None
        }
    document: dict[str, object] = {"joints": joints}
    if stated.gripper is not None:
        figures = {key: getattr(stated.gripper, name) for key, name in _GRIPPER_FIGURES.items()}
        document[GRIPPER] = {"joints": list(stated.gripper.joints), **figures}
    return document if stated.tool_speed is None else document | {TOOL_SPEED: stated.tool_speed}


def with_stated(
    limits: JointLimits, stated: StatedLimits, names: Sequence[str], slide: Sequence[bool]
) -> JointLimits:
    """The limits with stated values in place of known or assumed ones, for n named joints."""
    known = list(names)
    figures = {field: np.array(getattr(limits, field)) for fields in _SAID_BY.values() for field in fields}
    sources: dict[Quantity, list[Source]] = {one: list(limits.sources[one]) for one in _SAID_BY}
    for name, one in stated.joints.items():
        if name not in known:
            raise UserError(
                f"The limits file names the joint {name!r}; the arm's joints are {', '.join(known)}."
            )
        joint = known.index(name)
        if one.sliding is not None and one.sliding != slide[joint]:
            unit, does = ("m", "slides") if slide[joint] else ("rad or deg", "turns")
            raise UserError(f"The limits file's joints.{name} must be in {unit}: the joint {does}.")
        for quantity, fields in _SAID_BY.items():
            value = getattr(one, quantity)
            if value is not None:
                for field, figure in zip(fields, np.atleast_1d(value), strict=True):
                    figures[field][joint] = figure
                sources[quantity][joint] = "limits_file"
    said: dict[Quantity, tuple[Source, ...]] = {one: tuple(each) for one, each in sources.items()}
    return JointLimits(**figures, sources=said)


_SAID_BY: Final[Mapping[Quantity, tuple[str, ...]]] = {
    "position": ("lower", "upper"),
    "velocity": ("velocity",),
    "acceleration": ("acceleration",),
    "jerk": ("jerk",),
}


def _joint(entry: object, where: str, key: str) -> StatedJointLimits:
    given = table_of(entry, where, key)
    check_keys(given, tuple(_SPELT), where, f"{key}.")
    values: dict[str, float] = {}
    sliding: set[bool] = set()
    for name, value in given.items():
        figure, unit = _SPELT[name]
        if figure in values:
            raise UserError(f"{where}: {key} gives {figure} twice, in different units: keep one of them.")
        values[figure] = number_of(value, where, f"{key}.{name}") * _UNITS[unit]
        if figure not in ("lower", "upper") and values[figure] <= 0.0:
            raise UserError(f"{where}: {key}.{name} is {value}; it must be above zero.")
        sliding.add(unit == "m")
    if len(sliding) > 1:
        raise UserError(f"{where}: {key} mixes m with rad or deg: a joint either slides or turns.")
    if ("lower" in values) != ("upper" in values):
        raise UserError(f"{where}: {key} gives only one of lower and upper: give both.")
    position = (values["lower"], values["upper"]) if "lower" in values else None
    if position is not None and position[0] >= position[1]:
        raise UserError(f"{where}: {key} has a lower limit that is not below its upper one.")
    others = {name: values.get(name) for name in PER_TIME if name not in ("lower", "upper")}
    return StatedJointLimits(position=position, sliding=next(iter(sliding), None), **others)


def _gripper(entry: object, where: str) -> StatedGripper:
    given = table_of(entry, where, GRIPPER)
    needed = ("joints", *_GRIPPER_FIGURES)
    check_keys(given, needed, where, f"{GRIPPER}.")
    for key in needed:
        if key not in given:
            raise UserError(f"{where}: {GRIPPER} lacks {key}: give {', '.join(needed)}.")
    figures = {one: number_of(given[key], where, f"{GRIPPER}.{key}") for key, one in _GRIPPER_FIGURES.items()}
    if min(figures.values()) <= 0.0:
        raise UserError(f"{where}: the figures of {GRIPPER} must be above zero.")
    joints = given["joints"]
    if not isinstance(joints, list) or not all(isinstance(one, str) for one in cast("list[object]", joints)):
        raise UserError(
            f'{where}: {GRIPPER}.joints must be a list of names, such as ["gripper"], or [] where the model'
            " has no gripper."
        )
    return StatedGripper(joints=tuple(cast("list[str]", joints)), **figures)
