"""Hypotheses of studies: stating them, testing them, and wording the verdicts.

A hypothesis is a set of comparisons, each of which claims that one series of figures is less, or greater,
than another one or than a fixed mark. Comparisons of one hypothesis in one family, such as one model's,
are corrected together by Holm's method. The hypothesis is supported on a task where all its comparisons hold.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Final

from latentarm.core.types import FloatArray
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import ABSENT, format_figure
from latentarm_research.studies.means_test import Direction
from latentarm_research.studies.statistics import LEVEL, Statistic, format_p, holm
from latentarm_research.studies.tables import listed, markdown_table

SIDES: Final[Mapping[Direction, str]] = {"less": "below", "greater": "above"}
SIGNS: Final[Mapping[Direction, str]] = {"less": "<", "greater": ">"}

LONGEST: Final = 200  # longest list of failures in a task's verdict; a longer one is replaced by a count


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """One test."""

    hypothesis: str  # `H1`, `H2`, ...
    family: str  # which tests of the hypothesis it is corrected with, such as those of a model
    task: str
    model: str
    measure: str  # what is compared
    where: str = ""  # further condition, such as the person or the noise level; empty if not needed
    subject: str  # what should be less or greater: a model, a method or a condition
    against: str | None  # than what; None for a fixed mark
    direction: Direction = "less"  # whether the subject should have less or more
    mean: float | None = None  # of the subject's figures; None where it has none
    half_width: float | None = None  # of its 95 % interval, where the study takes one
    mean_against: float | None = None  # of the other's figures, or the mark; None where it has none
    half_width_against: float | None = None  # of its 95 % interval; 0 for a mark
    n: int = 0  # figures of the subject
    n_against: int = 0  # figures of the other; 1 for a mark
    test: str = "none"  # `Welch`, `one-sample`, `paired t`, `McNemar`, or the reason no test was run
    t: float | None = None  # its statistic, or None; below 0 where the subject has less
    dof: float | None = None  # degrees of freedom, or None
    p: float | None = None  # one-sided, before correction, or None
    p_holm: float | None = None  # after Holm's correction over the family, or None
    # effect size, above 0 where the difference has the direction of the hypothesis, or None
    hedges_g: float | None = None
    must_be_apart: bool = False  # whether the two intervals have to lie apart, too

    @property
    def apart(self) -> bool | None:
        """Whether the intervals lie apart in the direction of the hypothesis; None without intervals."""
        if None in (self.mean, self.mean_against, self.half_width, self.half_width_against):
            return None
        away = (self.mean_against or 0.0) - (self.mean or 0.0)
        reach = (self.half_width or 0.0) + (self.half_width_against or 0.0)
        return (away if self.direction == "less" else -away) > reach

    @property
    def holds(self) -> bool:
        """Whether this supports the hypothesis. What could not be tested does not."""
        significant = self.p_holm is not None and self.p_holm < LEVEL
        return significant and (not self.must_be_apart or bool(self.apart))

    def tested(self, statistic: Statistic) -> "Comparison":
        """The same with the result of a test, before correction."""
        return replace(self, **asdict(statistic))

    def of(self, values: FloatArray, reference: FloatArray, statistic: Statistic) -> "Comparison":
        """The same of figures (n,) and those of the other (m,), with the result of their test."""
        mean, mean_against = (float(one.mean()) if len(one) else None for one in (values, reference))
        about = replace(self, mean=mean, mean_against=mean_against, n=len(values), n_against=len(reference))
        return about.tested(statistic)

    def as_json(self) -> dict[str, object]:
        """Plain mapping, ready for ``json.dumps``."""
        return {**asdict(self), "apart": self.apart, "holds": self.holds}


@dataclass(frozen=True)
class Verdict:
    """What the tests say of one hypothesis."""

    hypothesis: str  # `H1`, `H2`, ...
    family: str  # of tests
    by_task: Mapping[str, str]  # task -> `supported` or `not supported: why`, in the tasks' order


def corrected(comparisons: Sequence[Comparison]) -> list[Comparison]:
    """All tests of a study after Holm's correction: by hypothesis, then by family, then as given."""
    found: list[Comparison] = []
    for hypothesis in sorted({one.hypothesis for one in comparisons}):
        here = [one for one in comparisons if one.hypothesis == hypothesis]
        for family in dict.fromkeys(one.family for one in here):
            tests = [one for one in here if one.family == family]
            p_holm = holm([one.p for one in tests])
            found += [replace(one, p_holm=p) for one, p in zip(tests, p_holm, strict=True)]
    return found


