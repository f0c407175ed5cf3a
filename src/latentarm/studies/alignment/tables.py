"""The study's tables in Markdown."""

from collections.abc import Sequence

from latentarm.metrics.looks import look_of
from latentarm.metrics.table import ABSENT, format_figure
from latentarm.studies.alignment.cell import CellResult
from latentarm.studies.alignment.conditions import CONDITIONS
from latentarm.studies.alignment.curves import CHOICES, CurveResult
from latentarm.studies.alignment.hypotheses import Comparison
from latentarm.studies.alignment.rows import ENCODED
from latentarm.studies.alignment.targets import Target
from latentarm.studies.page import markdown_table
from latentarm.studies.statistics import format_p
from latentarm.types import FloatArray


def condition_table(results: Sequence[CellResult]) -> str:
    """The relative errors of one task and model: conditions down, noises across."""
    lines = [[name, *(_mean_and_sd(result.errors[name]) for result in results)] for name in CONDITIONS]
    encoded = [ENCODED, *(format_figure(result.encoded, None) for result in results)]
    head = ["relative error, simulated", *(f"noise {result.cell.noise:g}" for result in results)]
    return markdown_table(head, [*lines, encoded])


def curve_table(curve: CurveResult) -> str:
    """One task, model and noise: numbers of answers down, choices of questions across."""
    counts = sorted({count for errors in curve.errors.values() for count in errors})
    lines = [
        [
            str(count),
            *(
                _mean_and_sd(curve.errors[choice][count]) if count in curve.errors[choice] else ABSENT
                for choice in CHOICES
            ),
        ]
        for count in counts
    ]
    return markdown_table(["answers", *CHOICES], lines)


def stopping_table(curves: Sequence[CurveResult]) -> str:
    """Where asking by novelty stops, and the error there."""
    head = ["", "model", "noise", "answers", "relative error"]
    lines = [
        [
            look_of(curve.cell.learned.cell.task).label,
            look_of(curve.cell.learned.cell.model).label,
            f"{curve.cell.noise:g}",
            _mean_and_sd(curve.stopped_after),
            _mean_and_sd(curve.stopped_at),
        ]
        for curve in curves
    ]
    return markdown_table(head, lines)


def target_table(found: Sequence[Target]) -> str:
    """Every target."""
    lines = [[one.name, "met" if one.met else "**missed**", one.figures] for one in found]
    return markdown_table(["target", "", "figures"], lines)


def comparison_table(comparisons: Sequence[Comparison]) -> str:
    """Every test of the hypotheses."""
    head = ["", "task", "model", "noise", "condition", "below", "test", "t (dof)", "p, Holm", "Hedges' g"]
    return markdown_table([*head, "holds"], [_test_line(one) for one in comparisons])


def _test_line(one: Comparison) -> list[str]:
    statistic = ABSENT if one.t is None or one.dof is None else f"{one.t:.3g} ({one.dof:.3g})"
    against = one.against if one.times == 1 else f"{one.times:g} times {one.against}"
    return [
        one.hypothesis,
        look_of(one.task).label,
        look_of(one.model).label,
        f"{one.noise:g}",
        f"{one.condition} {one.mean:.3g}",
        f"{against} {one.mean_against:.3g}",
        one.test,
        statistic,
        format_p(one.p_holm),
        ABSENT if one.hedges_g is None else f"{one.hedges_g:.3g}",
        "yes" if one.holds else "no",
    ]


def _mean_and_sd(values: FloatArray) -> str:
    return format_figure(float(values.mean()), float(values.std(ddof=1)) if len(values) > 1 else None)
