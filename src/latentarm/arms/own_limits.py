"""Compares the limits that a robot states with those that the arm itself keeps."""

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np

from latentarm.arms.real import Fact, FoundLimits
from latentarm.core.types import FloatArray
from latentarm.robots.limits import QUANTITIES, Quantity, Source
from latentarm.robots.robot import Robot

_DEG: Final = 180.0 / np.pi
_UNITS: Final[Mapping[Quantity, tuple[float, str, float, str]]] = {
    "position": (_DEG, "°", 1000.0, " mm"),
    "velocity": (_DEG, "°/s", 1000.0, " mm/s"),
    "acceleration": (1.0, " rad/s²", 1.0, " m/s²"),
    "jerk": (1.0, " rad/s³", 1.0, " m/s³"),
}
"""Of joints that turn, and of those that slide: the unit, and how many of it are one rad or m."""

_SOURCES: Final[Mapping[Source, str]] = {
    "model": "the model file",
    "manufacturer": "its maker's documents",
    "limits_file": "the limits file",
    "assumed": "nobody (assumed)",
}


def beyond(own: FoundLimits, robot: Robot) -> tuple[str, ...]:
    """Limits of the robot beyond the arm's own, where the arm would stop with a fault, a sentence each."""
    if not _fits(own, robot):
        return (
            f"The arm tells limits of {len(own.lower)} joints, and {robot.name} has {robot.dof}: choose the"
            " robot that the arm is.",
        )
    said: list[str] = []
    for name in ("lower", "upper", "velocity", "acceleration", "jerk"):
        ours, theirs = getattr(robot.limits, name), getattr(own, name)
        if theirs is None:
            continue
        joints = np.flatnonzero((theirs - ours if name == "lower" else ours - theirs) > own.rounding)
        if not len(joints):
            continue
        quantity: Quantity = "position" if name in ("lower", "upper") else name
        mine, arms = (_figures(quantity, one, robot)[joints[0]] for one in (ours, theirs))
        more = f" (and {len(joints) - 1} joints more)" if len(joints) > 1 else ""
        said.append(
            f"The {name} limit of {robot.joint_names[joints[0]]} is {mine} for {robot.name} and {arms} for"
            f" the arm{more}: choose the model that the arm is, or state the arm's own with --limits FILE."
        )
    return tuple(said)


def limit_facts(own: FoundLimits | None, robot: Robot) -> tuple[Fact, ...]:
    """The limits that the robot is driven by, in figures, and for each whether the arm itself confirms it."""
    return tuple(Fact(f"{one} limits", " ".join(_describe(one, own, robot))) for one in QUANTITIES)


def unconfirmed(own: FoundLimits | None, robot: Robot) -> tuple[str, ...]:
    """The limits that the arm does not confirm, a sentence, or nothing."""
    open_ones = [one for one in QUANTITIES if not np.isfinite(_own_figures(one, own, robot)).all()]
    if not open_ones:
        return ()
    return (
        f"The arm itself does not confirm the limits of {', '.join(open_ones)}, and nothing here would notice"
        " a wrong one: compare the figures above with those of its maker.",
    )


def _fits(own: FoundLimits, robot: Robot) -> bool:
    told = (own.lower, own.upper, own.velocity, own.acceleration, own.jerk)
    return all(one is None or one.shape == (robot.dof,) for one in told)


def _describe(quantity: Quantity, own: FoundLimits | None, robot: Robot) -> Iterator[str]:
    limits = robot.limits
    ours = (limits.lower, limits.upper) if quantity == "position" else (getattr(limits, quantity),)
    sources = dict.fromkeys(_SOURCES[one] for one in limits.sources[quantity])
    yield f"{_listed(quantity, ours, robot)}, by {' and '.join(sources)};"
    theirs = _own_figures(quantity, own, robot)
    if np.isfinite(theirs).any():
        yield f"the arm's own: {_listed(quantity, theirs, robot)}"
    else:
        yield "the arm states none, so nothing confirms this"


def _own_figures(quantity: Quantity, own: FoundLimits | None, robot: Robot) -> tuple[FloatArray, ...]:
    """The arm's own figures of a quantity, infinite where it states none."""
    none = np.full(robot.dof, np.inf)
    if own is None or not _fits(own, robot):
        return (-none, none) if quantity == "position" else (none,)
    if quantity == "position":
        return own.lower, own.upper
    told = getattr(own, quantity)
    return (none if told is None else told,)


def _listed(quantity: Quantity, figures: tuple[FloatArray, ...], robot: Robot) -> str:
    columns = zip(*(_figures(quantity, one, robot) for one in figures), strict=True)
    each = [" to ".join(column) for column in columns]
    if len(set(each)) == 1:
        return each[0]
    unit = _UNITS[quantity][1]
    alike = quantity != "position" and not robot.chain.slide.any()
    return ", ".join(one.removesuffix(unit) for one in each) + unit if alike else ", ".join(each)


def _figures(quantity: Quantity, figures: FloatArray, robot: Robot) -> list[str]:
    turns, turned, slides, slid = _UNITS[quantity]
    return [
        "none" if np.isinf(one) else f"{one * slides:.1f}{slid}" if sliding else f"{one * turns:.1f}{turned}"
        for one, sliding in zip(figures, robot.chain.slide, strict=True)
    ]
