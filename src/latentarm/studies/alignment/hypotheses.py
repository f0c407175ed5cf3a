"""Tests of the paper's three hypotheses of section 8.3, and of targets of our own, on the errors of all runs.

H1: with abundant labelled data the alignment model learns the preference. Read as: Ideal Align has a lower
error than No Align and than Manual Align. The paper adds that this also holds for alignments learned from few
answers; that is tested for All Priors.

H2: with priors, far fewer answers do. Read as: with the same few answers, each single prior and all of them
have a lower error than No Priors; and All Priors comes close to Ideal Align: its error is below `NEAR` times
that.

H3: all priors together are better than one of them. Read as: All Priors has a lower error than each.

All tests are one-sided at `LEVEL`, Welch's where both sides have spread, after Holm's correction over all
tests of one hypothesis with one model. Targets compare means and test nothing.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Final

from latentarm.metrics.looks import look_of
from latentarm.studies.alignment.cell import CellResult
from latentarm.studies.alignment.curves import AT_RANDOM, BY_DISAGREEMENT, BY_NOVELTY, CurveResult
from latentarm.studies.alignment.preset import (
    ALL_PRIORS,
    FEW_ANSWERS,
    IDEAL,
    MANUAL,
    NO_ALIGN,
    SINGLE_PRIORS,
    WITHOUT_PRIORS,
)
from latentarm.studies.hypotheses import Comparison, corrected
from latentarm.studies.page import listed
from latentarm.studies.statistics import compare_means
from latentarm.types import FloatArray

NEAR: Final = 1.25
"""Up to this many times the error of Ideal Align counts as close to it."""


@dataclass(frozen=True)
class Claim:
    """One part of a hypothesis: a condition's error is lower than another's.

    Attributes:
        hypothesis: ``H1``, ``H2`` or ``H3``.
        condition: the one that should have the lower error.
        against: the one it is compared with.
        times: factor on the other's error.
    """

    hypothesis: str
    condition: str
    against: str
    times: float = 1.0


CLAIMS: Final = (
    *(Claim("H1", one, other) for one in (IDEAL, ALL_PRIORS) for other in (NO_ALIGN, MANUAL)),
    *(Claim("H2", one, WITHOUT_PRIORS) for one in (*SINGLE_PRIORS, ALL_PRIORS)),
    Claim("H2", ALL_PRIORS, IDEAL, NEAR),
    *(Claim("H3", ALL_PRIORS, one) for one in SINGLE_PRIORS),
)


def compare_conditions(results: Sequence[CellResult]) -> list[Comparison]:
    """Every test, by hypothesis, then by model, then in the order of the results."""
    return corrected([_test(claim, result) for result in results for claim in CLAIMS])


def _test(claim: Claim, result: CellResult) -> Comparison:
    """One test, without correction."""
    values, reference = result.errors[claim.condition], claim.times * result.errors[claim.against]
    return Comparison(
        hypothesis=claim.hypothesis,
        family=result.cell.model,
        task=result.cell.task,
        model=result.cell.model,
        measure="relative_alignment_error",
        where=f"noise {result.cell.noise:g}",
        subject=claim.condition,
        against=claim.against if claim.times == 1 else f"{claim.times:g} times {claim.against}",
        mean=float(values.mean()),
        mean_against=float(reference.mean()),
        n=len(values),
        n_against=len(reference),
    ).tested(compare_means(values, reference, "less"))


SINGLE_SHARE: Final = 0.6
"""A single prior should stay below this share of the error of No Priors; the paper says "twice as well"."""

PAPER_MODEL: Final = "cae"
"""The model of the paper's study."""

RANDOM_ANSWERS: Final = 10
"""Answers at random, whose error ..."""

CHOSEN_ANSWERS: Final = 6
"""... so many chosen ones should reach ..."""

TASKS_AT_LEAST: Final = 2
"""... on so many tasks."""


@dataclass(frozen=True)
class Target:
    """One target.

    Attributes:
        name: what should be reached.
        met: whether it was.
        figures: how far it was met, or by how much it was missed.
    """

    name: str
    met: bool
    figures: str

    def as_json(self) -> dict[str, object]:
        """Plain mapping, ready for ``json.dumps``."""
        return asdict(self)


