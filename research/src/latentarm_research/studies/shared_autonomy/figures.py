"""The study's figures: those of the paper, learners by slope, and the tasks."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.figure_style import COLUMN_MM, FONT_SIZE, new_figure, tidy
from latentarm.core.types import FloatArray
from latentarm.evaluation.looks import look_of
from latentarm_research.drives.arm_figure import draw_arm, frame
from latentarm_research.drives.drive_figures import GOAL_COLOURS, GOAL_MARKERS
from latentarm_research.studies import drawing
from latentarm_research.studies.shared_autonomy import tables
from latentarm_research.studies.shared_autonomy.cell import METHODS, AutonomyResult, Outcome
from latentarm_research.studies.shared_autonomy.drive import STEP_S
from latentarm_research.studies.shared_autonomy.hypotheses import MEASURE
from latentarm_research.studies.shared_autonomy.preset import (
    Preset,
    changing,
    learner,
    of_fixed_expertise,
)
from latentarm_research.tasks.two_cups import BEARING_RAD, PandaTwoCups, Place, TwoCups

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Drawing
    from mpl_toolkits.mplot3d.axes3d import Axes3D

EXPERTISE_MM: Final = 88.0
CHANGES_ROW_MM: Final = 46.0
ROW_MM: Final = 44.0
FRAME_MM: Final = 14.0
TASK_MM: Final = 74.0

NUDGE: Final = 0.015  # offset between methods as a share of the axis' width, so that no bar hides another
EXPERTISE_MEASURES: Final = {"final_state_error": "final state error", "time_s": "time to the goal (s)"}
COURSES: Final = {"error": "state error", "belief": "belief in the true goal"}
RATIONALITIES: Final = {1000.0: "$10^3$", 10000.0: "$10^4$"}  # numbers that would be too long for an axis
DRAWN: Final = 12  # demonstrations that are drawn
STREAM: Final = 82  # keeps them apart from those of the study; they are always the same

AT_THE_CUP: Final = Place(back=0.0, left=0.0, up=0.0, turn=0.0)


Outcomes = dict[tuple[str, str], Outcome]  # outcomes by method and person


def expertise_figure(results: Sequence[AutonomyResult], preset: Preset, tasks: Sequence[str]) -> "Drawing":
    """Final error and time over rationality, a column per arm, as in the paper's figure 9."""
    heading = "Fixed expertise, mean with 95 % interval; simulated"
    size = len(EXPERTISE_MEASURES), len(tasks), 0.0, EXPERTISE_MM
    figure, panels = drawing.panel_grid(heading, *size, width_mm=COLUMN_MM, sharex=True, sharey="row")
    people = [of_fixed_expertise(beta).label for beta in preset.betas]
    named = np.arange(0, len(people), 1 if len(people) < 5 else 2)
    for column, task in zip(panels.T, tasks, strict=True):
        outcomes = outcomes_of(results, task, tables.MODEL)
        drawing.title(column[0], look_of(task).label)
        for axes, measure in zip(column, EXPERTISE_MEASURES, strict=True):
            draw_over(axes, outcomes, people, measure)
            tidy(axes)
        names = [RATIONALITIES.get(preset.betas[place], f"{preset.betas[place]:g}") for place in named]
        column[-1].set_xticks(named, names)
    _from_zero(panels.flat)
    drawing.label_axes(panels[-1], x="rationality β (1/m²)")
    for axes, name in zip(panels[:, 0], EXPERTISE_MEASURES.values(), strict=True):
        drawing.label_axes([axes], y=name)
    drawing.name_series(figure, panels[0, 0])
    return figure


