"""The demonstrated directions in each place, which a motion there should keep to."""

from dataclasses import dataclass
from typing import Final, Self, final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.alignment.poses import pose_vectors
from latentarm.alignment.twists import motion_twists
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain

REGIONS: Final = 24
"""Regions that the demonstrated places are divided into, at most."""

FASTEST: Final = 0.99
"""This share of the demonstrated motions is slower than a fast one."""


@final
@dataclass(frozen=True, eq=False)
class Surroundings:
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
        from sklearn.cluster import KMeans  # takes a second, and only learning needs it

        place, twist = pose_vectors(chain, motions.start), motion_twists(chain, motions)
        regions = min(REGIONS, max(1, len(motions) // (2 * latent)))
        found = KMeans(regions, n_init="auto", random_state=0).fit(place)
        middles = np.asarray(found.cluster_centers_, dtype=np.float64)
        outside = np.stack([_outside(twist[found.labels_ == region], latent) for region in range(regions)])
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


def _outside(twist: FloatArray, latent: int) -> FloatArray:
    """The map (6 k, 6 k) of one region with motions (N, 6 k)."""
    spread, directions = np.linalg.eigh(twist.T @ twist)
    least = max(float(spread[-latent]), 1e-12)
    return (directions * (1.0 - np.minimum(spread / least, 1.0))) @ directions.T
