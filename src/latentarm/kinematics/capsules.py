"""Capsules (segments with a radius) that ride on links, and distances between segments."""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from latentarm.kinematics.chain import Chain
from latentarm.types import FloatArray, IntArray

# A segment whose squared length is below this counts as a point; it also keeps divisors from zero.
_POINT = 1e-30


@final
@dataclass(frozen=True, eq=False)
class Capsules:
    """The shape of a robot for distances: K segments with a radius, each fixed to a link.

    Attributes:
        name: K names, for the person ("link 5", "hand").
        link: (K,), the link that carries each capsule, -1 for the base.
        start: (K, 3), one end of the segment in its link's frame, m.
        end: (K, 3), the other end, m; equal to ``start`` for a sphere.
        radius: (K,), m.
    """

    name: tuple[str, ...]
    link: IntArray
    start: FloatArray
    end: FloatArray
    radius: FloatArray

    def __len__(self) -> int:
        return len(self.name)

    def placed(self, chain: Chain, transforms: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Ends of all segments in the base frame.

        Args:
            chain: the robot's chain.
            transforms: (..., n, 4, 4), from its ``link_transforms``.

        Returns:
            Starts and ends, each (..., K, 3), m.
        """
        both = chain.points(transforms, self._links_twice, self._starts_and_ends)
        return both[..., : len(self), :], both[..., len(self) :, :]

    @cached_property
    def _links_twice(self) -> IntArray:
        return np.concatenate([self.link, self.link])

    @cached_property
    def _starts_and_ends(self) -> FloatArray:
        return np.concatenate([self.start, self.end])


def segment_distance(
    p1: FloatArray, q1: FloatArray, p2: FloatArray, q2: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Shortest distance between segments p1-q1 and p2-q2, exact, also where a segment is a point.

    Rounding errors are at most about 10 nm, where nearly parallel segments cross. After Ericson, Real-Time
    Collision Detection (2005), section 5.1.9.

    Args:
        p1: (..., 3), m.
        q1: (..., 3), m.
        p2: (..., 3), m.
        q2: (..., 3), m.

    Returns:
        Distance (...), m; the closest point on the first segment (..., 3); and on the second.
    """
    d1 = q1 - p1
    d2 = q2 - p2
    r = p1 - p2
    a = np.maximum(np.vecdot(d1, d1), _POINT)
    b = np.vecdot(d1, d2)
    c = np.vecdot(d1, r)
    e = np.vecdot(d2, d2)
    f = np.vecdot(d2, r)
    # The closest point of the infinite lines; where they are parallel any s will do.
    s = _clamped((b * f - c * e) / np.maximum(a * e - b * b, _POINT))
    t = _clamped((b * s + f) / np.maximum(e, _POINT))
    # Where t was clamped s must follow; elsewhere this changes nothing.
    s = _clamped((b * t - c) / a)
    on_first = p1 + s[..., None] * d1
    on_second = p2 + t[..., None] * d2
    gap = on_first - on_second
    return np.sqrt(np.vecdot(gap, gap)), on_first, on_second


def _clamped(value: FloatArray) -> FloatArray:
    """Clamped to [0, 1]; several times faster than ``np.clip`` on small arrays."""
    return np.minimum(np.maximum(value, 0.0), 1.0)