def changes_figure(results: Sequence[AutonomyResult], preset: Preset, tasks: Sequence[str]) -> "Drawing":
    """Final error over the time of a change; belief over time for two, as in the paper's figure 10."""
    heading = "People who change their mind about the cup, mean with 95 % interval; people and arms simulated"
    drawn = preset.drawn_changes_s
    figure, panels = drawing.panel_grid(
        heading, len(tasks), 1 + len(drawn), CHANGES_ROW_MM, FRAME_MM, sharex="col"
    )
    for (error, *beliefs), task in zip(panels, tasks, strict=True):
        outcomes = outcomes_of(results, task, tables.MODEL)
        _draw_changes(error, outcomes, preset)
        _from_zero([error])
        drawing.title(error, look_of(task).label)
        drawing.label_axes([error], y="final state error")
        for axes, after_s in zip(beliefs, drawn, strict=True):
            draw_course(axes, outcomes, changing(after_s).label, "belief")
            axes.axvline(after_s, color="black", linestyle=":", linewidth=1.0, label="change of mind")
            drawing.title(axes, f"change after {after_s:g} s")
            axes.set_ylim(-0.03, 1.03)
            drawing.label_axes([axes], y="belief in the true goal")
            tidy(axes)
    drawing.label_axes(panels[-1, :1], x="change after (s)")
    drawing.label_axes(panels[-1, 1:], x="time (s)")
    drawing.name_series(figure, *panels[0])
    return figure


def learners_figure(results: Sequence[AutonomyResult], preset: Preset, tasks: Sequence[str]) -> "Drawing":
    """State error and belief of people who learn over time, a row per arm, as in the paper's figure 11."""
    heading = "People who learn while they drive, β = m t, mean with 95 % interval; people and arms simulated"
    columns = [(what, name) for what in COURSES for name in preset.learners]
    figure, panels = drawing.panel_grid(heading, len(tasks), len(columns), ROW_MM, FRAME_MM, sharex=True)
    for line, task in zip(panels, tasks, strict=True):
        outcomes = outcomes_of(results, task, tables.MODEL)
        for axes, (what, name) in zip(line, columns, strict=True):
            draw_course(axes, outcomes, learner(name, preset.learners[name]).label, what)
            drawing.title(axes, f"{look_of(task).label}, {name}")
            drawing.label_axes([axes], y=COURSES[what])
            tidy(axes)
    for what in COURSES:
        alike = list(panels[:, [place for place, column in enumerate(columns) if column[0] == what]].flat)
        top = max(axes.get_ylim()[1] for axes in alike) if what == "error" else 1.03
        for axes in alike:
            axes.set_ylim(0.0 if what == "error" else -0.03, top)
    drawing.label_axes(panels[-1], x="time (s)")
    drawing.name_series(figure, panels[0, 0])
    return figure


def slopes_figure(results: Sequence[AutonomyResult], preset: Preset, tasks: Sequence[str]) -> "Drawing":
    """Final error over the slope of learning, a row per arm and a column per model."""
    heading = (
        "Learners, β = m t, by slope with each model, mean with 95 % interval; people and arms simulated"
    )
    people = preset.by_slope
    models = list(dict.fromkeys(result.cell.model for result in results))
    figure, panels = drawing.panel_grid(
        heading, len(tasks), len(models), ROW_MM, FRAME_MM, sharex=True, sharey=True
    )
    for line, task in zip(panels, tasks, strict=True):
        for axes, model in zip(line, models, strict=True):
            outcomes = outcomes_of(results, task, model)
            draw_over(axes, outcomes, [person.label for person in people.values()], MEASURE)
            axes.set_xticks(np.arange(len(people)), [f"{slope:.3g}" for slope in people])
            tidy(axes)
            drawing.title(axes, f"{look_of(model).label}, {look_of(task).label}")
    _from_zero(panels.flat)
    drawing.label_axes(panels[:, 0], y="final state error")
    drawing.label_axes(panels[-1], x="slope m (1/m² per s)")
    drawing.name_series(figure, panels[0, 0])
    return figure


def task_figure() -> "Drawing":
    """The Panda at its start, the goals before the cups and where the tool goes from there."""
    task = PandaTwoCups()
    figure = new_figure(TASK_MM)
    figure.suptitle(f"Two cups, {look_of(task.name).label}; all simulated", fontsize=FONT_SIZE)
    demonstrations = task.demonstrate(DRAWN, np.random.default_rng(STREAM))
    chain = task.robot.chain
    paths = [chain.forward(episode.state).position for episode in demonstrations.episodes]
    goals = np.stack([goal.pose.position for goal in task.goals])
    nearest = [int(np.linalg.norm(path[:, None] - goals, axis=-1).min(axis=0).argmin()) for path in paths]
    axes: Axes3D = figure.add_subplot(projection="3d", computed_zorder=False)
    places = draw_arm(axes, task.robot, task.start)
    _draw_paths(axes, task, paths, nearest)
    frame(axes, np.concatenate([places, *paths]))
    drawing.name_series(figure, figure.axes[0], handle_length=1.0)
    return figure


