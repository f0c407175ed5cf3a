"""The check behind the filters: a command leaves only if the stop after it is proven safe."""

import math
from typing import final

import numpy as np

from latentarm.control.safety.brake import Brake
from latentarm.control.safety.filter import Situation
from latentarm.types import FloatArray

_NUMERIC_M = 1e-9
_NUMERIC_RAD = 1e-12


@final
class Path:
    """What a command leads to if nothing better follows: it lasts as long as it may, then the brake.

    The arm's joints move by ``way = v hold + v+ stop`` along a line that is straight but for a kink of
    ``v+ - v`` and the short settling of acceleration; ``stray`` bounds, joint by joint, how far the true
    path lies from the straight one.

    Args:
        velocity: (n,), the command, rad/s.
        brake: the stop that would follow it.
        hold_s: how long the command lasts, s.

    Attributes:
        way: (n,), rad.
        stray: (n,), rad.
        highest: (n,), how far the joint moves up at most, rad, zero or more.
        lowest: (n,), how far it moves down at most, rad, zero or less.
        kink: (n,), ``|v+ - v|``, rad/s.
        fastest: (n,), largest speed of each joint, rad/s.
        steady_s: for how long the speed may not have begun to fall, s.
        rate: from then on it falls at least on a line of this slope, as a share of itself per s.
    """

    __slots__ = ("fastest", "highest", "kink", "lowest", "rate", "steady_s", "stray", "way")

    def __init__(self, velocity: FloatArray, brake: Brake, hold_s: float) -> None:
        settled, settle_s = brake.settled, brake.settle_s
        stop_s = 0.5 * brake.ramp_s
        before = hold_s + settle_s
        self.way = velocity * before + settled * stop_s
        # Phase one leaves v for v+ within settle_s; against a straight line to the end of `way` the
        # difference v+ - v acts at most over settle_s and the stop.
        self.kink = np.abs(brake.kink)
        self.stray = self.kink * (settle_s + stop_s)
        # Each joint's velocity lies between v and v+ in phase one: counted with both, it is bounded by them.
        legs = np.stack([velocity, settled])
        times = np.array([before, settle_s + stop_s])
        self.highest = times @ np.maximum(legs, 0.0)
        self.lowest = times @ np.minimum(legs, 0.0)
        self.fastest = np.maximum(np.abs(velocity), np.abs(settled))
        self.steady_s = before + brake.onset_s
        self.rate = brake.rate


@final
class Guard:
    """Proves that a command and the stop after it break no limit, or names the limit.

    Induction: the command that left last was proven together with its brake. If the next one is
    proven too, it may leave; if not, the last proven brake goes on, whose path was checked already. So the
    arm can always stop in time, whatever a controller asks for and however wrong the shaping filters are.

    Nothing is sampled. All joint positions, distances and speeds are bounded over the *whole* path:

    - joint positions exactly, because each joint's way is known;
    - a distance h by Taylor's theorem, ``h(t) >= h + t dh·way - t² M / 2 - |dh|·stray`` over t in [0, 1]
      with ``M = |way|ᵀ R |way|`` (see `Body`). The right-hand side is concave up to its last term, so it is
      smallest at an end;
    - the speed of points by what turning links can add, ``|v|ᵀ R |v|`` m/s per s, while the brake does
      not yet take off more.

    Where the arm is already past a limit (it was put there by hand), a path is accepted that does
    not make that violation worse, so the operator can always back out.
    """

    def objection(self, velocity: FloatArray, brake: Brake, situation: Situation) -> str | None:
        """What the command or the stop after it would break, or None.

        Args:
            velocity: (n,), the command, rad/s.
            brake: the stop from it.
            situation: what is known at this tick.
        """
        path = Path(velocity, brake, situation.bounds.hold_s)
        if self._passes_joint_limits(path, situation):
            return "joint position"
        if self._too_fast(path, velocity, situation):
            return "link speed"
        if self._too_close(path, situation):
            return "clearance"
        if situation.bounds.config.workspace is not None and self._leaves_workspace(path, situation):
            return "workspace"
        return None

    @staticmethod
    def _passes_joint_limits(path: Path, situation: Situation) -> bool:
        bounds = situation.bounds
        above = situation.state + path.highest > np.maximum(bounds.upper, situation.state) + _NUMERIC_RAD
        below = situation.state + path.lowest < np.minimum(bounds.lower, situation.state) - _NUMERIC_RAD
        return bool(above.any() or below.any())

    @staticmethod
    def _too_fast(path: Path, velocity: FloatArray, situation: Situation) -> bool:
        body = situation.surroundings.body
        limit = situation.bounds.config.link_speed
        # At the start, and once acceleration has settled.
        speed = situation.placement.speeds(velocity) + body.surface_lever @ path.kink
        bend = body.surface_curvature @ path.fastest @ path.fastest
        grown = speed + bend * path.steady_s
        if float(grown.max(initial=0.0)) > limit:
            return True
        if not math.isfinite(path.rate):
            return False
        # While braking at rate r the speed is at most (1 - r t)(grown + bend t), which rises at first
        # only where bend > r grown.
        rising = bend > path.rate * grown
        if not rising.any():
            return False
        peak = (grown + bend / path.rate) ** 2 * path.rate / (4.0 * bend + 1e-300)
        return bool((peak[rising] > limit).any())

    @staticmethod
    def _too_close(path: Path, situation: Situation) -> bool:
        contacts = situation.contacts(path.fastest)
        if contacts is None:
            return False
        proximity = situation.surroundings.proximity
        way = np.abs(path.way)
        bend = proximity.curvature[contacts.pair] @ way @ way
        stray = proximity.lever[contacts.pair] @ path.stray
        least = contacts.height + contacts.row @ path.way - (0.5 * bend + stray)[:, None]
        allowed = np.minimum(situation.bounds.config.clearance, contacts.height)
        return bool((least < allowed - _NUMERIC_M).any())

    @staticmethod
    def _leaves_workspace(path: Path, situation: Situation) -> bool:
        workspace = situation.bounds.config.workspace
        if workspace is None:
            return False
        body, placement = situation.surroundings.body, situation.placement
        way = np.abs(path.way)
        lost = 0.5 * (body.point_curvature @ way @ way) + body.lever @ path.stray
        moved = np.tensordot(path.way, placement.jacobian[:, :3], axes=1).T
        points = placement.points
        low = points + moved - lost[:, None] < np.minimum(workspace.lower, points) - _NUMERIC_M
        high = points + moved + lost[:, None] > np.maximum(workspace.upper, points) + _NUMERIC_M
        return bool(low.any() or high.any())
