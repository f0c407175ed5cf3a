"""The whole analysis of a study: exclusions, claims, models of all trials, and as the paper printed it."""

import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Final, final

import numpy as np

from latentarm.core.types import FloatArray, IntArray
from latentarm_research.studies.claims import Claim, Tested, Verdict, corrected, verdict_on
from latentarm_research.studies.statistics import Statistic, spreads
from latentarm_research.user_studies.analysis.anova import Effect
from latentarm_research.user_studies.analysis.as_printed import AsPrinted, as_printed
from latentarm_research.user_studies.analysis.means import LongTable, Sides, tasks_of
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs import StudyDesign, design_of
from latentarm_research.user_studies.exclusion import Excluded, counted
from latentarm_research.user_studies.record import Trial

NOT_MEASURED: Final = "nobody has a figure for it"
NO_SPREAD: Final = "all people differ alike"
# Six digits of a fit hold with this tolerance; Powell's method goes on where a variance is at its boundary.
_FIT: Final[dict[str, Any]] = {"method": ["bfgs", "powell"], "gtol": 1e-9}


def sides_of(definition: Definition, trials: Sequence[Trial]) -> list[Sides]:
    """Both sides of every claim of a study, in order."""
    design = design_of(definition)
    return [design.sides(trials, claim) for claim in definition.claims]


def claims_tested(definition: Definition, both: Sequence[Sides]) -> list[Tested]:
    """Test all claims of a study, and correct them together.

    ``less`` and ``greater`` are tested two-sided by t on people's means, ``equal`` by two one-sided tests.
    """
    owners = [hypothesis.name for hypothesis in definition.hypotheses for _ in hypothesis.claims]
    design = design_of(definition)
    return corrected(
        [
            Tested(hypothesis=owner, claim=claim).of(
                sides.subject, sides.against, _test(design, claim, sides)
            )
            for owner, claim, sides in zip(owners, definition.claims, both, strict=True)
        ]
    )


def verdicts(definition: Definition, tested: Sequence[Tested]) -> list[Verdict]:
    """The verdict on each hypothesis, from its claims."""
    return [
        verdict_on(
            hypothesis,
            [one for one in tested if one.hypothesis == hypothesis.name],
            definition.label,
            definition.task_label,
        )
        for hypothesis in definition.hypotheses
    ]


def worded(definition: Definition, claim: Claim) -> str:
    """A claim in words, such as ``time: LA+SA < R``."""
    return claim.worded(definition.label, definition.task_label)


def _test(design: StudyDesign, claim: Claim, both: Sides) -> Statistic:
    too_few = design.too_few(both)
    test = None if too_few else design.test(both)
    if test is None:
        nobody = not both.people and not both.people_against
        return Statistic("", why_not=NOT_MEASURED if nobody else too_few or NO_SPREAD)
    if claim.margin is not None:
        return Statistic("TOST", test, test.p_of_equality(claim.margin))
    return Statistic("t", test, test.p)


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
    `latentarm_research.user_studies.analysis.randomisation`. None for fewer than two people, for one trial a
    person, of which chance cannot be told apart, or where the measure varies too little for a fit.
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
            fitted: Any = MixedLM(table.value / scale, design, groups=table.person).fit(reml=True, **_FIT)
            person_variance = max(float(np.asarray(fitted.cov_re).ravel()[0]), 0.0)
            se = _standard_error(design, table.person, person_variance, float(fitted.scale))
        except np.linalg.LinAlgError:
            return None
    if not np.isfinite(se):
        return None
    return Mixed(
        estimate=scale * float(fitted.fe_params[1]),
        se=scale * se,
        person_sd=scale * float(np.sqrt(person_variance)),
        residual_sd=scale * float(np.sqrt(fitted.scale)),
        converged=bool(fitted.converged),
    )


