"""What the paper prints in section 8.1, as data.

Percentages, R^2 and angles are comparable with ours as they stand. For lengths the paper states no unit and
no size of arm, so ours in metres are compared with them only as ratios: percent of PCA's, percent of the
VAE's.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from latentarm.core.types import Row

Key = tuple[str, str, str]  # task, model and measure, named as in our rows
Printed = tuple[float, float | None]  # mean and SD over 10 models; no SD where the paper prints none
RATIO_OF: Final = "vae"  # the model that the paper's lengths on the reach task are compared with

LENGTHS: Final[Mapping[Key, Printed]] = {
    ("sine", "pca", "controllability_m"): (0.90, None),
    ("sine", "ae", "controllability_m"): (0.94, 0.01),
    ("sine", "vae", "controllability_m"): (0.95, 0.01),
    ("sine", "cae", "controllability_m"): (0.05, 0.01),
    ("sine", "cvae", "controllability_m"): (0.10, 0.01),
    ("reach", "vae", "final_distance"): (0.57, 0.38),
    ("reach", "cvae", "final_distance"): (0.48, 0.5),
    ("reach", "vae", "path_length"): (5.1, 2.8),
    ("reach", "cvae", "path_length"): (3.1, 0.5),
}
"""Lengths under the names of our measures; theirs are in a unit that the paper does not state."""


def ratio_name(measure: str) -> str:
    """The measure that a length on the reach task becomes in percent of the VAE's."""
    return f"{measure}_percent_of_{RATIO_OF}"


def _percent_of(measure: str, baseline: str, ratio: str) -> dict[Key, Printed]:
    """The paper's lengths, mean and SD, in percent of the mean of one model's.

    This changes the unit alone. The baseline's own SD, which would widen the ratio's, is left out.
    """
    return {
        (task, model, ratio): (
            100.0 * mean / LENGTHS[task, baseline, measure][0],
            None if sd is None else 100.0 * sd / LENGTHS[task, baseline, measure][0],
        )
        for (task, model, name), (mean, sd) in LENGTHS.items()
        if name == measure
    }


PAPER: Final[Mapping[Key, Printed]] = {
    ("sine", "pca", "median_error_percent_of_pca"): (100.0, None),
    ("sine", "ae", "median_error_percent_of_pca"): (98.0, 0.6),
    ("sine", "vae", "median_error_percent_of_pca"): (100.0, 0.8),
    ("sine", "cae", "median_error_percent_of_pca"): (1.37, 1.2),
    ("sine", "cvae", "median_error_percent_of_pca"): (3.74, 0.4),
    ("sine", "pca", "r2"): (0.99, None),
    ("sine", "cae", "r2"): (0.94, 0.04),
    ("sine", "cvae", "r2"): (0.95, 0.01),
    ("rotate", "pca", "median_error_percent_of_pca"): (100.0, None),
    ("rotate", "ae", "median_error_percent_of_pca"): (28.7, 4.8),
    ("rotate", "vae", "median_error_percent_of_pca"): (38.0, 5.8),
    ("rotate", "cae", "median_error_percent_of_pca"): (0.65, 0.05),
    ("rotate", "cvae", "median_error_percent_of_pca"): (0.84, 0.07),
    ("rotate", "pca", "median_controllability_percent_of_pca"): (100.0, None),
    ("rotate", "ae", "median_controllability_percent_of_pca"): (56.8, 9.0),
    ("rotate", "vae", "median_controllability_percent_of_pca"): (71.5, 8.0),
    ("rotate", "cae", "median_controllability_percent_of_pca"): (5.4, 0.1),
    ("rotate", "cvae", "median_controllability_percent_of_pca"): (5.9, 0.1),
    # The paper prints "0.995 ± 0.004 for cVAE and 0.996 ± 0.002 for cVAE": the first is taken as it stands,
    # the second, which repeats the name, as the cAE that the sentence lacks.
    ("rotate", "cae", "r2"): (0.996, 0.002),
    ("rotate", "cvae", "r2"): (0.995, 0.004),
    ("circle", "ae", "disentanglement_deg"): (27.0, 20.0),
    ("circle", "vae", "disentanglement_deg"): (34.0, 15.0),
    ("circle", "cae", "disentanglement_deg"): (72.0, 9.0),
    ("circle", "cvae", "disentanglement_deg"): (74.0, 12.0),
    **_percent_of("controllability_m", "pca", "median_controllability_percent_of_pca"),
    **_percent_of("final_distance", RATIO_OF, ratio_name("final_distance")),
    **_percent_of("path_length", RATIO_OF, ratio_name("path_length")),
}
"""The paper's figures that ours can be compared with, in our units."""

MODELS_OF_THE_PAPER: Final = tuple(dict.fromkeys(model for _, model, _ in PAPER))
"""The models that the paper compares, in its order."""

OF_MEANS: Final[Mapping[str, str]] = {
    "median_error_percent_of_pca": "error_percent_of_pca",
    "median_controllability_percent_of_pca": "controllability_percent_of_pca",
}
"""The figures of means next to those of medians. The paper says means of its errors and distances; one test
episode in an odd posture can hold nearly all of a mean, so that ours are compared by medians over episodes,
and by means as well."""


def with_paper(rows: Sequence[Row]) -> list[Row]:
    """The rows of a study with the paper's figures where they can be compared.

    After them come the ratios to the VAE by which the lengths on the reach task can be compared.
    """
    return [_beside_paper(row) for row in (*rows, *_length_ratios(rows))]


def _beside_paper(row: Row) -> Row:
    printed = PAPER.get((row.task or "", row.model or "", row.measure))
    if printed is None:
        return row
    return replace(row, paper_mean=printed[0], paper_sd=printed[1])


def _length_ratios(rows: Sequence[Row]) -> list[Row]:
    """Mean lengths in percent of the VAE's mean, where the paper's lengths are compared so."""
    main = {(row.task, row.model, row.measure): row for row in rows}
    ratios: list[Row] = []
    for (task, _, measure), row in main.items():
        baseline = main.get((task, RATIO_OF, measure))
        if (task, RATIO_OF, ratio_name(measure)) not in PAPER or baseline is None:
            continue
        if row.mean is None or not baseline.mean:
            continue
        percent = 100.0 * row.mean / baseline.mean
        ratios.append(replace(row, measure=ratio_name(measure), unit="%", mean=percent, sd=None))
    return ratios
