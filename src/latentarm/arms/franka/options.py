"""Options in the address of a Franka: ``franka://HOST?payload_kg=0.3&realtime=ignore``."""

from dataclasses import dataclass, fields
from typing import Any, Final, Literal, final

from latentarm.arms.address import ArmAddress
from latentarm.core.errors import UserError

Realtime = Literal["enforce", "ignore"]
_RANGES: Final = {
    "collision_torque_nm": (7, 1.0, 87.0),
    "collision_force_n": (3, 1.0, 100.0),
    "collision_moment_nm": (3, 1.0, 100.0),
    "payload_kg": (1, 0.0, 3.0),
    "payload_centre_m": (3, -0.5, 0.5),
    "payload_inertia_kg_m2": (3, 0.0, 1.0),
    "attachment_tip_m": (3, -0.5, 0.5),
}
"""Of an option: the number of its figures, the least and the most."""


@final
@dataclass(frozen=True)
class FrankaOptions:
    """Settings for connecting a Franka."""

    # (7,), external torque of a joint at which the arm stops, N m; these and the next two are from
    # libfranka's example of joint velocities
    collision_torque_nm: tuple[float, ...] = (20.0, 20.0, 18.0, 18.0, 16.0, 14.0, 12.0)
    # (3,), the same for forces along the axes of the base, N
    collision_force_n: tuple[float, ...] = (20.0, 20.0, 20.0)
    collision_moment_nm: tuple[float, ...] = (25.0, 25.0, 25.0)  # (3,), the same for moments about them, N m
    payload_kg: float = 0.0  # mass of the hand's load for the whole drive, kg
    payload_centre_m: tuple[float, ...] = (0.0, 0.0, 0.0)  # (3,), its centre of mass in the flange's frame, m
    # (3,), its moments of inertia about that centre, kg m²
    payload_inertia_kg_m2: tuple[float, ...] = (0.0, 0.0, 0.0)
    # (3,), tip of the attachment in the frame of the end-effector that Desk has set, m; the arm judges forces
    # there. None leaves the present setting.
    attachment_tip_m: tuple[float, ...] | None = None
    realtime: Realtime = "enforce"  # whether libfranka insists on a realtime kernel


def read_options(address: ArmAddress) -> FrankaOptions:
    """The options of an address."""
    if address.port is not None:
        raise UserError("--arm franka takes no port: a Franka always listens on 1337 and 1338.")
    given = address.only(*(field.name for field in fields(FrankaOptions)))
    realtime = given.get("realtime", FrankaOptions.realtime)
    if realtime not in ("enforce", "ignore"):
        raise UserError(f"--arm franka: realtime is enforce or ignore, not {realtime!r}.")
    figures: dict[str, Any] = {
        name: _figures(name, given[name], *_RANGES[name]) for name in _RANGES if name in given
    }
    if "payload_kg" in figures:
        (figures["payload_kg"],) = figures["payload_kg"]
    options = FrankaOptions(realtime=realtime, **figures)
    about = [name for name in ("payload_centre_m", "payload_inertia_kg_m2") if name in given]
    if about and not options.payload_kg:
        raise UserError(
            f"--arm franka: {about[0]} says nothing without payload_kg: give the payload's mass too."
        )
    return options


def _figures(name: str, text: str, count: int, least: float, most: float) -> tuple[float, ...]:
    """``count`` figures with commas between; for thresholds also one for all."""
    alike = name.startswith("collision_")
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if alike and len(values) == 1:
        values *= count
    if len(values) != count or not all(least <= value <= most for value in values):
        several = f"{count} numbers with commas between" if count > 1 else "a number"
        raise UserError(
            f"--arm franka: {name} is {'a number, or ' if alike else ''}{several}, from {least:g} to"
            f" {most:g}, not {text!r}."
        )
    return values
