"""Named zones in which the arm is slow: about a face, over a table, about a person's body."""

import math
from dataclasses import dataclass
from typing import Final, cast, final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.names import clean_name, same_name
from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.safety.obstacles import checked_shape, is_number

MOST_ZONES: Final = 8
SLOWEST_M_PER_S: Final = 0.01  # no zone allows less: the way out of it would take minutes
_FASTEST_M_PER_S: Final = 5.0
_FILTER: Final = "zone "


@final
@dataclass(frozen=True, eq=False)
class Zone:
    """A solid in which no part of the arm moves faster than a speed of its own; the arm may go in and out.

    The names are free. The page has words for three: ``face`` (a ball or a box at the head), ``table`` (a
    slab over the table's top) and ``self`` (the person's body or wheelchair). Raises UserError where the
    shape is no solid, its name is not one, or the speed is not a number in its range.
    """

    shape: Obstacle  # the solid, in the base frame, with the zone's name
    speed: float  # the largest speed of any point of a part that reaches into the zone, m/s

    def __post_init__(self) -> None:
        if not isinstance(self.shape, Obstacle):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise UserError(f"{self.shape!r} is not a zone's shape: use HalfSpace, Sphere, Capsule or Box.")
        what, speed = f"The zone {self.shape.name!r}", cast("object", self.speed)
        check_name(self.shape.name, what)
        object.__setattr__(self, "shape", checked_shape(self.shape, what))
        if not is_number(speed):
            raise UserError(f"{what} needs a number of m/s as its speed, not {speed!r}.")
        if not (math.isfinite(speed) and SLOWEST_M_PER_S <= speed <= _FASTEST_M_PER_S):
            raise UserError(
                f"{what} allows {speed:g} m/s: it must be at least {SLOWEST_M_PER_S:g} and at most"
                f" {_FASTEST_M_PER_S:g} m/s."
            )
        object.__setattr__(self, "speed", float(speed))

    @property
    def name(self) -> str:
        """The zone's name for people."""
        return self.shape.name


def check_name(name: str, what: str) -> None:
    """Refuse a name that a page could not list; ``what`` is the subject of the message.

    Raises UserError where it has commas, spaces around it, or characters that cannot be shown.
    """
    if "," in name or clean_name(name) != name:
        raise UserError(f"{what} needs another name: without commas, and without spaces around it.")


def checked_zones(value: object) -> tuple[Zone, ...]:
    """The zones as a tuple; UserError where these are no zones, too many, or two have the same name."""
    if not isinstance(value, tuple | list):
        raise UserError("The safety limit zones must be a tuple of zones.")
    zones: list[Zone] = []
    for item in cast("tuple[object, ...]", value):
        if not isinstance(item, Zone):
            raise UserError(f"The safety limit zones must hold zones, not {item!r}: use Zone.")
        if any(same_name(item.name, other.name) for other in zones):
            raise UserError(f"Two zones are called {item.name!r}: give each a name of its own.")
        zones.append(item)
    if len(zones) > MOST_ZONES:
        raise UserError(f"There are {len(zones)} zones: {MOST_ZONES} at most are kept in time.")
    return tuple(zones)


def zone_filter_name(zone: str) -> str:
    """The name of a zone's filter among those that limit a command."""
    return f"{_FILTER}{zone}"


def zone_of_filter(name: str) -> str | None:
    """The zone's name, or None where a filter is not a zone's."""
    return name.removeprefix(_FILTER) if name.startswith(_FILTER) else None
