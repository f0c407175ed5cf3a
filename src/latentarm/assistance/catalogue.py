"""The beliefs by name."""

from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.distance import DistanceBelief
from latentarm.assistance.maximum_entropy import MaximumEntropyBelief

BELIEFS: dict[str, type[BoltzmannBelief] | type[DistanceBelief] | type[MaximumEntropyBelief]] = {
    "boltzmann": BoltzmannBelief,
    "distance": DistanceBelief,
    "maximum_entropy": MaximumEntropyBelief,
}
"""Each is made with ``goals``, and if wanted ``period_s``, ``prior`` and ``floor``."""
