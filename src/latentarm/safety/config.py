"""The limits that a person sets, checked like any other input."""

import math
from dataclasses import dataclass, fields
from typing import cast, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.safety.obstacles import as_array, checked_obstacle, is_number
from latentarm.safety.zones import Zone, checked_zones


@final
@dataclass(frozen=True, eq=False)
class Workspace:
    """A box, along the axes of the base frame, that the tool and every link point must stay in.

    Raises UserError where a bound is not a finite number, or lower is not below upper.
    """

    lower: FloatArray  # (3,), m
    upper: FloatArray  # (3,), m

    def __post_init__(self) -> None:
        for name in ("lower", "upper"):
            given = as_array(getattr(self, name))
            if given.shape != (3,) or given.dtype.kind not in "iuf" or not np.isfinite(given).all():
                raise UserError(f"The workspace's {name} corner must be three finite numbers in m.")
            value = given.astype(np.float64)
            value.flags.writeable = False
            object.__setattr__(self, name, value)
        if not (self.lower < self.upper).all():
            raise UserError("The workspace's lower corner must be below its upper corner on every axis.")


@final
@dataclass(frozen=True)
class SafetyConfig:
    """How fast and how close the arm may go; far below what its hardware can do.

    Figures that need no robot are checked here; `latentarm.safety.limits.Bounds` checks the
    rest against the hardware when a robot and the loop's period are known.

    Raises UserError where a figure is not a number, not finite, or out of its range.
    """

    joint_speed: float = 0.5  # largest speed of a joint, rad/s
    link_speed: float = 0.25  # largest speed of any point of the arm, m/s
    acceleration_fraction: float = 0.2  # share of the hardware's acceleration for ordinary motion, in (0, 1]
    jerk_fraction: float = 0.2  # share of the hardware's jerk for ordinary motion, in (0, 1]
    # Share of the hardware's acceleration and jerk for slowing down once the person has let go, in (0, 1]
    release_fraction: float = 0.2
    # Share of the hardware's acceleration and jerk for a stop, in (0, 1]. A stop is ramped too, only harder.
    stop_fraction: float = 0.8
    joint_margin: float = 0.1  # distance kept from the hardware's joint limits, rad
    slide_margin: float = 0.01  # the same where a joint slides, m; a limits file may state others
    clearance: float = 0.02  # distance kept from obstacles and from the arm itself, m
    # How long the last fresh input counts, s. With the stopping ramp and one period of the loop it must fit
    # into 0.15 s.
    input_timeout_s: float = 0.04
    # For how much longer fresh inputs may be missing before the arm has to be enabled again, s. In between it
    # slows down just as for a stop, and goes on if inputs come back. With input_timeout_s it must fit into
    # 0.15 s.
    input_grace_s: float = 0.0
    dead_zone: float = 0.02  # inputs no longer than this are zero, in [0, 0.5]
    # For how many periods of the loop one command lasts; past that the arm stops by itself. At least 1.5, so
    # that an ordinary delay does not stop it.
    command_periods: float = 2.5
    # How many periods of the loop old the newest reading of the arm may be; less where the stop after it
    # would not be over 0.15 s after that reading. At least 1.
    reading_periods: float = 5.0
    # A reading that lies farther from the one before it than the joint can move in the time between them, by
    # more than this, stops the arm, rad (m where a joint slides, here and below)
    jump_margin: float = 0.03
    # A reading that repeats exactly while its joint was commanded to move farther than this stops the arm,
    # rad
    freeze_margin: float = 0.01
    # How far a joint's displacement may differ from the commanded one within the last following_window_s,
    # beyond what lag explains, rad
    following_error: float = 0.05
    # The arm's own lag behind its commands, s. Readings may be five periods of the loop late on top of it. A
    # longer lag delays the detection of faults by as much.
    following_lag_s: float = 0.05
    # Time over which displacements are compared, s. A longer window detects slower joints that do not follow,
    # but mistakes drift that accumulates over it for an error.
    following_window_s: float = 1.0
    gripper_speed: float = 0.05  # fastest change of a gripper's opening, m/s
    gripper_force: float = 20.0  # largest force with which a gripper's fingers press together, N
    # Force of the tool against which the arm does not go on, N; of arms that estimate external torques
    tool_force: float = 30.0
    workspace: Workspace | None = None  # where the arm may be, or None for anywhere
    obstacles: tuple[Obstacle, ...] = ()  # what the arm must keep clear of
    # Where the arm is slower than link_speed; that begins where a part of it is nearer to a zone than
    # clearance
    zones: tuple[Zone, ...] = ()

    def __post_init__(self) -> None:
        for field in fields(self):
            if field.name in _RANGES:
                object.__setattr__(self, field.name, _figure(field.name, getattr(self, field.name)))
        if self.stop_fraction < max(self.acceleration_fraction, self.jerk_fraction, self.release_fraction):
            raise UserError(
                "The safety limit stop_fraction must be at least acceleration_fraction, jerk_fraction and"
                " release_fraction: a stop may not be softer than ordinary motion."
            )
        if self.workspace is not None and not isinstance(self.workspace, Workspace):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise UserError("The safety limit workspace must be a Workspace, or None for anywhere.")
        object.__setattr__(self, "obstacles", _checked_obstacles(self.obstacles))
        object.__setattr__(self, "zones", checked_zones(self.zones))


