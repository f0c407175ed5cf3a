"""Which of a robot's capsules are worth watching for collisions with each other."""

from itertools import combinations

import numpy as np

from latentarm.kinematics.capsules import Capsules, segment_distance
from latentarm.kinematics.chain import Chain
from latentarm.robots.limits import JointLimits
from latentarm.types import BoolArray, FloatArray, IntArray

SAMPLES = 4000
"""Configurations that are sampled within the joint limits, always the same ones."""

TOUCHING_M = 0.02
"""Closer than this, two capsules count as touching."""

NEVER_CLOSER_M = 0.05
"""Pairs that never come closer than this in any sampled configuration are left out."""


def self_pairs(
    chain: Chain, capsules: Capsules, limits: JointLimits, home: FloatArray, excluded: BoolArray
) -> IntArray:
    """Pairs of capsules that may collide, as found by sampling.

    Left out are pairs on the same or on adjacent links, pairs of bodies that the model excludes,
    pairs that touch at home or in most sampled configurations (their capsules are coarser than the
    robot's shell there), and pairs that never come near each other.

    Args:
        chain: the robot's chain.
        capsules: its K capsules.
        limits: joint limits, within which configurations are sampled.
        home: (n,), rad.
        excluded: (K, K), pairs of capsules that the model excludes.

    Returns:
        (P, 2), indices of capsules.
    """
    pairs = np.array(
        [
            (i, j)
            for i, j in combinations(range(len(capsules)), 2)
            if not _adjacent(chain, int(capsules.link[i]), int(capsules.link[j])) and not excluded[i, j]
        ],
        dtype=np.int64,
    ).reshape(-1, 2)
    if not len(pairs):
        return pairs
    sampled = np.random.default_rng(0).uniform(limits.lower, limits.upper, size=(SAMPLES, chain.dof))
    gap = _gaps(chain, capsules, pairs, np.concatenate([home[None], sampled]))
    touching = gap < TOUCHING_M
    keep = ~touching[0] & (touching.mean(axis=0) <= 0.5) & (gap.min(axis=0) < NEVER_CLOSER_M)
    return pairs[keep]


def _adjacent(chain: Chain, first: int, second: int) -> bool:
    if first == second:
        return True
    return (first >= 0 and chain.parent[first] == second) or (second >= 0 and chain.parent[second] == first)


def _gaps(chain: Chain, capsules: Capsules, pairs: IntArray, q: FloatArray) -> FloatArray:
    """(N, P), distance between the surfaces of each pair at each configuration, m."""
    start, end = capsules.placed(chain, chain.link_transforms(q))
    i, j = pairs.T
    distance, _, _ = segment_distance(start[:, i], end[:, i], start[:, j], end[:, j])
    return distance - capsules.radius[i] - capsules.radius[j]
