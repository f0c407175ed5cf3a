"""The paper's own analysis, as printed, on our trials, so that its statistics can be compared with ours."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.studies.claims import Claim
from latentarm_research.studies.statistics import LEVEL, format_p, spreads
from latentarm_research.user_studies.analysis.means import sides, tasks_of
from latentarm_research.user_studies.hypothesis import Printed
from latentarm_research.user_studies.record import Trial

NOT_MEASURED: Final = "not measured"
NOBODY_BOTH: Final = "nobody has met both conditions"


@final
@dataclass(frozen=True)
class AsPrinted:
    """One statistic of the paper, and the same of our trials."""

    printed: Printed  # of the paper
    text: str  # ours in the same form
    less: bool | None = None  # whether our subject has less; None where nothing was compared or measured
    significant: bool | None = None  # whether p is below .05; None where nothing was tested

    @property
    def same_sign(self) -> bool | None:
        """Whether the difference has the paper's sign; None where either is unknown."""
        unknown = self.less is None or self.printed.less is None
        return None if unknown else self.less == self.printed.less

    @property
    def same_significance(self) -> bool | None:
        """Whether both are significant, or neither; None where either is unknown."""
        unknown = self.significant is None or self.printed.significant is None
        return None if unknown else self.significant == self.printed.significant

    def as_json(self) -> dict[str, object]:
        """Plain mapping."""
        return {
            "test": self.printed.test,
            "measure": self.printed.measure,
            "subject": list(self.printed.subject),
            "against": list(self.printed.against),
            "tasks": list(self.printed.tasks),
            "paper": self.printed.text,
            "ours": self.text,
            "same_sign": self.same_sign,
            "same_significance": self.same_significance,
        }


def as_printed(printed: Printed, trials: Sequence[Trial]) -> AsPrinted:
    """Analyse our trials in the way in which the paper got a statistic."""
    if not any(printed.measure in trial.measures for trial in trials):
        return AsPrinted(printed, NOT_MEASURED)
    if not printed.against:
        return AsPrinted(printed, _described(printed, trials))
    return (_trials_t if printed.test == "trials t" else _of_people)(printed, trials)


def _values(printed: Printed, trials: Sequence[Trial], conditions: Sequence[str]) -> FloatArray:
    """The measure in every trial of some conditions, as if they were independent."""
    tasks = printed.tasks or tasks_of(trials, Claim(printed.measure, ("",), ("-",), "less"))
    return np.array(
        [
            trial.measures[printed.measure]
            for trial in trials
            if trial.condition in conditions and trial.task in tasks and printed.measure in trial.measures
        ]
    )


def _described(printed: Printed, trials: Sequence[Trial]) -> str:
    values = _values(printed, trials, printed.subject)
    if not len(values):
        return NOT_MEASURED
    if printed.test == "share":
        return f"{int(values.sum())} of {len(values)} trials"
    return f"{values.mean():.0f} s on average, {values.min():.0f} to {values.max():.0f} s"


def _trials_t(printed: Printed, trials: Sequence[Trial]) -> AsPrinted:
    from scipy.stats import ttest_ind

    subject, against = (_values(printed, trials, side) for side in (printed.subject, printed.against))
    if min(len(subject), len(against)) < 2 or not spreads(np.concatenate([subject, against])):
        return AsPrinted(printed, "too few trials")
    # The paper's t is positive where latent actions have less.
    result: Any = ttest_ind(against, subject)
    text = f"t({len(subject) + len(against) - 2}) = {result.statistic:.2f}, {_p(result.pvalue)}"
    return _said(printed, text, float(subject.mean() - against.mean()), float(result.pvalue))


def _of_people(printed: Printed, trials: Sequence[Trial]) -> AsPrinted:
    """The two sides of the same people, in pairs, or as if they were different people."""
    from scipy.stats import f_oneway, ttest_rel

    both = sides(trials, Claim(printed.measure, printed.subject, printed.against, "less", printed.tasks))
    n, apart = len(both.people), printed.test == "between F"
    if not n:
        return AsPrinted(printed, NOBODY_BOTH)
    if n < 2 or not spreads(np.concatenate([both.subject, both.against]) if apart else both.differences):
        return AsPrinted(printed, "too few people, or no spread")
    result: Any = (f_oneway if apart else ttest_rel)(both.subject, both.against)
    statistic = f"F(1, {2 * n - 2})" if apart else f"t({n - 1})"
    text = f"{statistic} = {result.statistic:.1f}, {_p(result.pvalue)}"
    return _said(printed, text, float(both.differences.mean()), float(result.pvalue))


def _said(printed: Printed, text: str, difference: float, p: float) -> AsPrinted:
    return AsPrinted(printed, text, difference < 0.0, p < LEVEL)


def _p(p: float) -> str:
    shown = format_p(p)
    return f"p {shown}" if shown.startswith("<") else f"p = {shown}"
