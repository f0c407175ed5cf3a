"""The report of a study that people went through, simulated or real ones."""

from collections.abc import Sequence
from typing import Final

from rich.table import Table

from latentarm.core.types import Row
from latentarm.evaluation.summary import Subject, summarise
from latentarm_research.studies.study import Report
from latentarm_research.user_studies.analysis.analysis import analyse
from latentarm_research.user_studies.analysis.means import person_mean
from latentarm_research.user_studies.answers.scales import Ratings
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.record import Trial
from latentarm_research.user_studies.recorded import Recorded
from latentarm_research.user_studies.report.figures import draw
from latentarm_research.user_studies.report.page import Content, report_page

ANALYSIS: Final = "analysis.json"
RATINGS: Final = "ratings.json"


def report_of(recorded: Recorded, command: str, ratings: Ratings | None = None) -> Report:
    """Analyse trials, and report them."""
    definition = recorded.definition
    scores = () if ratings is None else ratings.scores
    analysis = analyse(definition, recorded.trials, scores, recorded.sizes.not_judged)
    rows = rows_of(definition, analysis.trials)
    figures = draw(definition, analysis.trials, recorded.traces, recorded.who, ratings)
    verdicts = Table("", "says", "why", title=f"{definition.title}: {recorded.who}")
    for one in analysis.verdicts:
        verdicts.add_row(one.hypothesis.name, one.says, one.why)
    return Report(
        rows=rows,
        page=report_page(Content(recorded, analysis, rows, figures, command, ratings)),
        figures={one.name: one.figure for one in figures},
        tests=analysis.claims,
        documents={
            ANALYSIS: analysis.as_json(),
            **({} if ratings is None else {RATINGS: ratings.as_json()}),
        },
        tables=[verdicts],
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
