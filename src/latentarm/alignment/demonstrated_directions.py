"""The demonstrated directions in each place, which a motion there should keep to."""

from dataclasses import dataclass
from typing import Final, Self, final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.alignment.poses import pose_vectors
from latentarm.alignment.twists import motion_twists
from latentarm.core.types import FloatArray, IntArray
from latentarm.robots.kinematics.chain import Chain

REGIONS: Final = 24  # regions that the demonstrated places are divided into, at most
SETTLED: Final = 1e-4
"""Means of clusters that all together move by less than this have settled, as a share of the variance."""

FASTEST: Final = 0.99  # this share of the demonstrated motions is slower than a fast one


@final
@dataclass(frozen=True, eq=False)
class DemonstratedDirections:
    """Directions of demonstrated motions by place."""

    place: FloatArray  # (K, 12 k), the middles of regions, see `pose_vectors`, m
    outside: FloatArray  # (K, 6 k, 6 k), symmetric; removes the demonstrated directions from a twist
    width_m: float
    fast_m_s: float  # the speed that hardly any demonstrated motion exceeds, m/s

    @classmethod
    def of_motions(cls, motions: Motions, chain: Chain, latent: int) -> Self:
        """Divide the places into regions (k-means), and take the d main directions in each.

        A direction counts as outside by how much less it was demonstrated than the d-th most.
        """
        place, twist = pose_vectors(chain, motions.start), motion_twists(chain, motions)
        regions = min(REGIONS, max(1, len(motions) // (2 * latent)))
        middles, nearest = _clusters(place, regions)
        outside = np.stack([_outside(twist[nearest == region], latent) for region in range(regions)])
        apart = np.linalg.norm(middles[:, None] - middles, axis=-1) + np.diag(np.full(regions, np.inf))
        width = float(np.median(apart.min(axis=1))) if regions > 1 else 1.0
        speed = float(np.quantile(np.linalg.norm(twist, axis=-1), FASTEST))
        return cls(middles, outside, max(width, 1e-3), max(speed, 1e-6))

    def __call__(self, place: FloatArray) -> FloatArray:
        """Maps (..., 6 k, 6 k) that remove the demonstrated directions from twists at places (..., 12 k)."""
        near = np.square(place[..., None, :] - self.place).sum(axis=-1)
        weight = np.exp(-0.5 * (near - near.min(axis=-1, keepdims=True)) / self.width_m**2)
        weight /= weight.sum(axis=-1, keepdims=True)
        flat = weight @ self.outside.reshape(len(self.outside), -1)
        return flat.reshape(*weight.shape[:-1], *self.outside.shape[1:])

    def planes(self, latent: int) -> FloatArray:
        """The d main directions of each region, (K, 6 k, d)."""
        return np.linalg.eigh(self.outside)[1][..., :latent]


def _clusters(points: FloatArray, count: int) -> tuple[FloatArray, IntArray]:
    """Means (K, k) of clusters of points (N, k), and the cluster of each point, (N,).

    Lloyd's k-means from the start of greedy k-means++ (Arthur and Vassilvitskii 2007), with the draws of
    scikit-learn's ``KMeans(count, random_state=0)``, so that the clusters are the same.
    """
    rng, centred = np.random.RandomState(0), points - points.mean(axis=0)
    tries, many = 2 + int(np.log(count)), len(points)
    means = centred[rng.choice(many, 1, p=np.full(many, 1 / many))]
    near = _squared_distances(centred, means)[:, 0]
    while len(means) < count:
        drawn = np.searchsorted(np.cumsum(near), rng.uniform(size=tries) * near.sum()).clip(max=many - 1)
        nearer = np.minimum(near[:, None], _squared_distances(centred, centred[drawn]))
        best = nearer.sum(axis=0).argmin()
        means, near = np.concatenate([means, centred[drawn[best], None]]), nearer[:, best]
    shift = np.inf
    while shift > SETTLED * points.var(axis=0).mean():
        nearest, before = _squared_distances(centred, means).argmin(axis=1), means
        means = np.stack(
            [centred[nearest == one].mean(axis=0) if one in nearest else means[one] for one in range(count)]
        )
        shift = np.square(means - before).sum()
    nearest = _squared_distances(centred, means).argmin(axis=1)
    return means + points.mean(axis=0), nearest


def _squared_distances(points: FloatArray, means: FloatArray) -> FloatArray:
    """(N, K) of points (N, k) and means (K, k)."""
    return np.square(points[:, None] - means).sum(axis=-1)


def _outside(twist: FloatArray, latent: int) -> FloatArray:
    """The map (6 k, 6 k) of one region with motions (N, 6 k)."""
    spread, directions = np.linalg.eigh(twist.T @ twist)
    least = max(float(spread[-latent]), 1e-12)
    return (directions * (1.0 - np.minimum(spread / least, 1.0))) @ directions.T
