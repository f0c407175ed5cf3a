import numpy as np
import pytest

from figure_faults import faults
from latentarm.core.figure_style import legend_below, new_figure


def fine():
    figure = new_figure(50.0)
    axes = figure.subplots()
    axes.plot([0, 1], [0, 1], ":", label="dotted")
    axes.set_ylabel("belief")
    axes.fill_between([0, 1], [0, 0], [1, 1])
    legend_below(figure, *axes.get_legend_handles_labels())
    return figure, axes


def test_a_fine_figure_has_no_fault():
    assert faults(fine()[0]) == []


def test_a_legend_with_long_names_is_put_into_as_many_rows_as_it_needs():
    figure, axes = fine()
    labels = [f"a name that takes a lot of room {index}" for index in range(7)]
    legend_below(figure, [axes.lines[0]] * 7, labels)
    assert faults(figure) == []


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (lambda figure, axes: figure.legend([*axes.lines] * 9, ["long" * 9] * 9, ncols=9), "cut off"),
        (lambda figure, axes: figure.text(0.9, 0.5, "far too long a text"), "cut off"),
        (lambda figure, axes: (axes.bar([0], [1]), axes.set_yscale("log")), "bars on a log axis"),
        (lambda figure, axes: (axes.barh([0], [1]), axes.set_xscale("symlog")), "bars on a symlog axis"),
        (lambda figure, axes: axes.fill_between([0, 1], [-0.1, 0], [1, 1]), "leaves [0, 1]"),
        (lambda figure, axes: axes.fill_between([0, 1], [0, 0], [1, np.nextafter(1.1, 2)]), "leaves [0, 1]"),
        (lambda figure, axes: [legend.remove() for legend in list(figure.legends)], "dotted lines"),
    ],
)
def test_each_fault_is_found(fault, said):
    figure, axes = fine()
    fault(figure, axes)
    assert any(said in word for word in faults(figure)), faults(figure)