def _standard_error(design: FloatArray, person: IntArray, person_variance: float, variance: float) -> float:
    """That of the second coefficient, by generalised least squares at the fitted variances.

    It is that of R's nlme and lme4; statsmodels inverts the information on all parameters together, which
    differs where figures are missing.
    """
    own = (person[:, None] == np.arange(person.max() + 1)).astype(float)
    shrink = person_variance / (variance + own.sum(axis=0) * person_variance)
    sums = own.T @ design
    information = design.T @ design - sums.T @ (shrink[:, None] * sums)
    return float(np.sqrt(variance * np.linalg.inv(information)[1, 1]))


@final
@dataclass(frozen=True)
class TestedClaim:
    """A claim, tested on people's means and in a model of all trials."""

    tested: Tested  # on people's means
    mixed: Mixed | None  # the linear mixed model; None where it could not be fitted
    p: float | None  # of the randomisation test; None where it could not be made

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        test = self.tested.test
        low, high = (None, None) if test is None else test.effect_interval
        mixed = None if self.mixed is None else asdict(self.mixed)
        model = {"mixed": mixed, "p": self.p, "d_low": low, "d_high": high}
        return {**self.tested.as_json(), "model": model}


@final
@dataclass(frozen=True)
class Analysis:
    """What a study says."""

    trials: tuple[Trial, ...]  # that count
    excluded: Excluded  # what does not
    claims: tuple[TestedClaim, ...]  # every claim, tested
    verdicts: tuple[Verdict, ...]  # on every hypothesis
    effects: dict[str, list[Effect]]  # of a factorial design, by measure; empty without factors
    as_printed: tuple[AsPrinted, ...]  # the paper's statistics with ours

    def as_json(self) -> dict[str, object]:
        """Plain mapping of everything but the claims."""
        return {
            "excluded_trials": [{"trial": index, "why": why} for index, why in self.excluded.trials],
            "excluded_people": list(self.excluded.people),
            "hypotheses": [
                {"name": one.hypothesis.name, "text": one.hypothesis.text, "says": one.says, "why": one.why}
                for one in self.verdicts
            ],
            "anova": {
                measure: [asdict(effect) for effect in found] for measure, found in self.effects.items()
            },
            "as_printed": [one.as_json() for one in self.as_printed],
        }


def analyse(
    definition: Definition, trials: Sequence[Trial], ratings: Sequence[Trial] = (), not_judged: str = ""
) -> Analysis:
    """Analyse a study's trials; who gave them, simulated or real people, changes nothing.

    Rules of exclusion do not see ``ratings``, scores on the questionnaire's scales, but who is excluded is
    excluded there too. ``not_judged`` says why no claim is tested; empty where claims are.
    """
    design = design_of(definition)
    kept, out = counted(definition.exclusions, trials)
    every = [*kept, *(one for one in ratings if one.person not in out.people)]
    both = sides_of(definition, every)
    tested = claims_tested(definition, both)
    if not_judged:
        tested = [replace(one, test=None, p=None, p_holm=None, why_not=not_judged) for one in tested]
    return Analysis(
        trials=tuple(kept),
        excluded=out,
        claims=tuple(_modelled(design, one, sides, every) for one, sides in zip(tested, both, strict=True)),
        verdicts=tuple(verdicts(definition, tested)),
        effects={} if not_judged else _effects(definition, every),
        as_printed=() if not_judged else tuple(as_printed(one, every) for one in definition.printed),
    )


def _modelled(design: StudyDesign, tested: Tested, both: Sides, trials: Sequence[Trial]) -> TestedClaim:
    table = design.table(trials, tested.claim)
    return TestedClaim(tested, mixed_model(table), design.randomisation_p(both, table))


def _effects(definition: Definition, trials: Sequence[Trial]) -> dict[str, list[Effect]]:
    if len(definition.factors) != 2:
        return {}
    design, (first, second) = design_of(definition), definition.factors
    claims = {claim.measure: claim for claim in definition.claims}
    found = {
        measure: design.effects(trials, (first, second), measure, tasks_of(trials, claim))
        for measure, claim in claims.items()
    }
    return {measure: effects for measure, effects in found.items() if effects}
