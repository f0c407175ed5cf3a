"""The study's tables in Markdown."""

from collections.abc import Iterable, Sequence

from latentarm.metrics.measures import label_of, unit_of
from latentarm.metrics.table import ABSENT, format_figure
from latentarm.studies.pages import markdown_table
from latentarm.studies.shared_autonomy.ablations import variants
from latentarm.studies.shared_autonomy.cell import METHODS
from latentarm.studies.shared_autonomy.hypotheses import Comparison
from latentarm.studies.shared_autonomy.paper import EXTRA_TIME, PAPER
from latentarm.studies.shared_autonomy.preset import Preset
from latentarm.studies.shared_autonomy.rows import RECONSTRUCTION, Figure
from latentarm.studies.statistics import format_p
from latentarm.style import look_of

Found = dict[tuple[str, str, str, str], Figure]
"""Figures by task, model, condition and measure."""


def by_place(found: Iterable[Figure]) -> Found:
    """Figures by what they are of."""
    return {(one.task, one.model, one.condition, one.measure): one for one in found}


def measure_of(name: str) -> str:
    """A measure and its unit as people read them."""
    unit = unit_of(name)
    return label_of(name) if unit == "1" else f"{label_of(name)} ({unit})"


def people_table(found: Found, task: str, model: str, people: Sequence[str], measure: str) -> str:
    """One measure with one model: people down, methods across."""
    lines = [
        [person, *(_figure(found, task, model, f"{method}, {person}", measure) for method in METHODS)]
        for person in people
    ]
    return markdown_table([measure_of(measure), *METHODS], lines)


def extra_time_table(found: Found, task: str, models: Sequence[str], people: Sequence[str]) -> str:
    """How much more time LA takes than LA+SA, with the paper's figures."""
    head = [measure_of(EXTRA_TIME), *(look_of(model).label for model in models)]
    lines = [[person, *(_extra_time(found, task, model, person) for model in models)] for person in people]
    return markdown_table(head, lines)


def reconstruction_table(found: Found, tasks: Sequence[str], models: Sequence[str]) -> str:
    """Reconstruction without entropy and with it."""
    kinds = ("without entropy", "with entropy")
    names = [f"{look_of(model).label}, {kind}" for model in models for kind in kinds]
    lines = [
        [
            look_of(task).label,
            *(_figure(found, task, model, kind, RECONSTRUCTION) for model in models for kind in kinds),
        ]
        for task in tasks
    ]
    return markdown_table([measure_of(RECONSTRUCTION), *names], lines)


def ablation_table(found: Found, task: str, model: str, preset: Preset, people: Sequence[str]) -> str:
    """What is varied about the entropy: variants down, reconstruction and final errors across."""
    if preset.ablation is None:
        return ""
    measure = "final_state_error"
    head = ["", measure_of(RECONSTRUCTION), *(f"{measure_of(measure)}, {person}" for person in people)]
    lines = [
        [
            name,
            _figure(found, task, model, name, RECONSTRUCTION),
            *(_figure(found, task, model, f"{name}, {person}", measure) for person in people),
        ]
        for name in variants(preset.ablation, preset.entropy_weights[model])
    ]
    return markdown_table(head, lines)


def comparison_table(comparisons: Sequence[Comparison]) -> str:
    """Every test of the hypotheses."""
    head = ["", "arm", "model", "person", "method", "against", "test", "t (dof)", "p, Holm", "Hedges' g"]
    return markdown_table([*head, "apart", "holds"], [_test_line(one) for one in comparisons])


def _figure(found: Found, task: str, model: str, condition: str, measure: str) -> str:
    one = found.get((task, model, condition, measure))
    return ABSENT if one is None else format_figure(one.interval.mean, one.interval.half_width)


def _extra_time(found: Found, task: str, model: str, person: str) -> str:
    printed = PAPER.get((task, model, EXTRA_TIME, person))
    beside = "" if printed is None else f" (paper: {printed:g})"
    return _figure(found, task, model, person, EXTRA_TIME) + beside


def _test_line(one: Comparison) -> list[str]:
    side = {"less": "<", "greater": ">"}[one.direction]
    statistic = ABSENT if one.t is None or one.dof is None else f"{one.t:.3g} ({one.dof:.3g})"
    against = (
        f"{one.mean_against:g}"
        if one.against is None
        else (f"{one.against} {format_figure(one.mean_against, one.half_width_against)}")
    )
    return [
        one.hypothesis,
        look_of(one.task).label,
        look_of(one.model).label,
        one.person,
        f"{one.method} {format_figure(one.mean, one.half_width)}",
        f"{side} {against}",
        one.test,
        statistic,
        format_p(one.p_holm),
        ABSENT if one.hedges_g is None else f"{one.hedges_g:.3g}",
        "yes" if one.apart else "no",
        "yes" if one.holds else "no",
    ]
