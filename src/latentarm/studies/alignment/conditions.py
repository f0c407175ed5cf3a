"""The ways of finding an alignment that are compared, by the paper's names."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from latentarm.alignment.priors import NO_PRIORS, Priors

NO_ALIGN: Final = "No Align"
MANUAL: Final = "Manual Align"
WITHOUT_PRIORS: Final = "No Priors"
ALL_PRIORS: Final = "All Priors"
IDEAL: Final = "Ideal Align"

SINGLE_PRIORS: Final[Mapping[str, Priors]] = {
    "Proportional": replace(NO_PRIORS, proportional=Priors().proportional),
    "Reversible": replace(NO_PRIORS, reversible=Priors().reversible),
    "Consistent": replace(NO_PRIORS, consistent=Priors().consistent),
}
"""One prior at a time, with the weight that it has among all."""

LEARNED: Final[Mapping[str, Priors]] = {WITHOUT_PRIORS: NO_PRIORS, **SINGLE_PRIORS, ALL_PRIORS: Priors()}
"""Networks that are learned from a few answers, and the priors of each; all as `latentarm align` has them."""

FEW_ANSWERS: Final = (MANUAL, *LEARNED)
"""All that are given the same few answers."""

CONDITIONS: Final = (NO_ALIGN, *FEW_ANSWERS, IDEAL)
"""All, as tables and figures order them."""


def under(condition: str, noise: float) -> str:
    """How rows name a condition under a noise."""
    return f"{condition}, noise {noise:g}"
