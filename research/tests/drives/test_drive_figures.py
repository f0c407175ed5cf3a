from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from latentarm.tasks.table_top import TableTop
from latentarm_research.drives.drive_figures import draw_drives, draw_inputs, marks_of_goals, median_drive
from latentarm_research.drives.trace import Trace
from latentarm_research.metrics.ending import Ending
from made_drives import drive_of


def trace(duration_s: float = 2.0, success: bool = True, modes: int = 1) -> Trace:
    time_s = np.arange(0.0, duration_s, 0.1)
    steps = len(time_s)
    position = np.stack([0.3 + 0.1 * time_s, -0.1 * time_s, 0.5 - 0.1 * time_s], axis=-1)
    return Trace(
        figures=drive_of(success, time_s=duration_s),
        choice=0,
        text="stab carrot",
        steps=(),
        done_s=(),
        target=np.zeros(3),
        ending=Ending("done", "done"),
        time_s=time_s,
        position=position,
        input=np.sin(time_s[:, None] + np.arange(2)),
        delay_s=np.full(steps, np.nan),
        mode=np.arange(steps) * modes // steps,
        belief=np.full((steps, 3), 1 / 3),
        aligned=(),
        states=(),
    )


@pytest.fixture
def saved(monkeypatch):
    """Figures as they were when they were saved."""
    figures: list[Figure] = []
    monkeypatch.setattr(
        "latentarm_research.drives.drive_figures.save_figure", lambda figure, path: figures.append(figure)
    )
    return figures


def legends(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


@pytest.mark.parametrize("conditions", [["latent"], ["latent", "latent_assist", "end_effector"]])
def test_six_goals_and_both_outcomes_fit_under_one_column(conditions, tmp_path):
    task = TableTop()
    goals = tuple(replace(task.goals[0], name=f"a rather long name {index}") for index in range(6))

    draw_drives(
        {name: [trace(), trace(success=False)] for name in conditions},
        marks_of_goals(goals),
        tmp_path / "p.png",
    )
    assert (tmp_path / "p.png").exists()


def test_the_legend_names_goals_and_lines(saved, tmp_path):
    draw_drives({"latent": [trace(success=False)]}, marks_of_goals(TableTop().goals), tmp_path / "paths.png")
    assert legends(saved[0]) == ["carrot", "tofu", "melon", "goal reached", "goal not reached"]


def test_the_typical_drive_is_drawn_and_its_mode_switches_are_named(saved, tmp_path):
    lengths = [9.0, 2.0, 3.0, 60.0, 1.0]
    drives = [trace(length, modes=3) for length in lengths]
    assert median_drive(drives) is drives[2]
    assert median_drive(drives[:4]) is drives[2]
    draw_inputs({"end_effector": drives}, tmp_path / "inputs.png")
    (figure,) = saved
    (axes,) = figure.axes
    assert (
        axes.get_title("left") == "mode switching: done after 2.9 s, the median of 5 drives; 2 mode switches"
    )
    assert legends(figure) == ["axis 1", "axis 2", "mode switch"]


def test_inputs_are_well_drawn(tmp_path):
    draw_inputs({"latent": [trace()], "end_effector": [trace(modes=2)]}, tmp_path / "inputs.png")
    assert (tmp_path / "inputs.png").exists()
