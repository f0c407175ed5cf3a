"""What the arm is doing, said to people."""

from collections.abc import Sequence
from typing import Final

from latentarm.types import Stop
from latentarm.web.protocol.channel import Phase

_HELD_BACK: Final = {
    "clearance": "it is close to something",
    "freshness": "the connection falters",
    "workspace": "it is at the edge of where it may be",
    "joint position": "a joint is near its limit",
}
"""What people should know of the filters; the others work all the time."""


def why(phase: Phase, stopped: Stop | None, limited_by: Sequence[str]) -> str:
    """One sentence or two on what the arm is doing, and what to do next.

    Args:
        phase: of the arm.
        stopped: why it may not move, or None where it may.
        limited_by: names of the safety filters at work.
    """
    reason = "" if stopped is None else stopped.reason
    match phase:
        case "ready":
            return "Enabled: push to move."
        case "moving":
            held = [_HELD_BACK[name] for name in limited_by if name in _HELD_BACK]
            return f"Moving slower than you ask: {held[0]}." if held else "Moving."
        case "stopping":
            return f"Stopping. {reason}"
        case "neutral_needed":
            return f"{reason} Let go of the stick, then press Enable."
        case "disengaged":
            return f"{reason} Press Enable to move the arm."
