"""The arm's clock beside this computer's: by the arm's clock, commands end."""

import time
from typing import TYPE_CHECKING, Final, final

if TYPE_CHECKING:
    import franky

SPAN_S: Final = 2.0  # over which the clocks are compared while the arm is driven
_LOOKS_S: Final = (0.3, 0.7, 2.0)  # and before: longer and longer, as a busy computer may be late itself
_LATE_S: Final = 0.1  # a span in which this computer was later than this tells nothing of the arm
_LEAST, _MOST = 0.8, 1.25  # s of the arm in one of ours


def strange(rate: float) -> str:
    """Why an arm whose clock passes so many seconds in one of ours is not driven, or ""."""
    if _LEAST <= rate <= _MOST:
        return ""
    return (
        f"The arm's clock passes {rate:.3f} s in each second of this computer, so its commands would end"
        f" {'late' if rate < 1.0 else 'early'}: restart its controller (a simulated arm needs a computer that"
        " keeps up with it)."
    )


def measured_rate(arm: "franky.Robot") -> float:
    """Seconds of the arm in one of ours."""
    rate, began_s, arm_s = 0.0, time.monotonic(), arm.state.time.to_sec()
    for look_s in _LOOKS_S:
        time.sleep(look_s)
        rate = (arm.state.time.to_sec() - arm_s) / (time.monotonic() - began_s)
        if not strange(rate):
            break
    return rate


@final
class Pace:
    """Compares the clocks state by state."""

    def __init__(self) -> None:
        self._since: tuple[float, float] | None = None
        self._last_s = 0.0

    def strange(self, now_s: float, arm_s: float) -> str:
        """Why driving must end after a state of this time on both clocks, or ""; see `strange`."""
        if self._since is None or now_s - self._last_s > _LATE_S:
            self._since = now_s, arm_s
        self._last_s = now_s
        passed_s = now_s - self._since[0]
        if passed_s < SPAN_S:
            return ""
        rate = (arm_s - self._since[1]) / passed_s
        self._since = now_s, arm_s
        return strange(rate)
