"""The report of a study that people went through, simulated or real: analysis, rows, figures and page."""

from collections import Counter
from collections.abc import Sequence
from typing import Final

from latentarm.core.types import Row
from latentarm.evaluation.summary import Subject, summarise
from latentarm.evaluation.table import ABSENT, format_figure
from latentarm_research.studies.claim_tables import columns_table, terminal_verdicts, verdict_columns
from latentarm_research.studies.page import render_page
from latentarm_research.studies.statistics import format_p
from latentarm_research.studies.study import Report
from latentarm_research.studies.tables import heading, listed
from latentarm_research.user_studies.analysis.analysis import Analysis, analyse
from latentarm_research.user_studies.analysis.means import person_mean
from latentarm_research.user_studies.answers.scales import Ratings
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.hypothesis import WRONG
from latentarm_research.user_studies.record import Trial
from latentarm_research.user_studies.recorded import Recorded
from latentarm_research.user_studies.report.figures import Drawn, draw
from latentarm_research.user_studies.report.people import (
    consent_words,
    input_words,
    participant_lines,
    practice_words,
)
from latentarm_research.user_studies.report.words import (
    DESIGN_WORDS,
    NOTICE,
    PEOPLE_HEAD,
    QUOTED,
    UNASKED,
    claim_table,
    condition_parts,
    exclusion_words,
    order_words,
    people_lines,
    task_words,
    yes_no,
)

RATED_HEAD: Final = ("scale", "condition", "people", "score, mean ± SD", "Cronbach's α [95 %]")


def _page(
    recorded: Recorded,
    analysis: Analysis,
    rows: Sequence[Row],
    figures: Sequence[Drawn],
    command: str,  # that repeats the run
    ratings: Ratings | None,
    departures: Sequence[str] | None,
) -> str:
    """The page, Markdown."""
    definition, notice = recorded.definition, NOTICE[recorded.people_are]
    return render_page(
        "user_studies/report/page.md",
        recorded.sizes,
        definition=definition,
        who=recorded.who,
        command=command,
        notice=f"{notice} {QUOTED}" if definition.printed else notice,
        design=DESIGN_WORDS[definition.design],
        input=input_words(recorded),
        practice=practice_words(recorded),
        consent=consent_words(recorded),
        participant_lines=participant_lines(recorded),
        order_words=order_words(definition),
        verdict_table=columns_table(verdict_columns(analysis.verdicts)),
        condition_lines=[(one.name, one.about, *condition_parts(one)) for one in definition.conditions],
        task_lines=[task_words(recorded.sizes.as_run(task)) for task in definition.tasks],
        exclusion_lines=exclusion_words(definition),
        excluded_words=_excluded_words(analysis, recorded.who),
        people_head=PEOPLE_HEAD,
        people_lines=people_lines(recorded.simulated) if recorded.simulated else [],
        result_head=["task", "measure", *(one.name for one in definition.conditions)],
        result_lines=_result_lines(definition, rows),
        figures=figures,
        claim_table=claim_table(definition, analysis.claims),
        anova_lines=_anova_lines(definition, analysis),
        printed_lines=_printed_lines(definition, analysis),
        wrong_lines=_wrong_lines(analysis),
        questionnaire_words=UNASKED[recorded.people_are]
        if ratings is None
        else _questionnaire_words(ratings),
        rated_head=RATED_HEAD,
        rated_lines=_rated_lines(definition, ratings),
        item_lines=_item_lines(definition),
        chosen_head=["question", "option", *(one.name for one in definition.conditions)],
        chosen_lines=_chosen_lines(definition, ratings),
        in_words_lines=_in_words_lines(recorded),
        departures=departures,
    )


def _excluded_words(analysis: Analysis, who: str) -> str:
    trials, people = len(analysis.excluded.trials), len(analysis.excluded.people)
    return f"Of {who}, {trials} trials and {people} people are excluded; {len(analysis.trials)} trials count."


def _result_lines(definition: Definition, rows: Sequence[Row]) -> list[list[str]]:
    labels = {task.name: task.label for task in definition.tasks}
    places = dict.fromkeys((row.task or "", row.measure) for row in rows)
    found = {(row.task or "", row.measure, row.condition): row for row in rows}
    lines: list[list[str]] = []
    for task, measure in places:
        name = heading(measure, definition.label(measure))
        shown = [found.get((task, measure, one.name)) for one in definition.conditions]
        cells = [ABSENT if row is None else format_figure(row.mean, row.sd) for row in shown]
        lines.append([labels[task], name, *cells])
    return lines


def _anova_lines(definition: Definition, analysis: Analysis) -> list[tuple[str, ...]]:
    return [
        (
            definition.label(measure),
            effect.name,
            f"F({effect.dof}, {effect.dof_error}) = {effect.f:.2f}",
            format_p(effect.p),
            f"{effect.eta:.2f}",
        )
        for measure, effects in analysis.effects.items()
        for effect in effects
    ]


