"""Limits that a participant's device must meet before they drive."""

from dataclasses import dataclass
from typing import Final, Literal, final

from latentarm.core.errors import UserError

InputKind = Literal["mouse", "touch", "pen", "keyboard", "gamepad"]
MOST_MS: Final = 500.0  # a simulated arm waits 600 ms for an input, and the page and the arm take some of it
MOST_PX: Final = 4000


@final
@dataclass(frozen=True)
class DeviceLimits:
    """Limits of a study. WebGL 2, which draws the arm, is always required."""

    round_trip_ms: float = 400.0
    """Longest median time of a message to the server and back, 1 to 500."""
    jitter_ms: float = 150.0
    """Longest time by which the 95th percentile of these is above their median, 1 to 500."""
    width_px: int = 320
    """Least width of the window in CSS pixels, 1 to 4000."""
    height_px: int = 320
    """Least height of the window in CSS pixels, 1 to 4000."""
    needs: tuple[InputKind, ...] = ()
    """Input devices, one of which the person must use during the check; empty for any."""

    def __post_init__(self) -> None:
        for name, value, most in (
            ("round_trip_ms", self.round_trip_ms, MOST_MS),
            ("jitter_ms", self.jitter_ms, MOST_MS),
            ("width_px", self.width_px, MOST_PX),
            ("height_px", self.height_px, MOST_PX),
        ):
            if not 1 <= value <= most:
                raise UserError(f"{name} of a device must be from 1 to {most:g}, not {value:g}.")