def _draw_paths(axes: "Axes3D", task: TwoCups, paths: list[FloatArray], led_to: list[int]) -> None:
    """Paths (T, 3) in the colour of the cup that they lead to, and the goals."""
    for path, cup in zip(paths, led_to, strict=True):
        axes.plot(*path.T, color=GOAL_COLOURS[cup], linestyle=("-", "--")[cup], linewidth=0.8, zorder=4)
    for cup, goal in enumerate(task.goals):
        axes.plot(
            *goal.pose.position[:, None],
            color=GOAL_COLOURS[cup],
            marker=GOAL_MARKERS[cup],
            markeredgecolor="black",
            markersize=4.0,
            linestyle="none",
            label=f"before the {goal.name}",
            zorder=5,
        )
    cups = np.stack([task.pose(bearing, AT_THE_CUP).position for bearing in (BEARING_RAD, -BEARING_RAD)])
    axes.plot(
        *cups.T,
        color="black",
        marker="o",
        markerfacecolor="none",
        markersize=9.0,
        linestyle="none",
        label="cups",
        zorder=3.5,
    )


def outcomes_of(results: Sequence[AutonomyResult], task: str, model: str) -> Outcomes:
    """Outcomes with one model on one arm."""
    return {
        (one.method, one.person.label): one
        for result in results
        if (result.cell.task, result.cell.model) == (task, model)
        for one in result.outcomes
    }


def draw_over(
    axes: "Axes",
    outcomes: Outcomes,
    people: Sequence[str],
    measure: str,
    at: FloatArray | None = None,  # (N,), where each person stands; one after another, evenly, where None
) -> None:
    """Mean and 95 % interval of a measure over people, one line per method."""
    places = np.arange(len(people), dtype=float) if at is None else at
    shift = NUDGE * float(np.ptp(places))
    for index, method in enumerate(METHODS):
        if (method, people[0]) in outcomes:
            found = [tables.interval(outcomes[method, person].figures[measure]) for person in people]
            look = look_of(method)
            axes.errorbar(
                places + (index - 1) * shift,
                [one.mean for one in found],
                yerr=[one.half_width for one in found],
                color=look.colour,
                marker=look.marker,
                linestyle=look.dash,
                label=look.label,
                markersize=3.6,
                linewidth=1.1,
                elinewidth=0.8,
                zorder=3 + index,
            )


def draw_course(axes: "Axes", outcomes: Outcomes, person: str, what: str) -> None:
    """State error or belief over time, one line per method with its 95 % interval as a band."""
    for index, method in enumerate(METHODS):
        if (method, person) not in outcomes:
            continue
        mean, low, high = tables.band(getattr(outcomes[method, person], what))
        time_s = STEP_S * np.arange(len(mean))
        look = look_of(method)
        axes.fill_between(time_s, low, high, color=look.colour, alpha=0.2, linewidth=0.0)
        every = max(len(mean) // 5, 1)
        axes.plot(
            time_s,
            mean,
            color=look.colour,
            linestyle=look.dash,
            linewidth=1.1,
            marker=look.marker,
            markersize=3.4,
            # Each method's markers stand elsewhere, so that lines on top of each other are seen.
            markevery=(every * (index + 1) // 4, every),
            label=look.label,
            zorder=3 + index,
        )


def _draw_changes(axes: "Axes", outcomes: Outcomes, preset: Preset) -> None:
    """Final error over the time of the change."""
    people = [changing(after_s).label for after_s in preset.changes_s]
    draw_over(axes, outcomes, people, "final_state_error", np.array(preset.changes_s))
    tidy(axes)


def _from_zero(panels: "Iterable[Axes]") -> None:
    """Begin the y axes at zero, once all is drawn: a limit ends the fitting of panels that share it."""
    for axes in panels:
        axes.set_ylim(bottom=0.0)