_RANGES: dict[str, tuple[float, float, str]] = {
    # name: (above or at, at most, unit); a lowest figure of 0 is itself refused except where noted below
    "joint_speed": (0.0, 10.0, "rad/s"),
    "link_speed": (0.0, 5.0, "m/s"),
    "acceleration_fraction": (0.0, 1.0, "of the hardware's"),
    "jerk_fraction": (0.0, 1.0, "of the hardware's"),
    "release_fraction": (0.0, 1.0, "of the hardware's"),
    "stop_fraction": (0.0, 1.0, "of the hardware's"),
    "joint_margin": (0.0, 1.0, "rad"),
    "slide_margin": (0.0, 1.0, "m"),
    "clearance": (0.0, 0.5, "m"),
    "input_timeout_s": (0.0, 0.15, "s"),
    "input_grace_s": (0.0, 0.15, "s"),
    "dead_zone": (0.0, 0.5, "of full input"),
    "command_periods": (1.5, 10.0, "periods"),
    "reading_periods": (1.0, 50.0, "periods"),
    "jump_margin": (0.0, 0.5, "rad"),
    "freeze_margin": (0.0, 0.5, "rad"),
    "following_error": (0.0, 0.5, "rad"),
    "following_lag_s": (0.0, 0.5, "s"),
    "following_window_s": (0.0, 10.0, "s"),
    "gripper_speed": (0.0, 1.0, "m/s"),
    "gripper_force": (0.0, 500.0, "N"),
    "tool_force": (0.0, 500.0, "N"),
}
_MAY_TOUCH = ("input_grace_s", "dead_zone", "command_periods", "reading_periods")


def _figure(name: str, value: object) -> float:
    """The figure as a float inside its range, or a `UserError` that names it."""
    lowest, highest, unit = _RANGES[name]
    if not is_number(value):
        raise UserError(f"The safety limit {name} must be a number, not {value!r}.")
    try:
        figure = float(value)
    except OverflowError:
        figure = math.inf
    inside = lowest <= figure <= highest if name in _MAY_TOUCH else lowest < figure <= highest
    if not math.isfinite(figure) or not inside:
        bounds = f"{'at least' if name in _MAY_TOUCH else 'above'} {lowest:g} and at most {highest:g} {unit}"
        raise UserError(f"The safety limit {name} is {figure:g}: it must be {bounds}.")
    return figure


def _checked_obstacles(value: object) -> tuple[Obstacle, ...]:
    if not isinstance(value, tuple | list):
        raise UserError("The safety limit obstacles must be a tuple of obstacles.")
    return tuple(checked_obstacle(item) for item in cast("tuple[object, ...]", value))
