"""What the figures of all four tasks share: one decoder per model, and motions while z is held."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.core.figure_style import SMALL_FONT_SIZE, Look, tidy
from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.contract import DecodesActions, next_context
from latentarm.evaluation.effects import axis_grid
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import format_figure
from latentarm_research.studies.drawing import View, note, plane, row_of_panels, title
from latentarm_research.studies.properties.figures import OURS, draw_losses, points
from latentarm_research.tasks.planar.motion import PlanarMotion
from latentarm_research.tasks.planar.paths import STEP_S

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import SubFigure


CONDITIONED: Final = ("cvae", OURS)
"""The models whose latent action is shown in detail: the one that the paper draws, and ours."""

CONTRASTED: Final = ("vae", *CONDITIONED)
"""The models whose motions are shown side by side; the paper contrasts the first two."""

EPISODES: Final = 60
STREAM: Final = 81  # separates the drawn states from those of the study: no model was trained on them
Decoders = Mapping[str, DecodesActions]  # one decoder per model, of the first seed


@dataclass(frozen=True)
class DrawnModel:
    """One model as it is drawn on one task."""

    model: str  # its name
    decoder: DecodesActions  # of one seed
    # 1 or -1, what z is multiplied by before it is decoded. The sign of a latent axis is chance: without
    # this, two models that do the same would look opposed
    sign: float

    @property
    def look(self) -> Look:
        """Its colour, marker and dash."""
        return look_of(self.model)

    def hold(self, start: FloatArray, z: FloatArray, duration_s: float) -> FloatArray:
        """States (L, N, T + 1, n), rad, while each of L latent actions is held from each of N starts."""
        latent = np.broadcast_to(self.sign * z[:, None], (len(z), len(start), z.shape[-1]))
        passed = [np.broadcast_to(start, (len(z), *start.shape))]
        for _ in range(round(duration_s / STEP_S)):
            passed.append(next_context(passed[-1], self.decoder.decode(latent, passed[-1]), STEP_S))
        return np.stack(passed, axis=2)


def as_trained(decoders: Decoders, models: Sequence[str]) -> list[DrawnModel]:
    """Those of the models that there are, in the order asked for, with z as it was learned."""
    return [DrawnModel(model, decoders[model], 1.0) for model in models if model in decoders]


def turned(
    decoders: Decoders,
    models: Sequence[str],
    states: FloatArray,  # (N, n), where to look, rad
    rising: Callable[[FloatArray], FloatArray],  # from states (..., n) to the quantity (...)
) -> list[DrawnModel]:
    """The same, with a 1-D z turned so that positive z, on the whole, raises a quantity."""
    ends = np.array([[-1.0], [1.0]])
    shown: list[DrawnModel] = []
    for plain in as_trained(decoders, models):
        backward, forward = rising(plain.hold(states, ends, STEP_S)[:, :, -1])
        shown.append(DrawnModel(plain.model, plain.decoder, 1.0 if np.sum(forward - backward) >= 0 else -1.0))
    return shown


def passed_states(motion: PlanarMotion) -> FloatArray:
    """States (K, n) of demonstrations that no model has seen, rad; always the same."""
    demonstrations = motion.demonstrate(EPISODES, np.random.default_rng(STREAM))
    return np.concatenate([episode.state for episode in demonstrations.episodes])


def spread_states(
    states: FloatArray,  # (K, n)
    quantity: FloatArray,  # (K,), of each of them
    count: int,
) -> FloatArray:
    """States (count, n), the lowest first, at which a quantity is spread evenly over its middle range."""
    low, high = np.quantile(quantity, (0.03, 0.97))
    wanted = low + (np.arange(count) + 0.5) / count * (high - low)
    return states[np.argmin(np.abs(quantity - wanted[:, None]), axis=1)]


GUIDE_COLOUR: Final = "#bbbbbb"


def draw_guides(axes: "Axes", motion: PlanarMotion) -> None:
    """Draw the lines that show a task, in grey behind everything."""
    for guide in motion.guides:
        axes.plot(*guide.T, color=GUIDE_COLOUR, linewidth=1.6, zorder=2)


GRID: Final = axis_grid(21)
DASHES: Final = ("-", "--", ":")


def draw_over_z(
    axes: "Axes",  # where to draw
    rows: Sequence[Row],
    task: str,
    model: str,
    effect: FloatArray,  # (K, 3), at the K values of `GRID`, in three states, in the unit of the y axis
) -> None:
    """Draw an effect over z, and say how well a line fits it over all seeds and more states."""
    for place, (values, dash) in enumerate(zip(effect.T, DASHES, strict=True)):
        axes.plot(
            GRID,
            values,
            color=look_of(model).colour,
            linestyle=dash,
            linewidth=1.2,
            label=f"state {place + 1}",
        )
    fit = points(rows, task, "r2").get(model)
    if fit is not None:
        note(axes, f"$R^2$ = {format_figure(fit.mean, fit.sd)}", high=True)
    axes.set_xlabel("z")
    axes.legend(loc="lower right", fontsize=SMALL_FONT_SIZE, frameon=False, borderaxespad=0.0)
    tidy(axes)


def draw_losses_and_effects(
    part: "SubFigure",  # where to draw
    rows: Sequence[Row],
    task: str,
    models: Sequence[DrawnModel],
    effect_of: Callable[[DrawnModel], FloatArray],
    effect: str,
    unit: str,
) -> None:
    """Draw the losses of all models, then the effect of z in three states with some of them."""
    losses, *panels = part.subplots(1, 1 + len(models), squeeze=False)[0]
    draw_losses(losses, rows, task)
    for place, (axes, model) in enumerate(zip(panels, models, strict=False)):
        draw_over_z(axes, rows, task, model.model, effect_of(model))
        title(axes, f"{model.look.label}, {effect}", "" if place else "B")
        axes.set_ylabel(unit)


def draw_states(
    part: "SubFigure",
    models: Sequence[DrawnModel],
    states: FloatArray,
    draw: Callable[["Axes", DrawnModel, FloatArray], None],
    view: View,
) -> None:
    """Draw what some models do in each of a few states (K, n), a panel for each."""
    for place, axes in enumerate(row_of_panels(part, len(states) * len(models))):
        model, state = divmod(place, len(states))
        draw(axes, models[model], states[state])
        title(axes, f"{models[model].look.label}, state {state + 1}")
        plane(axes, view, ticks=3)
