"""A zones file: where the arm is slow, what it keeps out of and what it grips: TOML, with units in the keys.

An example::

    [zones.face]
    shape = "sphere"
    centre_m = [0.6, 0.0, 0.55]
    radius_m = 0.15
    speed_m_per_s = 0.05

    [keep_out.table]
    shape = "half_space"
    point_m = [0.0, 0.0, 0.0]
    normal = [0.0, 0.0, 1.0]
    clearance_m = 0.08  # kept from it; without this key, what the safety limits keep from everything

    [gripped.cup]  # what the gripper holds where nothing else says it: a box in the frame of the tool
    centre_m = [0.0, 0.0, 0.0]
    size_m = [0.09, 0.09, 0.1]

Shapes and their keys: ``sphere`` (``centre_m``, ``radius_m``), ``capsule`` (``start_m``, ``end_m``,
``radius_m``), ``box`` (``centre_m``, ``size_m``, and ``turned_deg`` about the base's x, y and z axes in this
order, where it is turned) and ``half_space`` (``point_m`` and ``normal``, out of the solid).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, cast, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.core.untrusted.hand_written import MOST_BYTES, check_keys, number_of, parse_toml, table_of
from latentarm.core.untrusted.opening import read_bytes
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Obstacle, Sphere
from latentarm.safety.config import SafetyConfig
from latentarm.safety.obstacles import checked_obstacle
from latentarm.safety.zones import MOST_ZONES, Zone, check_name, checked_zones

_SLOW: Final = "zones"
_KEEP_OUT: Final = "keep_out"
_GRIPPED: Final = "gripped"
_SPEED: Final = "speed_m_per_s"
_CLEARANCE: Final = "clearance_m"
_MOST_CLEARANCE_M: Final = 0.5
_OVER_BASE_M: Final = 0.3  # no half-space holds the place so high over the base: the arm is there


@final
@dataclass(frozen=True, eq=False)
class StatedZones:
    """A zones file's content."""

    slow: tuple[Zone, ...] = ()  # where the arm is slow
    keep_out: tuple[Obstacle, ...] = ()  # enlarged by the clearance that they need beyond the usual one
    gripped: tuple[Box, ...] = ()  # one thing at most, in the tool's frame
    clearance: tuple[float, ...] = ()  # from each solid of ``keep_out`` as it is stated, m


def read_zones(path: Path) -> StatedZones:
    """Read a zones file; UserError where it cannot be read or is invalid, which names the key."""
    return parse_zones(parse_toml(read_bytes(path, MOST_BYTES), path, "zones file"), str(path))


def parse_zones(document: object, where: str) -> StatedZones:
    """Validate the document of a zones file; ``where`` names the file in messages.

    Raises UserError where a key is missing or unknown, a value cannot be used, two zones have the same name,
    or there are too many.
    """
    top = table_of(document, where, "")
    kinds = (_SLOW, _KEEP_OUT, _GRIPPED)
    check_keys(top, kinds, where, "")
    slow, keep_out, gripped = (table_of(top.get(key, {}), where, key) for key in kinds)
    if len(gripped) > 1:
        raise UserError(f"{where} states {len(gripped)} things in the gripper: state one that is as large.")
    if not (slow or keep_out or gripped):
        raise UserError(f"{where} states no zones: begin one with [{_SLOW}.face] or [{_KEEP_OUT}.table].")
    found = [_entry(f"{_SLOW}.{name}", entry, where, (_SPEED,)) for name, entry in slow.items()]
    solid = [_solid(name, entry, where) for name, entry in keep_out.items()]
    held = [_gripped(name, entry, where) for name, entry in gripped.items()]
    try:
        return StatedZones(
            checked_zones([Zone(make(name), speed) for name, (make, speed) in zip(slow, found, strict=True)]),
            _kept_out([make() for make, _ in solid]),
            cast("tuple[Box, ...]", _kept_out([make() for make in held])),
            tuple(clearance_m for _, clearance_m in solid),
        )
    except UserError as error:
        raise UserError(f"{where}: {error}") from error


def _kept_out(solids: list[Obstacle]) -> tuple[Obstacle, ...]:
    if len(solids) > MOST_ZONES:
        raise UserError(
            f"There are {len(solids)} solids to keep out of: {MOST_ZONES} at most are kept in time."
        )
    for solid in solids:
        check_name(solid.name, f"The obstacle {solid.name!r}")
    return tuple(checked_obstacle(solid) for solid in solids)


def _gripped(name: str, entry: object, where: str) -> Callable[[], Obstacle]:
    key = f"{_GRIPPED}.{name}"
    make, _ = _entry(key, {**table_of(entry, where, key), "shape": "box"}, where)
    return lambda: make(name)


