import numpy as np
import pytest

from figure_faults import faults
from latentarm.core.figure_style import MM_PER_INCH, TWO_COLUMNS_MM
from latentarm.evaluation.looks import look_of
from latentarm_research.studies.alignment.figures import conditions_figure
from latentarm_research.studies.alignment.preset import CONDITIONS
from latentarm_research.tasks.pouring.tasks import POURING_TASKS

TASKS = tuple(POURING_TASKS)
NOISES = (0.0, 0.1, 0.5)


def words_of(figure):
    texts = figure.findobj(lambda artist: hasattr(artist, "get_text"))
    return {text.get_text() for text in texts if text.get_text() and text.get_visible()}


def assert_well_drawn(figure):
    assert faults(figure) == []
    assert figure.get_size_inches()[0] * MM_PER_INCH == pytest.approx(TWO_COLUMNS_MM)
    assert any("simulated" in word for word in words_of(figure))


@pytest.mark.parametrize("spread", [0.02, 0.9])
def test_every_condition_has_points_with_intervals_in_every_panel(result, spread):
    results = [result(task=task, noise=noise, spread=spread) for task in TASKS for noise in NOISES]
    figure = conditions_figure(results, TASKS, NOISES)
    assert_well_drawn(figure)
    assert {*CONDITIONS, "the encoder's own choice", "0.1"} <= words_of(figure)
    assert len(figure.axes) == len(TASKS)
    for axes in figure.axes:
        assert axes.get_yscale() == "log"
        assert len(axes.containers) == len(CONDITIONS)
        for points, _, (bars,) in axes.containers:
            assert len(points.get_xdata()) == len(NOISES)
            low, high = np.array(bars.get_segments())[..., 1].T
            assert (low > 0).all()
            assert (low <= points.get_ydata()).all()
            assert (points.get_ydata() <= high).all()


def test_one_run_has_bars_without_spread(result):
    assert_well_drawn(conditions_figure([result(runs=1)], ["plane"], [0.0]))


def test_conditions_are_told_apart_without_colour():
    for group in (CONDITIONS, TASKS):
        looks = [look_of(name) for name in group]
        assert len({look.colour for look in looks}) == len(looks)
        assert len({(look.marker, look.dash) for look in looks}) == len(looks)
