"""The paths that a simulated person leads the tools along, step by step."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray

STEP_S: Final = 0.01
"""dt of the transition ``s' = s + a dt``, s: one period of the 100 Hz control loop. The paper leaves it open;
it is short enough for a step along the tightest curve to turn by less than three degrees, so that figures
speak of the task's shape and not of the step's length."""

STROKE_S: Final = 0.4
"""How long a joint speed is kept, s: as long as from one recorded pair to the next."""

DIFFERENCE: Final = 1e-5
"""Of a curve's parameter, for its numeric derivative: far above rounding, far below any bend."""


class Path(ABC):
    """The paths of E demonstrations, which advance together."""

    now: FloatArray  # (E, k), where the task coordinates should be now, m and rad

    @abstractmethod
    def advance(self, jacobian: FloatArray) -> None:
        """Go on by `STEP_S`, with the task's Jacobians (E, k, n) in the present postures."""


@final
class Timed(Path):
    """Paths that depend on time alone: ``points`` leads from time, s, to the task coordinates (E, k)."""

    def __init__(self, points: Callable[[float], FloatArray]) -> None:
        self._points, self._step = points, 0
        self.now = points(0.0)

    def advance(self, jacobian: FloatArray) -> None:
        """See `Path`."""
        self._step += 1
        self.now = self._points(self._step * STEP_S)


@final
class Paced(Path):
    """Paths along curves in strokes, each at a joint speed of its own, turning back at the curve's ends.

    The joint speeds are normal about zero and independent of everything else. So at every place and in every
    posture all of them occur alike, forth and back, and an action's size does not tell its direction. That
    is what keeps a decoder that sees z alone from guessing the place.
    """

    def __init__(
        self,
        curve: Callable[[FloatArray], FloatArray],  # from parameters (E,) to task coordinates (E, k)
        begin: FloatArray,  # (E,), the parameters at the start
        ends: tuple[float, float],  # least and largest parameter
        speed_rad_s: float,  # SD of the joint speed ‖a‖
        duration_s: float,  # how long the paths are
        rng: np.random.Generator,  # draws the speeds
    ) -> None:
        strokes = int(np.ceil(duration_s / STROKE_S)) + 1
        self._speed = rng.normal(0.0, speed_rad_s, (strokes, len(begin)))
        self._curve, self._at, self._ends, self._step = curve, begin, ends, 0
        self._sign = np.ones(len(begin))
        self.now = curve(begin)

    def advance(self, jacobian: FloatArray) -> None:
        """See `Path`."""
        stroke = self._step // round(STROKE_S / STEP_S)
        ahead = (self._curve(self._at + DIFFERENCE) - self._curve(self._at - DIFFERENCE)) / (2 * DIFFERENCE)
        cost = np.linalg.norm(least_norm(jacobian, ahead), axis=-1)
        low, high = self._ends
        at = self._at + STEP_S * self._sign * self._speed[stroke] / cost
        turned = np.where(at < low, 2 * low - at, np.where(at > high, 2 * high - at, at))
        self._sign = np.where(turned == at, self._sign, -self._sign)
        self._at = np.clip(turned, low, high)
        self._step += 1
        self.now = self._curve(self._at)


def least_norm(jacobian: FloatArray, rate: FloatArray) -> FloatArray:
    """``J^+ x``: (..., k, n) and (..., k) to (..., n), for Jacobians of full rank."""
    transposed = jacobian.mT
    return (transposed @ np.linalg.solve(jacobian @ transposed, rate[..., None]))[..., 0]
