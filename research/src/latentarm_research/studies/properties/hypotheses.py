"""Tests of the paper's two hypotheses of section 8.1, on the figures of all seeds.

H1: only models conditioned on the context reconstruct actions accurately. Read as: every conditioned model
has a lower error than every unconditioned one, on every task.

H2: cAE and cVAE learn a latent space that is controllable, consistent and scalable. Read as: every
conditioned model comes nearer to its goals than every unconditioned one (not on the circle, where two latent
axes span the plane and every model comes as near as the solver can), a line through its effects has an
R^2 above `LINEAR` on the two tasks where the paper fits one, and on the circle its axes lie farther apart in
angle.

All tests are one-sided at `LEVEL` after Holm's correction over all tests of the same hypothesis. The paper's
models make one family; conditioned models that the paper does not have make another, so that neither costs
the other its power. Each seed has demonstrations of its own. A model without spread over seeds (PCA's loss in
percent of its own) is a fixed figure, which the other's seeds are tested against.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.models.catalogue import KINDS
from latentarm_research.studies.claims import Claim, Hypothesis, Tested, corrected_by_family
from latentarm_research.studies.properties.cell import PropertiesResult
from latentarm_research.studies.properties.paper import MODELS_OF_THE_PAPER
from latentarm_research.studies.statistics import Statistic, compare_means

PAPERS_MODELS: Final = "the paper's models"
FURTHER_MODELS: Final = "conditioned models that the paper does not have"  # the families of tests

LINEAR: Final = 0.9
"""R^2 above which effects count as consistent and scalable. The paper calls 0.94 ± 0.04 "roughly linear", the
lowest that it prints; this is one SD below, where a line still explains nine tenths of the variance."""


CONDITIONED: Final = ("each conditioned model",)
UNCONDITIONED: Final = ("each unconditioned one",)
MARK: Final = (f"{LINEAR:g}",)


# Path length is no part of this: an arm that stops far from its goal has a short path.
HYPOTHESES: Final = (
    Hypothesis(
        "H1",
        "only latent action models conditioned on the context reconstruct actions accurately",
        (Claim("median_error_percent_of_pca", CONDITIONED, UNCONDITIONED, "less"),),
    ),
    Hypothesis(
        "H2",
        "conditioned models learn a latent space that is controllable, consistent and scalable",
        (
            Claim("controllability_m", CONDITIONED, UNCONDITIONED, "less", ("sine", "rotate")),
            Claim("final_distance", CONDITIONED, UNCONDITIONED, "less"),
            Claim("r2", CONDITIONED, MARK, "greater", ("sine", "rotate")),
            Claim("disentanglement_deg", CONDITIONED, UNCONDITIONED, "greater"),
        ),
    ),
)


def conditioned(model: str) -> bool:
    """Whether a model's decoder sees the context."""
    return KINDS[model].sees_context


def compare_models(results: Sequence[PropertiesResult]) -> list[Tested]:
    """Claims that the results allow: by hypothesis, the paper's models first, by task and measure."""
    figures: dict[str, dict[str, Mapping[str, FloatArray]]] = {}
    for result in results:
        figures.setdefault(result.cell.task, {})[result.cell.model] = result.figures
    tested = [
        one
        for task, models in figures.items()
        for hypothesis in HYPOTHESES
        for claim in hypothesis.claims
        if not claim.tasks or task in claim.tasks
        for one in _test_claim(hypothesis.name, claim, task, models)
    ]
    return corrected_by_family(sorted(tested, key=lambda one: one.family != PAPERS_MODELS))


def _test_claim(
    hypothesis: str, claim: Claim, task: str, models: Mapping[str, Mapping[str, FloatArray]]
) -> list[Tested]:
    """A claim on one task: each conditioned model against the mark or each unconditioned model."""
    measured = {name: figures[claim.measure] for name, figures in models.items() if claim.measure in figures}
    against = {name: values for name, values in measured.items() if not conditioned(name)}
    if claim.against == MARK:
        against = {MARK[0]: np.array([LINEAR])}
    return [
        _test(hypothesis, replace(claim, subject=(name,), against=(other,), tasks=(task,)), values, reference)
        for name, values in measured.items()
        if conditioned(name)
        for other, reference in against.items()
    ]


def _test(hypothesis: str, claim: Claim, values: FloatArray, reference: FloatArray) -> Tested:
    """One test, without correction."""
    known, known_reference = values[np.isfinite(values)], reference[np.isfinite(reference)]
    if len(known) < len(values):
        # Leaving such seeds out would let a model pass by the seeds that did not fail.
        statistic = Statistic("", why_not="a seed has no figure")
    elif not len(known) or not len(known_reference):
        statistic = Statistic("", why_not="no figures to compare with")
    else:
        statistic = compare_means(known, known_reference, "less" if claim.direction == "less" else "greater")
    family = PAPERS_MODELS if claim.subject[0] in MODELS_OF_THE_PAPER else FURTHER_MODELS
    one = Tested(hypothesis=hypothesis, claim=claim, family=family)
    return one.of(known, known_reference, statistic)
