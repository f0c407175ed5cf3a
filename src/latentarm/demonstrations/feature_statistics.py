"""Statistics of every feature, per episode and over the dataset, in the form of ``meta/stats.json``."""

from collections.abc import Mapping
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray

QUANTILES: Final = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}
MEASURES: Final = ("min", "max", "mean", "std", "count", *QUANTILES)


def episode_statistics(columns: Mapping[str, FloatArray]) -> dict[str, dict[str, FloatArray]]:
    """For each feature, (T, k), and each of `MEASURES` an array (k,); ``count`` is (1,)."""
    return {
        name: {
            "min": values.min(axis=0),
            "max": values.max(axis=0),
            "mean": values.mean(axis=0),
            "std": values.std(axis=0),
            "count": np.array([float(len(values))]),
            **dict(zip(QUANTILES, np.quantile(values, list(QUANTILES.values()), axis=0), strict=True)),
        }
        for name, values in columns.items()
    }


def pooled(measures: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Pool the episodes' measures (E, k) of one feature into (k,), without their samples.

    Minimum, maximum, mean and deviation are exact; quantiles are means of the episodes' quantiles weighted by
    samples, as by other writers of the layout.
    """
    count = measures["count"]
    weight = count / count.sum()
    mean = (weight * measures["mean"]).sum(axis=0)
    variance = (weight * (measures["std"] ** 2 + (measures["mean"] - mean) ** 2)).sum(axis=0)
    return {
        "min": measures["min"].min(axis=0),
        "max": measures["max"].max(axis=0),
        "mean": mean,
        "std": np.sqrt(variance),
        "count": count.sum(axis=0),
        **{name: (weight * measures[name]).sum(axis=0) for name in QUANTILES},
    }