def _solid(name: str, entry: object, where: str) -> tuple[Callable[[], Obstacle], float]:
    """A maker of a solid to keep out of, enlarged by its clearance beyond the usual one; and that, m."""
    key, usual_m = f"{_KEEP_OUT}.{name}", SafetyConfig.clearance
    given = dict(table_of(entry, where, key))
    clearance_m = number_of(given.pop(_CLEARANCE, usual_m), where, f"{key}.{_CLEARANCE}")
    if not usual_m <= clearance_m <= _MOST_CLEARANCE_M:
        raise UserError(
            f"{where}: {key}.{_CLEARANCE} is {clearance_m:g}: it must be at least {usual_m:g} and at most"
            f" {_MOST_CLEARANCE_M:g} m."
        )
    make, _ = _entry(key, given, where)
    return lambda: _grown(_beside_arm(make(name)), clearance_m - usual_m), clearance_m


def _beside_arm(solid: Obstacle) -> Obstacle:
    if (
        isinstance(solid, HalfSpace)
        and (np.array([0.0, 0.0, _OVER_BASE_M]) - solid.point) @ solid.normal < 0.0
    ):
        raise UserError(
            f"The half-space {solid.name!r} holds the arm itself: its normal must point out of the solid,"
            " towards the arm."
        )
    return solid


def _grown(solid: Obstacle, by_m: float) -> Obstacle:
    match solid:
        case HalfSpace():
            return replace(solid, point=solid.point + by_m * solid.normal)
        case Box():
            return replace(solid, half_extents=solid.half_extents + by_m)
        case Sphere() | Capsule():
            return replace(solid, radius=solid.radius + by_m)


def _entry(
    key: str, entry: object, where: str, besides: tuple[str, ...] = ()
) -> tuple[Callable[[str], Obstacle], float]:
    """Check an entry's keys, its shape's and ``besides``; a maker of its solid, and its speed, m/s."""
    given = table_of(entry, where, key)
    shape = given.get("shape")
    if not isinstance(shape, str) or shape not in _SHAPES:
        raise UserError(f"{where}: {key}.shape must be one of {', '.join(_SHAPES)}, not {str(shape)[:40]!r}.")
    needed, spare, make = _SHAPES[shape]
    check_keys(given, ("shape", *needed, *spare, *besides), where, f"{key}.")
    for one in (*needed, *besides):
        if one not in given:
            raise UserError(f"{where}: {key} lacks {one}: a {shape} needs {', '.join((*needed, *besides))}.")
    figures = {one: _figure(given[one], where, f"{key}.{one}") for one in (*needed, *spare) if one in given}
    speed = number_of(given[_SPEED], where, f"{key}.{_SPEED}") if besides else 0.0
    return lambda name: make(name, figures), speed


def _figure(value: object, where: str, key: str) -> Any:
    """A length, m; or three numbers, (3,)."""
    if key.endswith("radius_m"):
        return number_of(value, where, key)
    entries = cast("list[object]", value) if isinstance(value, list) else []
    if len(entries) != 3:
        raise UserError(f"{where}: {key} must be three numbers, such as [0.5, 0.0, 0.3].")
    return np.array([number_of(one, where, key) for one in entries])


def _half_space(name: str, given: Mapping[str, Any]) -> HalfSpace:
    normal: FloatArray = given["normal"]
    length = float(np.sqrt(normal @ normal))
    if length == 0.0:
        raise UserError(f"The zone {name!r} has a normal of length 0: give a direction.")
    return HalfSpace(name, given["point_m"], normal / length)


def _box(name: str, given: Mapping[str, Any]) -> Box:
    turned = _turned(np.deg2rad(given.get("turned_deg", np.zeros(3))))
    return Box(name, given["centre_m"], turned, given["size_m"] / 2.0)


def _turned(angles: FloatArray) -> FloatArray:
    """The rotation (3, 3) by angles (3,), rad, about the x, then the y, then the z axis of the base."""
    rotation = np.eye(3)
    for axis, (cos, sin) in enumerate(zip(np.cos(angles), np.sin(angles), strict=True)):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[first, first] = turn[second, second] = cos
        turn[first, second], turn[second, first] = -sin, sin
        rotation = turn @ rotation
    return rotation


_Make = Callable[[str, Mapping[str, Any]], Obstacle]
_SHAPES: Final[dict[str, tuple[tuple[str, ...], tuple[str, ...], _Make]]] = {
    # name: (keys that it needs, keys that it may have, how it is made)
    "sphere": (("centre_m", "radius_m"), (), lambda name, of: Sphere(name, of["centre_m"], of["radius_m"])),
    "capsule": (
        ("start_m", "end_m", "radius_m"),
        (),
        lambda name, of: Capsule(name, of["start_m"], of["end_m"], of["radius_m"]),
    ),
    "box": (("centre_m", "size_m"), ("turned_deg",), _box),
    "half_space": (("point_m", "normal"), (), _half_space),
}
