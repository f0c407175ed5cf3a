"""All figures of a study's report, by name, with their captions."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, final

from latentarm_research.user_studies.answers.scales import Ratings
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.record import Trial
from latentarm_research.user_studies.report import boxes
from latentarm_research.user_studies.report.likert import likert_figure, step_figure
from latentarm_research.user_studies.report.ways import plate_figure, stick_figure, way_figure
from latentarm_research.user_studies.trace import Trace

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@final
@dataclass(frozen=True, eq=False)
class Drawn:
    """A figure of the report."""

    name: str  # of its file, without suffix
    figure: "Figure"  # the drawing
    caption: str  # what it shows, and of whom


def figure_names(definition: Definition) -> tuple[str, ...]:
    """Names of all figures that a study's report may have."""
    tasks = [task.name for task in definition.tasks]
    return (
        "measures",
        "ratings",
        "plates",
        "steps",
        "people",
        *(f"{kind}_{task}" for task in tasks for kind in ("ways", "stick")),
    )


def draw(
    definition: Definition,
    trials: Sequence[Trial],
    traces: Sequence[Trace],
    who: str,  # the people, in words, such as `12 simulated people`
    ratings: Ratings | None = None,
) -> list[Drawn]:
    """Draw what there are figures for; nothing empty is drawn."""
    measured = {name for trial in trials for name in trial.measures}
    shown = [name for name in definition.measures if name in measured]
    found: list[Drawn] = []
    if shown:
        caption = (
            f"Every measure, {who}. Boxes hold the middle half, whiskers end at the 10 and 90 percentiles."
        )
        found.append(Drawn("measures", boxes.box_figure(definition, trials, shown, who), caption))
    if ratings is not None and any(not scale.slider for scale in definition.questionnaire):
        caption = (
            f"Answers to the questionnaire's scales, {who}: shares of all answers; agreement to the right."
        )
        found.append(Drawn("ratings", likert_figure(definition, ratings.rated, who), caption))
    if any(trace.plate_m for trace in traces):
        caption = f"Goal error: distance of the tool from the closest plate in the course of a trial, {who}."
        found.append(Drawn("plates", plate_figure(definition, traces, who), caption))
    if "preference_alignment" in measured and any(trace.aligned for trace in traces):
        caption = (
            f"Preference alignment in each step, {who}: how the tool points, compared with how the step needs"
            " it. Dots are people's means, lines the mean of those who came so far."
        )
        found.append(Drawn("steps", step_figure(definition, traces, who), caption))
    each = boxes.people_measures(measured)
    if each and len({trial.person for trial in trials}) <= boxes.MOST_PEOPLE:
        caption = f"Each of the {who} separately; in the lighter shade the time without input."
        found.append(Drawn("people", boxes.people_figure(definition, trials, each, who), caption))
    for task in definition.tasks:
        if any(trace.task == task.name for trace in traces):
            caption = f"Ways of the tool in {task.label}, {who}. The scene differs from person to person."
            found.append(Drawn(f"ways_{task.name}", way_figure(definition, task, traces, who), caption))
            caption = f"Where the stick was in {task.label}, {who}; rest does not count."
            found.append(Drawn(f"stick_{task.name}", stick_figure(definition, task, traces, who), caption))
    return found
