"""Faults that a figure must not have; ``conftest.py`` looks for them in every figure that a test saves."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from matplotlib.collections import PolyCollection
from matplotlib.container import BarContainer
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.text import Annotation, Text
from matplotlib.transforms import BboxBase

PROBABILITIES = ("belief", "probability", "success")
ROUNDING = 1e-9
PIXEL = 1.5


def faults(figure: Figure, *, drawn: bool = False) -> list[str]:
    """What is wrong with a figure, in words; one that has been ``drawn`` is not drawn again."""
    canvas = figure.canvas
    if not isinstance(canvas, FigureCanvasAgg):
        canvas = FigureCanvasAgg(figure)
    if not drawn:
        figure.draw_without_rendering()
    return [
        *_cut_off(figure, canvas.get_renderer()),
        *_bars_on_logarithms(figure),
        *_beyond_probability(figure),
        *_unnamed_dots(figure),
    ]


def _cut_off(figure: Figure, renderer: RendererAgg) -> Iterator[str]:
    """With the renderer that drew the figure, which remembers how large its texts are."""
    canvas = figure.bbox.padded(PIXEL)
    for legend in figure.findobj(Legend):
        if not _within(legend.get_window_extent(renderer), canvas):
            yield "a legend is cut off"
    for text in _texts(figure):
        if text.get_text().strip() and not _within(text.get_window_extent(renderer), canvas):
            yield f"{text.get_text()!r} is cut off"
    slack = PIXEL / figure.dpi
    if not _within(figure.get_tightbbox(renderer), figure.bbox_inches.padded(slack)):
        yield "something is drawn beyond the canvas"


def _within(box: BboxBase, canvas: BboxBase) -> bool:
    return box.x0 >= canvas.x0 and box.y0 >= canvas.y0 and box.x1 <= canvas.x1 and box.y1 <= canvas.y1


def _texts(figure: Figure) -> Iterator[Text]:
    """Titles, labels and notes; the numbers along axes are in the bounding box where they are drawn."""
    yield from figure.texts
    for axes in figure.axes:
        yield from (axes.title, axes._left_title, axes._right_title)
        yield from (axis.label for axis in axes._axis_map.values())
        yield from (text for text in axes.texts if not isinstance(text, Annotation))


def _bars_on_logarithms(figure: Figure) -> Iterator[str]:
    for axes in figure.axes:
        for container in axes.containers:
            if isinstance(container, BarContainer):
                scale = axes.get_xscale() if container.orientation == "horizontal" else axes.get_yscale()
                if scale != "linear":
                    yield f"bars on a {scale} axis"


def _beyond_probability(figure: Figure) -> Iterator[str]:
    for axes in figure.axes:
        if any(word in axes.get_ylabel() for word in PROBABILITIES) and "%" not in axes.get_ylabel():
            for band in axes.findobj(PolyCollection):
                heights = np.concatenate([path.vertices[:, 1] for path in band.get_paths()])
                if heights.min() < -ROUNDING or heights.max() > 1 + ROUNDING:
                    yield f"a band of {axes.get_ylabel()} leaves [0, 1]"


def _unnamed_dots(figure: Figure) -> Iterator[str]:
    if any(map(_is_dotted, _lines(figure.axes))) and not any(map(_is_dotted, _samples(figure))):
        yield "dotted lines are not in a legend"


def _lines(panels: list[Axes]) -> Iterator[Line2D]:
    for axes in panels:
        yield from (line for line in axes.lines if line.get_visible())


def _samples(figure: Figure) -> Iterator[Line2D]:
    for legend in figure.findobj(Legend):
        yield from legend.findobj(Line2D)


def _is_dotted(line: Line2D) -> bool:
    return line.get_linestyle() == ":"
