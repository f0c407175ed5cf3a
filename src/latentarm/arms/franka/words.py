"""Errors of a Franka and of franky as sentences for a person."""

from collections.abc import Sequence
from typing import Final

NETWORK: Final = "use a network cable to the arm's own port, and a realtime kernel"
_LATE: Final = "communication_constraints_violation"
_ERRORS: Final = {
    _LATE: "too many of its messages came late or not at all",
    "joint_reflex": "it felt a collision: see what it touches",
    "cartesian_reflex": "it felt a collision: see what it touches",
    "joint_position_limits_violation": "a joint is past its end: move it back by hand in Desk",
    "self_collision_avoidance_violation": "it would have hit itself: push the other way",
    "joint_motion_generator_position_limits_violation": "it came to the end of a joint: push the other way",
    "cartesian_position_limits_violation": "it went past a wall set in Desk: move it or the wall",
    "power_limit_violation": "it would have exceeded its power limit: drive it more slowly",
    "tau_j_range_violation": "a torque sensor is out of its range: check payload_kg and what it touches",
}


def fault(errors: Sequence[str], said: str, network: str) -> str:
    """Why the arm has stopped, from the names of its errors, or else from libfranka's text.

    ``network`` is the advice where messages came late.
    """
    if not errors:
        return f"{plain(said)}."
    known = {**_ERRORS, _LATE: f"{_ERRORS[_LATE]}: {network}"}
    reasons = ", and ".join(known.get(name, name.replace("_", " ")) for name in errors)
    return f"{reasons[:1].upper()}{reasons[1:]}."


def plain(error: object) -> str:
    """Libfranka's text on one line, without its name and full stop."""
    return " ".join(str(error).split()).removeprefix("libfranka: ").rstrip(".")
