"""The final check: a command is sent only if the stop after it is proven safe."""

from typing import final

import numpy as np

from latentarm.core.types import FloatArray, IntArray
from latentarm.safety.body import Placement
from latentarm.safety.brake import Brake
from latentarm.safety.filter import Situation
from latentarm.safety.limits import MAY_BEND_M
from latentarm.safety.small import any_nonzero, largest, smallest
from latentarm.safety.zone_distances import ZoneDistances
from latentarm.safety.zones import Zone, zone_filter_name

_NUMERIC_M = 1e-9
_NUMERIC_RAD = 1e-12
_NONE: IntArray = np.zeros(0, dtype=np.int64)


@final
class StoppingPath:
    """The path of a command with no successor: it is held for its full duration, then the brake follows.

    The arm's joints move by ``way = v hold + v+ stop`` along a line that is straight but for a kink of
    ``v+ - v`` and the short settling of acceleration; ``stray`` bounds, joint by joint, how far the true
    path lies from the straight one.

    ``hold_s`` is how long the command lasts, s.
    """

    __slots__ = ("after_s", "before_s", "brake", "fastest", "kink", "way")

    def __init__(self, velocity: FloatArray, brake: Brake, hold_s: float) -> None:
        self.brake = brake
        # For how long the arm moves at the command, phase one of the brake included, s
        self.before_s = hold_s + brake.settle_s
        self.after_s = 0.5 * brake.ramp_s  # the time at full speed that covers the rest, s
        self.kink = np.abs(brake.kink)  # (n,), ``|v+ - v|``, rad/s
        if brake.settle_s == 0.0:
            self.way = velocity * (self.before_s + self.after_s)  # (n,), rad
            self.fastest = np.abs(velocity)  # (n,), largest speed of each joint, rad/s
        else:
            self.way = velocity * self.before_s + brake.settled * self.after_s
            self.fastest = np.maximum(np.abs(velocity), np.abs(brake.settled))

    @property
    def stray(self) -> FloatArray:
        """(n,), rad.

        Phase one leaves v for v+ within its short time; against a straight line to the end of ``way`` the
        difference v+ - v acts at most during that and the rest.
        """
        return self.kink * (self.brake.settle_s + self.after_s)


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
      not yet take off more;
    - the speed in zones part by part: a part whose bound of the speed on the whole path is above a zone's
      limit must end that path farther from the zone than the clearance. No point goes farther than that
      bound times the time of the path, in which the brake counts half.

    Where the arm is already past a limit (it was put there by hand), a path is accepted that does
    not make that violation worse, so the operator can back out. A distance that is too small may shrink by
    `MAY_BEND_M` in the course of a path, stop included. In a zone every path that is slow enough is accepted,
    wherever it leads.
    """

    def objection(self, velocity: FloatArray, brake: Brake, situation: Situation) -> str | None:
        """The limit that the command (n,), rad/s, or the stop after it would break, or None."""
        path = StoppingPath(velocity, brake, situation.bounds.hold_s)
        if self._passes_joint_limits(velocity, path, situation):
            return "joint position"
        if self._too_fast(velocity, path, situation):
            return "link speed"
        if situation.bounds.config.zones:
            entered = self._too_fast_for_a_zone(velocity, path, situation)
            if entered is not None:
                return zone_filter_name(entered.name)
        if self._too_close(path, situation):
            return "clearance"
        if situation.bounds.config.workspace is not None and self._leaves_workspace(path, situation):
            return "workspace"
        return None

    @staticmethod
    def _passes_joint_limits(velocity: FloatArray, path: StoppingPath, situation: Situation) -> bool:
        # In phase one each joint's velocity lies between v and v+: counted with both, it is bounded by them.
        before_s, after_s = path.before_s, path.after_s + path.brake.settle_s
        if largest(path.fastest) * (before_s + after_s) < situation.nearest_limit:
            return False
        settled, room = path.brake.settled, situation.room
        highest = before_s * np.maximum(velocity, 0.0) + after_s * np.maximum(settled, 0.0)
        lowest = before_s * np.minimum(velocity, 0.0) + after_s * np.minimum(settled, 0.0)
        above = highest > np.maximum(room[1], 0.0) + _NUMERIC_RAD
        below = lowest < np.minimum(room[0], 0.0) - _NUMERIC_RAD
        return any_nonzero(above) or any_nonzero(below)

    def _too_fast(self, velocity: FloatArray, path: StoppingPath, situation: Situation) -> bool:
        nearby, drift = situation.nearby()
        if not self._exceeds(velocity, path, nearby, drift, situation.bounds.config.link_speed):
            return False
        # The placement was a few ticks old, which may be the only reason.
        here = situation.placement
        return here is nearby or self._exceeds(
            velocity, path, here, np.zeros_like(drift), situation.bounds.config.link_speed
        )

    @staticmethod
    def _exceeds(
        velocity: FloatArray, path: StoppingPath, placement: Placement, drift: FloatArray, limit: float
    ) -> bool:
        """Whether a point could be too fast, judged from a placement that is ``drift`` away."""
        body, brake = placement.body, path.brake
        steady_s = path.before_s + brake.onset_s
        bend = body.bent(path.fastest)
        grown = placement.speeds(velocity) + bend @ (steady_s * path.fastest + drift)
        if brake.settle_s > 0.0:
            # At the start, and once acceleration has settled.
            grown += body.surface_lever @ path.kink
        if largest(grown) > limit:
            return True
        # While braking at rate r the speed is at most (1 - r t)(grown + bend t). That rises at first only
        # where bend > r grown, and then to the parabola's top, which is at most bend / r.
        bends = bend @ path.fastest
        if largest(bends) <= brake.rate * limit:
            return False
        top = (grown + bends / brake.rate) ** 2 * brake.rate / (4.0 * np.maximum(bends, 1e-300))
        return bool((top[bends > brake.rate * grown] > limit).any())

    def _too_fast_for_a_zone(
        self, velocity: FloatArray, path: StoppingPath, situation: Situation
    ) -> Zone | None:
        """A zone that a part could reach into too fast, or None."""
        config, zones = situation.bounds.config, situation.surroundings.zones
        least, _ = situation.zone_distances()
        # No point is faster than link_speed on the way, as was proven before.
        farthest = config.link_speed * (path.before_s + path.brake.ramp_s)
        if smallest(least.ravel()) > config.clearance + farthest:
            return None
        nearby, drift = situation.nearby()
        suspects = self._entered(least, self._fastest(velocity, path, nearby, drift, zones), path, situation)
        if not suspects.size:
            return None
        # Placement and distances were a few ticks old, which may be the only reason.
        fastest = self._fastest(velocity, path, situation.placement, np.zeros_like(drift), zones)
        for zone in suspects.tolist():
            least[zone] = situation.zone_distances_now(zone)
        entered = self._entered(least, fastest, path, situation)
        return config.zones[entered[0]] if entered.size else None

    @staticmethod
    def _fastest(
        velocity: FloatArray,
        path: StoppingPath,
        placement: Placement,
        drift: FloatArray,
        zones: ZoneDistances,
    ) -> FloatArray:
        """(K + T,), bounds of the parts' speeds on the path, m/s, from a placement that is ``drift`` away."""
        body = placement.body
        way = (path.before_s + path.after_s) * path.fastest
        grown = placement.speeds(velocity) + body.bent(way + drift) @ path.fastest
        if path.brake.settle_s > 0.0:
            grown += body.surface_lever @ path.kink
        return zones.of_parts(grown)

    @staticmethod
    def _entered(away: FloatArray, speed: FloatArray, path: StoppingPath, situation: Situation) -> IntArray:
        """Indices of the zones that a part reaches into on the path, and is too fast for."""
        near = away - (path.before_s + path.after_s) * speed <= situation.bounds.config.clearance
        harmful = (speed > situation.surroundings.zones.limit) & near
        return np.flatnonzero(harmful.any(axis=1)) if any_nonzero(harmful.ravel()) else _NONE

    @staticmethod
    def _too_close(path: StoppingPath, situation: Situation) -> bool:
        proximity, clearance = situation.surroundings.proximity, situation.bounds.config.clearance
        contacts = situation.contacts(path.fastest)
        if not contacts.pair.size:
            return False
        stray = (proximity.lever[contacts.pair] @ path.stray)[:, None]
        after = proximity.heights(contacts, path.way) - stray
        if not contacts.fresh:
            now = proximity.heights(contacts, np.zeros_like(path.way)) - stray
            if smallest(np.minimum(now, after).ravel()) >= clearance:
                return False
            # The contacts were a few ticks old, which may be the only reason.
            contacts = situation.contacts_now()
            if not contacts.pair.size:
                return False
            stray = (proximity.lever[contacts.pair] @ path.stray)[:, None]
            after = proximity.heights(contacts, path.way) - stray
        change = contacts.row @ path.way - stray
        return _worsens(contacts.height, change, contacts.height + change - after, clearance)

    @staticmethod
    def _leaves_workspace(path: StoppingPath, situation: Situation) -> bool:
        workspace = situation.bounds.config.workspace
        if workspace is None:
            return False
        body, placement = situation.surroundings.body, situation.placement
        way = np.abs(path.way)
        bend, stray = 0.5 * (body.point_curvature @ way @ way)[:, None], (body.lever @ path.stray)[:, None]
        moved = np.tensordot(path.way, placement.jacobian[:, :3], axes=1).T
        return any(
            _worsens(side * placement.points, side * moved - stray, bend, side * corner)
            for side, corner in ((1.0, workspace.lower), (-1.0, workspace.upper))
        )


def _worsens(now: FloatArray, change: FloatArray, bend: FloatArray, least: FloatArray | float) -> bool:
    """Whether a path takes distances, m, below the least, or those below it already lower.

    Unless straight ``change`` lowers those, their ``bend`` may, by `MAY_BEND_M`: between two things that are
    both too near, every way out bends towards one of them.
    """
    nearer = now + change < np.minimum(least, now) - _NUMERIC_M
    return any_nonzero((nearer | (now + change - bend < np.minimum(least, now - MAY_BEND_M))).ravel())
