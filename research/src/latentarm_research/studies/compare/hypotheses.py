"""H1 of section 8.1 on recorded demonstrations: do models that see the context reconstruct actions better?

The paper tests it on simulated tasks that were made so that the context decides. Here each model that sees
the context is compared with the same one that does not, on the same folds, once through the encoder
networks and once with the nearest inputs: a test for each pair, dataset, noise and way of encoding, paired
over folds, of the means over seeds. One family per way of encoding.
"""

from collections.abc import Sequence
from itertools import product
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.studies.claims import Claim, Tested, corrected_by_family
from latentarm_research.studies.compare.cell import FoldResult
from latentarm_research.studies.compare.tables import condition
from latentarm_research.studies.statistics import paired

PAIRS: Final = (("cae", "ae"), ("cvae", "vae"))  # a model that sees the context, and the same without

ENCODINGS: Final = {
    "error_percent_of_pca": "encoder network",
    "search_error_percent_of_pca": "nearest input",
}
"""Measure -> family of tests."""

HYPOTHESIS: Final = "H1"


def compared(results: Sequence[FoldResult]) -> list[Tested]:
    """Every test, after Holm's correction within its family."""
    places = dict.fromkeys((one.place.dataset, one.place.noise_rad) for one in results)
    found: list[Tested] = []
    for (measure, family), (sees, does_not), place in product(ENCODINGS.items(), PAIRS, places):
        values, reference = (_over_folds(results, *place, model, measure) for model in (sees, does_not))
        if len(values) == len(reference) > 0:
            claim = Claim(measure, (sees,), (does_not,), "less", (place[0],))
            one = Tested(hypothesis=HYPOTHESIS, claim=claim, family=family, where=condition(place[1]))
            found.append(one.of(values, reference, paired(values, reference, "less")))
    return corrected_by_family(found)


def _over_folds(
    results: Sequence[FoldResult], dataset: str, noise_rad: float, model: str, measure: str
) -> FloatArray:
    """Means over seeds, (folds,), in the order of the folds."""
    cells = [
        one
        for one in results
        if (one.place.dataset, one.place.noise_rad, one.place.model) == (dataset, noise_rad, model)
    ]
    return np.array(
        [one.figures[measure].mean() for one in sorted(cells, key=lambda one: one.place.fold)], dtype=float
    )


def h1_sentences(tests: Sequence[Tested]) -> list[str]:
    """The direction of the difference, one sentence for each way of encoding."""
    sentences: list[str] = []
    for family in dict.fromkeys(one.family for one in tests):
        here = [one for one in tests if one.family == family]
        lower = sum((one.mean or 0.0) < (one.mean_against or 0.0) for one in here)
        holds = sum(one.says == "held" for one in here)
        sentences.append(
            f"With the {family}, the model that sees the context has the lower mean error in {lower} of"
            f" {len(here)} comparisons, significantly in {holds}, and the other in {len(here) - lower}; H1 is"
            f" {'supported' if holds == len(here) else 'not supported throughout'}."
        )
    return sentences