def _printed_lines(definition: Definition, analysis: Analysis) -> list[tuple[str, ...]]:
    labels = {task.name: task.label for task in definition.tasks}
    lines: list[tuple[str, ...]] = []
    for one in analysis.as_printed:
        printed = one.printed
        where = f" ({listed(labels[task] for task in printed.tasks)})" if printed.tasks else ""
        sides = [listed(side) for side in (printed.subject, printed.against) if side]
        lines.append(
            (
                definition.label(printed.measure) + where,
                " against ".join(sides),
                printed.text,
                one.text,
                yes_no(one.same_sign),
                yes_no(one.same_significance),
            )
        )
    return lines


def _wrong_lines(analysis: Analysis) -> list[str]:
    """What is wrong with each way in which the paper got a statistic, after these statistics."""
    texts: dict[str, list[str]] = {}
    for one in analysis.as_printed:
        texts.setdefault(WRONG[one.printed.test], []).append(one.printed.text)
    return [f"{listed(printed)}: {wrong}" for wrong, printed in texts.items()]


def _questionnaire_words(ratings: Ratings) -> str:
    return (
        f"{ratings.answers} answers. A score is the mean of a scale's items, reversed ones turned; a"
        " person who left out an item of a scale has no score of it. Alpha is computed over the people of one"
        " condition, its interval is that of Feldt (1965)."
    )


def _rated_lines(definition: Definition, ratings: Ratings | None) -> list[tuple[str, ...]]:
    return [
        (
            definition.label(one.scale),
            one.condition,
            str(one.n),
            format_figure(one.mean, one.sd),
            ABSENT if one.alpha is None else f"{one.alpha:.2f} [{one.alpha_low:.2f}, {one.alpha_high:.2f}]",
        )
        for one in (() if ratings is None else ratings.rated)
    ]


def _chosen_lines(definition: Definition, ratings: Ratings | None) -> list[list[str]]:
    found = {(one.question, one.condition): one for one in (() if ratings is None else ratings.chosen)}
    lines: list[list[str]] = []
    for question in definition.with_options:
        shown = [found.get((question.name, one.name)) for one in definition.conditions]
        for number, option in enumerate(question.options, start=1):
            cells = [
                f"{one.counts[number - 1]} of {one.n}" if one is not None and one.n else ABSENT
                for one in shown
            ]
            checks = " (attention check)" if number == question.attention else ""
            lines.append([question.text, f"{option}{checks}", *cells])
    return lines


def _item_lines(definition: Definition) -> list[tuple[str, str, str]]:
    return [
        (
            scale.label,
            f"1: {scale.low}; {scale.points}: {scale.high}{'; slider' if scale.slider else ''}",
            " · ".join(f"{item.text}{' (r)' if item.reversed else ''}" for item in scale.items),
        )
        for scale in definition.questionnaire
    ]


def _in_words_lines(recorded: Recorded) -> list[str]:
    counts = Counter(one.item for one in recorded.answers)
    return [
        f"Asked in words: {one.text} Answers: {counts[one.name]}; latentarm study export writes them."
        for one in recorded.definition.in_words
    ]


ANALYSIS: Final = "analysis.json"
RATINGS: Final = "ratings.json"


def report_of(
    recorded: Recorded,
    command: str,
    ratings: Ratings | None = None,
    departures: Sequence[str] | None = None,  # from the preregistration; None without one
) -> Report:
    """Analyse trials, and report them."""
    definition = recorded.definition
    scores = () if ratings is None else ratings.scores
    analysis = analyse(definition, recorded.trials, scores, recorded.sizes.not_judged)
    rows = rows_of(definition, analysis.trials)
    figures = draw(definition, analysis.trials, recorded.traces, recorded.who, ratings)
    return Report(
        rows=rows,
        page=_page(recorded, analysis, rows, figures, command, ratings, departures),
        figures={one.name: one.figure for one in figures},
        tests=analysis.claims,
        documents={
            ANALYSIS: analysis.as_json(),
            **({} if ratings is None else {RATINGS: ratings.as_json()}),
        },
        tables=terminal_verdicts(f"{definition.title}: {recorded.who}", analysis.verdicts),
    )


def rows_of(definition: Definition, trials: Sequence[Trial]) -> list[Row]:
    """Mean and SD over people of their means, for every task, condition and measure that has figures."""
    people = sorted({trial.person for trial in trials})
    rows: list[Row] = []
    for task in definition.tasks:
        for condition in definition.conditions:
            subject = Subject(definition.study, task=task.name, condition=condition.name)
            for measure in definition.measures:
                means = [
                    person_mean(trials, person, measure, (condition.name,), (task.name,)) for person in people
                ]
                row = summarise(subject, measure, means)
                if row.n:
                    rows.append(row)
    return rows
