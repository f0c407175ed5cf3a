import numpy as np
import pytest

from figure_faults import faults
from latentarm.core.figure_style import COLUMN_MM, MM_PER_INCH, TWO_COLUMNS_MM
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.shared_autonomy.cell import (
    METHODS,
    TASKS,
    AutonomyCell,
    AutonomyResult,
    Outcome,
)
from latentarm_research.studies.shared_autonomy.drive import steps_of
from latentarm_research.studies.shared_autonomy.figures import (
    changes_figure,
    expertise_figure,
    learners_figure,
    slopes_figure,
    task_figure,
)
from latentarm_research.studies.shared_autonomy.preset import PRESETS, Preset
from latentarm_research.studies.shared_autonomy.study import MODELS, cells_of
from latentarm_research.studies.study import Request


def results_of(tmp_path, preset, tasks=tuple(TASKS), drives=2):
    """Cells as if they had been measured, with figures that no one could take for each other's."""
    rng = np.random.default_rng(0)

    def outcome(cell, method, person):
        values = rng.uniform(0.1, 1.5, (cell.preset.seeds, drives))
        course = rng.uniform(0.0, 1.0, (cell.preset.seeds, steps_of(person) + 1))
        measures = {"final_state_error": values, "time_s": 8.0 * values}
        return Outcome(method, person, measures, course, course)

    return [
        AutonomyResult(
            cell,
            tuple(outcome(cell, method, person) for method in cell.methods for person in cell.preset.people),
        )
        for cell in cells_of(Request(tmp_path, preset, tasks))
    ]


def words_of(figure):
    texts = figure.findobj(lambda artist: hasattr(artist, "get_text"))
    return {text.get_text() for text in texts if text.get_text() and text.get_visible()}


def assert_well_drawn(figure, width_mm):
    assert faults(figure) == []
    assert figure.get_size_inches()[0] * MM_PER_INCH == pytest.approx(width_mm)
    assert any("simulated" in word for word in words_of(figure))


def test_no_interval_is_cut_at_the_top(tmp_path):
    """The highest of each row of panels that share their axis is in the last one, drawn after the others."""
    preset = PRESETS["smoke"]
    results = results_of(tmp_path, preset)
    for outcome in results[-1].outcomes:
        outcome.figures["final_state_error"][0] += 5.0
    for draw in (expertise_figure, changes_figure, slopes_figure):
        figure = draw(results, preset, tuple(TASKS))
        for axes in figure.axes:
            tops = [
                segment[:, 1].max()
                for container in axes.containers
                for bars in container.lines[2]
                for segment in bars.get_segments()
            ]
            assert axes.get_ylim()[1] >= max(tops, default=0.0)


@pytest.mark.parametrize(
    ("preset", "tasks"),
    [(PRESETS["paper"], tuple(TASKS)), (PRESETS["smoke"], ("panda_two_cups",))],
    ids=["paper", "smoke"],
)
def test_every_figure_fits_its_column_and_names_the_methods(tmp_path, preset, tasks):
    results = results_of(tmp_path, preset, tasks)
    drawings = {
        expertise_figure(results, preset, tasks): COLUMN_MM,
        changes_figure(results, preset, tasks): TWO_COLUMNS_MM,
        learners_figure(results, preset, tasks): TWO_COLUMNS_MM,
        slopes_figure(results, preset, tasks): TWO_COLUMNS_MM,
    }
    for figure, width_mm in drawings.items():
        assert_well_drawn(figure, width_mm)
        words = words_of(figure)
        assert set(METHODS) <= words
        for task in TASKS:
            assert any(look_of(task).label in word for word in words) == (task in tasks)


def test_the_task_is_drawn_with_its_arm_and_both_goals():
    figure = task_figure()
    assert_well_drawn(figure, COLUMN_MM)
    assert {"before the left cup", "before the right cup", "cups"} <= words_of(figure)


def test_conditions_are_told_apart_without_colour():
    for group in (METHODS, TASKS):
        looks = [look_of(name) for name in group]
        for feature in ("label", "colour", "marker", "dash"):
            assert len({getattr(look, feature) for look in looks}) == len(looks)


def test_one_seed_has_no_bars_and_is_drawn_all_the_same(tmp_path):
    preset = Preset("tiny", seeds=1, betas=(0.0, 75.0, 1e4))
    results = results_of(tmp_path, preset, drives=1)
    assert_well_drawn(expertise_figure(results, preset, tuple(TASKS)), COLUMN_MM)
    assert any(result.cell.entropy for result in results)
    assert all(isinstance(result.cell, AutonomyCell) and result.cell.model in MODELS for result in results)
