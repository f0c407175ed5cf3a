"""Tests of the paper's three hypotheses of section 8.3, and of targets of our own, on the errors of all runs.

H1: with abundant labelled data the alignment model learns the preference. Read as: Ideal Align has a lower
error than No Align and than Manual Align. The paper adds that this also holds for alignments learned from few
answers; that is tested for All Priors.

H2: with priors, far fewer answers do. Read as: with the same few answers, each single prior and all of them
have a lower error than No Priors; and All Priors comes close to Ideal Align: its error is below `NEAR` times
that. The same is tested for Tool Space, ours, which the paper does not have.

H3: all priors together are better than one of them. Read as: All Priors has a lower error than each.

All tests are one-sided at `LEVEL`, Welch's where both sides have spread, after Holm's correction over all
tests of one hypothesis with one model. Targets compare means and test nothing.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final

from latentarm.core.types import FloatArray
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.alignment.cell import AlignmentErrors
from latentarm_research.studies.alignment.curves import PRIORS_AT_RANDOM, CurveResult
from latentarm_research.studies.alignment.preset import (
    ALL_PRIORS,
    CHOSEN,
    FEW_ANSWERS,
    IDEAL,
    MANUAL,
    NO_ALIGN,
    SINGLE_PRIORS,
    TOOL_SPACE,
    WITHOUT_PRIORS,
)
from latentarm_research.studies.alignment.turning import FEW, TurningResult
from latentarm_research.studies.claims import Claim, Hypothesis, Tested, corrected_by_family
from latentarm_research.studies.statistics import compare_means
from latentarm_research.studies.tables import listed
from latentarm_research.studies.targets import Target

NEAR: Final = 1.25  # up to this many times the error of Ideal Align counts as close to it


NEAR_IDEAL: Final = f"{NEAR:g} times {IDEAL}"


def _below(against: str, *conditions: str) -> tuple[Claim, ...]:
    """That each condition has a lower error than another one."""
    return tuple(Claim("relative_alignment_error", (one,), (against,), "less") for one in conditions)


HYPOTHESES: Final = (
    Hypothesis(
        "H1",
        "with abundant answers the alignment learns what is meant",
        (*_below(NO_ALIGN, IDEAL, ALL_PRIORS), *_below(MANUAL, IDEAL, ALL_PRIORS)),
    ),
    Hypothesis(
        "H2",
        "with priors, far fewer answers do",
        (
            *_below(WITHOUT_PRIORS, *SINGLE_PRIORS, ALL_PRIORS),
            *_below(NEAR_IDEAL, ALL_PRIORS, TOOL_SPACE),
        ),
    ),
    Hypothesis(
        "H3",
        "all priors together are better than one of them",
        tuple(claim for one in SINGLE_PRIORS for claim in _below(one, ALL_PRIORS)),
    ),
)


def compare_conditions(results: Sequence[AlignmentErrors]) -> list[Tested]:
    """Every claim, by hypothesis, then by model, then in the order of the results."""
    return corrected_by_family(
        [
            _test(hypothesis.name, claim, result)
            for result in results
            for hypothesis in HYPOTHESES
            for claim in hypothesis.claims
        ]
    )


def _test(hypothesis: str, claim: Claim, result: AlignmentErrors) -> Tested:
    """One test, without correction."""
    errors = {**result.errors, NEAR_IDEAL: NEAR * result.errors[IDEAL]}
    values, reference = errors[claim.subject[0]], errors[claim.against[0]]
    return Tested(
        hypothesis=hypothesis,
        claim=replace(claim, tasks=(result.cell.task,)),
        family=result.cell.model,
        where=f"noise {result.cell.noise:g}",
    ).of(values, reference, compare_means(values, reference, "less"))


SINGLE_SHARE: Final = 0.6
"""A single prior should stay below this share of the error of No Priors; the paper says "twice as well"."""

PAPER_MODEL: Final = "cae"  # the model of the paper's study
RANDOM_ANSWERS: Final = 10  # answers at random, whose error with All Priors ...
CHOSEN_ANSWERS: Final = 4  # ... so many chosen ones in tool space should reach


def targets(
    results: Sequence[AlignmentErrors], curves: Sequence[CurveResult], turning: Sequence[TurningResult]
) -> list[Target]:
    """Every target that the results can decide, model by model."""
    found: list[Target] = []
    for model in dict.fromkeys(result.cell.model for result in results):
        of_model = [result for result in results if result.cell.model == model]
        found += [
            _near_ideal(of_model, TOOL_SPACE),
            _near_ideal(of_model, CHOSEN),
            _lowest(of_model, "mean", lambda errors: float(errors.mean())),
            _lowest(of_model, "SD", lambda errors: float(errors.std(ddof=1)) if len(errors) > 1 else 0.0),
            _single_priors(of_model),
        ]
    found += [
        _fewer_answers([curve for curve in curves if curve.cell.noise == noise and _judged(curve)])
        for noise in dict.fromkeys(curve.cell.noise for curve in curves if _judged(curve))
    ]
    for result in turning:
        found += _turning(result)
    return found


def answers_needed(curve: CurveResult) -> int | None:
    """The fewest chosen answers with a mean error no higher than that of `RANDOM_ANSWERS` with All Priors.

    None where no measured number of them has.
    """
    wanted = curve.errors[PRIORS_AT_RANDOM][RANDOM_ANSWERS].mean()
    return next((count for count, errors in curve.errors[CHOSEN].items() if errors.mean() <= wanted), None)


def _lowest(results: Sequence[AlignmentErrors], what: str, of: Callable[[FloatArray], float]) -> Target:
    missed: list[str] = []
    for result in results:
        figures = {name: of(result.errors[name]) for name in FEW_ANSWERS if name != TOOL_SPACE}
        best = min(figures, key=lambda name: figures[name])
        if figures[best] < figures[ALL_PRIORS]:
            missed.append(f"{_place(result)}: {figures[ALL_PRIORS]:.3g}, {best} {figures[best]:.3g}")
    return Target(
        f"{ALL_PRIORS} has the lowest {what} of the paper's conditions with few answers, {_model(results)}",
        not missed,
        _counted(len(results), missed),
    )


def _single_priors(results: Sequence[AlignmentErrors]) -> Target:
    ratios = {
        f"{_place(result)}: {name}": float(result.errors[name].mean() / result.errors[WITHOUT_PRIORS].mean())
        for result in results
        for name in SINGLE_PRIORS
    }
    name = f"each single prior has at most {SINGLE_SHARE:g} of the error of {WITHOUT_PRIORS}"
    return _at_most(SINGLE_SHARE, ratios, f"{name}, {_model(results)}", "; ")


def _near_ideal(results: Sequence[AlignmentErrors], condition: str) -> Target:
    ratios = {
        _place(result): float(result.errors[condition].mean() / result.errors[IDEAL].mean())
        for result in results
    }
    name = f"{condition} has at most {NEAR:g} times the error of {IDEAL}"
    return _at_most(NEAR, ratios, f"{name}, {_model(results)}", " times; ")


def _at_most(most: float, ratios: Mapping[str, float], name: str, between: str) -> Target:
    """That no ratio is above a mark."""
    missed = [f"{place} {ratio:.2f}" for place, ratio in ratios.items() if ratio > most]
    ends = f"{min(ratios.values()):.2f} to {max(ratios.values()):.2f}"
    return Target(name, not missed, f"{ends}{between}{_counted(len(ratios), missed)}")


def _fewer_answers(curves: Sequence[CurveResult]) -> Target:
    needed = {curve.cell.task: answers_needed(curve) for curve in curves}
    return Target(
        f"chosen questions in tool space reach the error of {RANDOM_ANSWERS} random ones of {ALL_PRIORS} with"
        f" at most {CHOSEN_ANSWERS}, noise {curves[0].cell.noise:g}",
        all(count is not None and count <= CHOSEN_ANSWERS for count in needed.values()),
        "; ".join(
            f"{look_of(task).label} {'with no measured number' if count is None else f'with {count}'}"
            for task, count in needed.items()
        ),
    )


def _turning(result: TurningResult) -> list[Target]:
    """For people whose axes turn: as near to Ideal Align, and with as few answers."""
    mean = {name: float(errors.mean()) for name, errors in result.errors.items()}
    who = f"people whose axes turn, noise {result.cell.noise:g}"
    many = len(result.errors[IDEAL])
    ours, ideal = float(result.errors[CHOSEN][:many].mean()), mean[IDEAL]
    return [
        Target(
            f"{CHOSEN}, has at most {NEAR:g} times the error of {IDEAL}, {who}",
            ours <= NEAR * ideal,
            f"{ours:.3g} against {ideal:.3g}, {ours / ideal:.2f} times, the same {many} people",
        ),
        Target(
            f"{FEW}, have at most the error of {RANDOM_ANSWERS} random ones of {ALL_PRIORS}, {who}",
            mean[FEW] <= mean[PRIORS_AT_RANDOM],
            f"{mean[FEW]:.3g} against {mean[PRIORS_AT_RANDOM]:.3g}",
        ),
    ]


def _judged(curve: CurveResult) -> bool:
    return RANDOM_ANSWERS in curve.errors[PRIORS_AT_RANDOM] and any(
        count <= CHOSEN_ANSWERS for count in curve.errors[CHOSEN]
    )


def _counted(many: int, missed: Sequence[str]) -> str:
    return f"{many - len(missed)} of {many}" + (f"; not {'; '.join(missed)}" if missed else "")


def _place(result: AlignmentErrors) -> str:
    return f"{look_of(result.cell.task).label}, noise {result.cell.noise:g}"


def _model(results: Iterable[AlignmentErrors]) -> str:
    return listed(look_of(result.cell.model).label for result in results)
