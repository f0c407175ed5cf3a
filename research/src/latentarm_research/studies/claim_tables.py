"""Tables of hypotheses and of their claims, for every study."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from latentarm.evaluation.measures import label_of
from latentarm.evaluation.table import ABSENT, format_figure
from latentarm_research.studies.claims import Hypothesis, Label, Tested, Verdict, verdict_on
from latentarm_research.studies.page import SMOKE, name_of
from latentarm_research.studies.statistics import CONFIDENCE, LEVEL, format_p
from latentarm_research.studies.tables import plain_table

if TYPE_CHECKING:
    from rich.table import Table

Columns = Mapping[str, Sequence[str]]  # heading -> cells, of a line each


def columns_table(columns: Columns) -> str:
    """A table in Markdown; columns with nothing in any line are left out."""
    shown = {head: cells for head, cells in columns.items() if any(cells) or not cells}
    return plain_table([*shown], list(zip(*shown.values(), strict=True)))


def verdict_columns(verdicts: Sequence[Verdict]) -> Columns:
    """The verdict on each hypothesis, column by column."""
    return {
        "": [one.hypothesis.name for one in verdicts],
        "hypothesis": [one.hypothesis.text for one in verdicts],
        "family": [name_of(one.family) for one in verdicts],
        "task": [name_of(one.task) for one in verdicts],
        "says": [one.says for one in verdicts],
        "why": [one.why for one in verdicts],
    }


def terminal_verdicts(title: str, verdicts: Sequence[Verdict]) -> "list[Table]":
    """The verdicts in a table for a terminal; none without any."""
    from rich.table import Table

    columns = verdict_columns(verdicts)
    shown = {head: cells for head, cells in columns.items() if head != "hypothesis" and any(cells)}
    table = Table(*shown, title=title, title_justify="left")
    for line in zip(*shown.values(), strict=True):
        table.add_row(*line)
    return [table] if verdicts else []


def claim_columns(tested: Sequence[Tested], measure: Label, name: Label, further: Columns) -> Columns:
    """Every claim, its figures and its test; `further` stands before what each claim says."""
    return {
        "": [one.hypothesis for one in tested],
        "claim": [one.claim.worded(measure, name) for one in tested],
        "n": [_numbers(one) for one in tested],
        "subject, mean ± SD": [format_figure(one.mean, one.sd) for one in tested],
        "other, mean ± SD": [format_figure(one.mean_against, one.sd_against) for one in tested],
        f"difference [{CONFIDENCE:.0%}]": [_difference(one) for one in tested],
        "test": [_test(one) for one in tested],
        "p / p, Holm": [
            ABSENT if one.p is None else f"{format_p(one.p)} / {format_p(one.p_holm)}" for one in tested
        ],
        **further,
        "says": [one.says if one.p is not None else f"{one.says} ({one.why_not})" for one in tested],
    }


def claim_table(tested: Sequence[Tested]) -> str:
    """Every claim of a simulation, in Markdown."""
    effects = [None if one.test is None else one.test.g for one in tested]
    further = {
        "family": [name_of(one.family) for one in tested],
        "where": [one.where for one in tested],
        "Hedges' g": [ABSENT if effect is None else f"{effect:.3g}" for effect in effects],
        "apart": [{True: "yes", False: "no", None: ""}[one.apart] for one in tested],
    }
    return columns_table(claim_columns(tested, label_of, name_of, further))


def judged_parts(hypotheses: Iterable[Hypothesis], tested: Sequence[Tested]) -> dict[str, Any]:
    """The hypotheses of a simulation for its page, by the names in the template."""
    return {
        "verdicts": columns_table(verdict_columns(verdicts_by_task(hypotheses, tested))),
        "tests": tested,
        "test_table": claim_table(tested),
        "level": LEVEL,
    }


def verdict_tables(preset: str, hypotheses: Iterable[Hypothesis], tested: Sequence[Tested]) -> "list[Table]":
    """The verdicts on the hypotheses of a simulation, for a terminal; none of a smoke run."""
    verdicts = [] if preset == SMOKE else verdicts_by_task(hypotheses, tested)
    return terminal_verdicts("What the hypotheses come to, simulated", verdicts)


def verdicts_by_task(hypotheses: Iterable[Hypothesis], tested: Sequence[Tested]) -> list[Verdict]:
    """A verdict for each hypothesis on each task in each family, family by family."""
    by_name = {one.name: one for one in hypotheses}
    families = [*dict.fromkeys(one.family for one in tested)]
    places: dict[tuple[str, str, str], list[Tested]] = {}
    for one in tested:
        places.setdefault((one.family, one.hypothesis, one.claim.tasks[0]), []).append(one)
    return [
        replace(verdict_on(by_name[name], here, label_of, name_of), family=family, task=task)
        for (family, name, task), here in sorted(places.items(), key=lambda one: families.index(one[0][0]))
    ]


def _numbers(one: Tested) -> str:
    """Figures on both sides of independent samples, pairs of others."""
    test = one.test
    return f"{test.n} + {test.n_against}" if test is not None and test.n_against else str(one.n)


def _difference(one: Tested) -> str:
    if one.test is None:
        return ABSENT
    low, high = one.test.interval
    return f"{one.test.difference:.3g} [{low:.3g}, {high:.3g}]"


def _test(one: Tested) -> str:
    if one.p is None:
        return ABSENT
    if one.test is None or one.claim.margin is not None:
        return one.method
    return f"{one.method}({one.test.dof:.3g}) = {one.test.t:.2f}"
