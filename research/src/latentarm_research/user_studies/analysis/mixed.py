"""A linear mixed model of all trials: condition, order and trial fixed, person random."""

import warnings
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from latentarm_research.studies.means_test import spreads
from latentarm_research.user_studies.analysis.means import LongTable


@final
@dataclass(frozen=True)
class Mixed:
    """The fixed effect of the condition."""

    estimate: float  # difference between the two sides, in the measure's unit
    se: float  # its standard error
    person_sd: float  # SD of the random intercept
    residual_sd: float  # SD of what is left
    converged: bool  # whether the fit did; figures of a fit that did not are not to be relied on


def mixed_model(table: LongTable) -> Mixed | None:
    """Fit by restricted maximum likelihood.

    statsmodels gives no degrees of freedom that hold for few people, so no p is taken from it: see
    `latentarm_research.user_studies.analysis.randomisation`.

    Returns:
        None for fewer than two people, for one trial a person, of which chance cannot be told apart, or
        where the measure varies too little for a fit.
    """
    from statsmodels.regression.mixed_linear_model import MixedLM  # takes a second

    if table.people < 2 or len(table.value) == table.people or not spreads(table.value):
        return None
    design = np.column_stack([np.ones(len(table.value)), table.label, table.covariates])
    if np.linalg.matrix_rank(design) < design.shape[1] or design.shape[1] >= len(design):
        return None
    scale = float(table.value.std(ddof=1))
    with warnings.catch_warnings():
        # A variance at its boundary, which is common with few people, is told by the estimates themselves.
        warnings.simplefilter("ignore")
        try:
            fitted: Any = MixedLM(table.value / scale, design, groups=table.person).fit(reml=True)
            se = float(fitted.bse_fe[1])
        except np.linalg.LinAlgError:
            return None
    if not np.isfinite(se):
        return None
    return Mixed(
        estimate=scale * float(fitted.fe_params[1]),
        se=scale * se,
        person_sd=scale * float(np.sqrt(max(float(np.asarray(fitted.cov_re).ravel()[0]), 0.0))),
        residual_sd=scale * float(np.sqrt(fitted.scale)),
        converged=bool(fitted.converged),
    )