def targets(results: Sequence[CellResult], curves: Sequence[CurveResult]) -> list[Target]:
    """Every target that the results can decide, model by model."""
    found: list[Target] = []
    for model in dict.fromkeys(result.cell.model for result in results):
        of_model = [result for result in results if result.cell.model == model]
        found += [
            _lowest(of_model, "mean", lambda errors: float(errors.mean())),
            _lowest(of_model, "SD", lambda errors: float(errors.std(ddof=1)) if len(errors) > 1 else 0.0),
            _single_priors(of_model),
        ]
    found += [
        _near_ideal(result)
        for result in results
        if (result.cell.model, result.cell.task, result.cell.noise) == (PAPER_MODEL, "plane", 0.0)
    ]
    exact = [curve for curve in curves if curve.cell.noise == 0.0 and _judged(curve)]
    for model in dict.fromkeys(curve.cell.learned.cell.model for curve in exact):
        here = [curve for curve in exact if curve.cell.learned.cell.model == model]
        found += [_fewer_answers(here, choice) for choice in (BY_NOVELTY, BY_DISAGREEMENT)]
    return found


def answers_needed(curve: CurveResult, choice: str) -> int | None:
    """The fewest chosen answers with a mean error no higher than that of `RANDOM_ANSWERS` at random.

    None where no measured number of them has.
    """
    wanted = curve.errors[AT_RANDOM][RANDOM_ANSWERS].mean()
    return next((count for count, errors in curve.errors[choice].items() if errors.mean() <= wanted), None)


def _lowest(results: Sequence[CellResult], what: str, of: Callable[[FloatArray], float]) -> Target:
    missed: list[str] = []
    for result in results:
        figures = {name: of(result.errors[name]) for name in FEW_ANSWERS}
        best = min(figures, key=lambda name: figures[name])
        if figures[best] < figures[ALL_PRIORS]:
            missed.append(f"{_place(result)}: {figures[ALL_PRIORS]:.3g}, {best} {figures[best]:.3g}")
    return Target(
        f"{ALL_PRIORS} has the lowest {what} of all with as many answers, {_model(results)}",
        not missed,
        _counted(len(results), missed),
    )


def _single_priors(results: Sequence[CellResult]) -> Target:
    ratios = {
        f"{_place(result)}: {name}": float(result.errors[name].mean() / result.errors[WITHOUT_PRIORS].mean())
        for result in results
        for name in SINGLE_PRIORS
    }
    missed = [f"{place} {ratio:.2f}" for place, ratio in ratios.items() if ratio > SINGLE_SHARE]
    return Target(
        f"each single prior has at most {SINGLE_SHARE:g} of the error of {WITHOUT_PRIORS}, {_model(results)}",
        not missed,
        f"{min(ratios.values()):.2f} to {max(ratios.values()):.2f}; {_counted(len(ratios), missed)}",
    )


def _near_ideal(result: CellResult) -> Target:
    ours, ideal = (float(result.errors[name].mean()) for name in (ALL_PRIORS, IDEAL))
    return Target(
        f"{ALL_PRIORS} has at most {NEAR:g} times the error of {IDEAL}, {_model([result])}, {_place(result)}",
        ours <= NEAR * ideal,
        f"{ours:.3g} against {ideal:.3g}, {ours / ideal:.1f} times; {WITHOUT_PRIORS}"
        f" {result.errors[WITHOUT_PRIORS].mean():.3g}",
    )


def _fewer_answers(curves: Sequence[CurveResult], choice: str) -> Target:
    needed = {curve.cell.learned.cell.task: answers_needed(curve, choice) for curve in curves}
    reached = [task for task, count in needed.items() if count is not None and count <= CHOSEN_ANSWERS]
    model = look_of(curves[0].cell.learned.cell.model).label
    return Target(
        f"questions {choice} reach the error of {RANDOM_ANSWERS} random ones with at most {CHOSEN_ANSWERS},"
        f" on {TASKS_AT_LEAST} tasks or more, {model}, noise 0",
        len(reached) >= TASKS_AT_LEAST,
        "; ".join(
            f"{look_of(task).label} {'with no measured number' if count is None else f'with {count}'}"
            for task, count in needed.items()
        ),
    )


def _judged(curve: CurveResult) -> bool:
    counts = curve.errors[BY_NOVELTY]
    return RANDOM_ANSWERS in curve.errors[AT_RANDOM] and any(count <= CHOSEN_ANSWERS for count in counts)


def _counted(many: int, missed: Sequence[str]) -> str:
    return f"{many - len(missed)} of {many}" + (f"; not {'; '.join(missed)}" if missed else "")


def _place(result: CellResult) -> str:
    return f"{look_of(result.cell.task).label}, noise {result.cell.noise:g}"


def _model(results: Iterable[CellResult]) -> str:
    return listed(look_of(result.cell.model).label for result in results)