def verdicts(comparisons: Sequence[Comparison]) -> list[Verdict]:
    """One verdict for each hypothesis in each family, family by family."""
    found: list[Verdict] = []
    several_measures = _differs(comparisons, "measure")
    for family in dict.fromkeys(one.family for one in comparisons):
        of_family = [one for one in comparisons if one.family == family]
        for hypothesis in dict.fromkeys(one.hypothesis for one in of_family):
            tests = [one for one in of_family if one.hypothesis == hypothesis]
            by_task = {
                task: _said([one for one in tests if one.task == task], several_measures)
                for task in dict.fromkeys(one.task for one in tests)
            }
            found.append(Verdict(hypothesis, family, by_task))
    return found


def comparison_table(comparisons: Sequence[Comparison]) -> str:
    """Every test as a Markdown table; empty columns are left out."""
    columns: dict[str, Callable[[Comparison], str]] = {
        "": lambda one: one.hypothesis,
        "task": lambda one: look_of(one.task).label,
        "measure": lambda one: one.measure if _differs(comparisons, "measure") else "",
        "model": lambda one: "" if one.model == one.subject else look_of(one.model).label,
        "where": lambda one: one.where,
        "what": lambda one: f"{look_of(one.subject).label} {format_figure(one.mean, one.half_width)}",
        "against": _against,
        "test": lambda one: one.test,
        "t (dof)": lambda one: ABSENT if one.t is None or one.dof is None else f"{one.t:.3g} ({one.dof:.3g})",
        "p, Holm": lambda one: format_p(one.p_holm),
        "Hedges' g": lambda one: ABSENT if one.hedges_g is None else f"{one.hedges_g:.3g}",
        "apart": lambda one: {True: "yes", False: "no", None: ""}[one.apart],
        "holds": lambda one: "yes" if one.holds else "no",
    }
    texts = {name: [column(one) for one in comparisons] for name, column in columns.items()}
    shown = [name for name, column in texts.items() if any(column)]
    return markdown_table(shown, list(zip(*(texts[name] for name in shown), strict=True)))


def _differs(comparisons: Sequence[Comparison], field: str) -> bool:
    return len({getattr(one, field) for one in comparisons}) > 1


def _against(one: Comparison) -> str:
    if one.against is None:
        return f"{SIGNS[one.direction]} {one.mean_against:g}"
    figure = format_figure(one.mean_against, one.half_width_against)
    return f"{SIGNS[one.direction]} {look_of(one.against).label} {figure}"


def _said(tests: Sequence[Comparison], several_measures: bool) -> str:
    """``supported``, or what failed; if that is too long, how many tests failed."""
    failing = [one for one in tests if not one.holds]
    if not failing:
        return "supported"
    why = _why_not(failing, several_measures)
    if len(why) > LONGEST:
        why = f"{len(failing)} of {len(tests)} tests do not hold, in {listed(one.measure for one in failing)}"
    return f"not supported: {why}"


def _why_not(failing: Sequence[Comparison], several_measures: bool) -> str:
    """What is not on the hypothesis' side of what; what fails alike is named together."""
    where: dict[tuple[str, str, str, str], list[str]] = {}
    for one in failing:
        relation = "could not be tested against" if one.p is None else f"not clearly {SIDES[one.direction]}"
        against = f"{one.mean_against:g}" if one.against is None else look_of(one.against).label
        measure = f" in {one.measure}" if several_measures else ""
        where.setdefault((look_of(one.subject).label, relation, against, measure), []).append(one.where)
    others: dict[tuple[str, str, str], list[str]] = {}
    for (subject, relation, against, measure), places in where.items():
        place = f" ({listed(filter(None, places))})" if any(places) else ""
        others.setdefault((subject, relation, measure + place), []).append(against)
    subjects: dict[tuple[str, str, str], list[str]] = {}
    for (subject, relation, end), against in others.items():
        subjects.setdefault((relation, listed(against), end), []).append(subject)
    return "; ".join(
        f"{listed(names)} {relation} {against}{end}" for (relation, against, end), names in subjects.items()
    )
