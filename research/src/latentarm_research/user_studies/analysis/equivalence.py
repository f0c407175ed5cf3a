"""Two one-sided tests: that a difference is too small to matter (Schuirmann 1987)."""

from typing import cast

from latentarm.core.types import FloatArray
from latentarm_research.studies.statistics import spreads


def equivalence(differences: FloatArray, margin: float) -> float | None:
    """P of the claim that differences (n,) of people's means lie within ±margin on average.

    Returns:
        The larger p of the two one-sided tests; None for fewer than two people, or without spread.
    """
    from statsmodels.stats.weightstats import DescrStatsW  # takes a second

    if not spreads(differences):
        return None
    return float(cast(float, DescrStatsW(differences).ttost_mean(-margin, margin)[0]))
