from dataclasses import dataclass

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from figure_faults import faults
from latentarm.core.figure_style import MM_PER_INCH, TWO_COLUMNS_MM, shade
from latentarm.core.types import Row
from latentarm.evaluation.effects import held_paths
from latentarm.evaluation.looks import LOOKS, look_of
from latentarm.models.catalogue import KINDS
from latentarm.robots.planar import planar
from latentarm_research.studies.drawing import arm_line
from latentarm_research.studies.properties.cell import PropertiesCell, PropertiesResult
from latentarm_research.studies.properties.figures import (
    beside_paper_figure,
    in_mm,
    points,
)
from latentarm_research.studies.properties.held_motion import DrawnModel, spread_states, turned
from latentarm_research.studies.properties.preset import PRESETS
from latentarm_research.studies.properties.study import TASK_FIGURES
from latentarm_research.tasks.planar.catalogue import MOTIONS
from latentarm_research.tasks.planar.paths import STEP_S
from latentarm_research.tasks.planar.resolved_rate import plane_point

MODELS = ("pca", "ae", "vae", "cae", "cvae", "cae_zero", "scl")
OURS = "isometric"


@dataclass(frozen=True)
class Turning:
    """Each latent axis turns every joint of its own, a little faster where the arm is bent."""

    latent_dim: int
    dof: int
    gain: float = 1.0

    def decode(self, z, context):
        direction = np.sin(np.arange(self.latent_dim * self.dof)).reshape(self.latent_dim, self.dof)
        return self.gain * (z @ direction) * (1.0 + 0.1 * np.abs(context))


def results_of(tasks, models):
    return [
        PropertiesResult(
            PropertiesCell(task, model, PRESETS["smoke"], 0),
            {},
            Turning(MOTIONS[task]().latent_dim, MOTIONS[task]().robot.dof),
        )
        for task in tasks
        for model in models
    ]


def decoders_of(task, models):
    return {result.cell.model: result.decoder for result in results_of([task], models)}


def rows_of(tasks, models, n=3):
    rows = []
    measures = [
        ("error_percent_of_pca", "%", 20.0),
        ("median_error_percent_of_pca", "%", 20.0),
        ("controllability_m", "m", 0.01),
        ("median_controllability_percent_of_pca", "%", 20.0),
        ("final_distance", "m", 0.02),
        ("final_distance_percent_of_vae", "%", 90.0),
        ("path_length_percent_of_vae", "%", 90.0),
        ("start_distance_m", "m", 0.17),
        ("r2", "1", 0.9),
        ("disentanglement_deg", "deg", 70.0),
    ]
    for task in tasks:
        for place, model in enumerate(models):
            for measure, unit, size in measures:
                mean, paper = size * (1 - 0.1 * place), size if model == "cvae" else None
                sd = None if n == 1 else 2 * mean  # more than the mean: no logarithm of its lower end
                rows.append(Row("properties", measure, unit, mean, sd, n, task, model, None, paper, paper))
    return rows


def words_of(figure):
    texts = figure.findobj(lambda artist: hasattr(artist, "get_text"))
    return {text.get_text() for text in texts if text.get_text() and text.get_visible()}


def assert_well_drawn(figure):
    assert faults(figure) == []
    assert figure.get_size_inches()[0] * MM_PER_INCH == pytest.approx(TWO_COLUMNS_MM)
    assert any("simulated" in word for word in words_of(figure))


@pytest.mark.parametrize("models", [(*MODELS, OURS), ("pca",)])
@pytest.mark.parametrize("task", TASK_FIGURES)
def test_a_task_is_drawn_with_the_models_that_there_are(task, models):
    figure = TASK_FIGURES[task](decoders_of(task, models), rows_of([task], models))
    assert_well_drawn(figure)
    titles = {axes.get_title(loc="left") for axes in figure.findobj(lambda artist: hasattr(artist, "axison"))}
    for model in ("vae", "cvae", OURS):
        assert any(
            title.startswith(look_of(model).label) or f"}}$  {look_of(model).label}" in title
            for title in titles
        ) == (model in models)


@pytest.mark.parametrize(("n", "tasks"), [(3, list(MOTIONS)), (1, ["circle"])])
def test_figures_over_tasks_are_well_drawn(n, tasks):
    rows = rows_of(MOTIONS, (*MODELS, OURS), n)
    figure = beside_paper_figure(rows, tasks)
    assert_well_drawn(figure)
    assert len(tasks) > 1 or not {"Sine", "Rotate", "Reach"} & words_of(figure)


def test_only_models_that_the_paper_has_and_ours_stand_beside_it():
    rows = rows_of(["sine"], (*MODELS, OURS))
    words = words_of(beside_paper_figure(rows, ["sine"]))
    assert {"cVAE", "isometric"} <= words
    assert not {"SCL", "cAE, zero penalty", "PCA"} & words  # these rows carry no figure of the paper


def test_lengths_stand_in_millimetres_without_the_papers_which_has_no_unit():
    lengths = points(rows_of(["sine"], MODELS), "sine", "controllability_m")
    assert lengths["cvae"].paper is not None
    assert in_mm(lengths)["cvae"].paper is None
    assert in_mm(lengths)["pca"].mean == pytest.approx(10.0)


def test_models_that_differ_in_the_sign_of_z_alone_look_the_same():
    robot = planar(5)
    states = np.random.default_rng(0).normal(1.0, 0.1, (6, 5))
    decoders = {"vae": Turning(1, 5), "cvae": Turning(1, 5, gain=-1.0)}
    one, other = turned(decoders, states, lambda state: plane_point(robot, state)[..., 0])
    z = np.array([[1.0]])
    np.testing.assert_allclose(one.hold(states, z, 0.1), other.hold(states, z, 0.1), atol=1e-15)
    ends = plane_point(robot, one.hold(states, z, STEP_S)[0])[..., 0]
    assert np.sum(ends[:, -1] - ends[:, 0]) > 0


def test_a_held_latent_action_leads_where_the_measures_say():
    robot, start = planar(5), np.full((2, 5), 0.3)
    model = DrawnModel("scl", Turning(2, 5), 1.0)
    z = np.array([[1.0, 0.0], [0.5, -1.0]])
    states = model.hold(start, z, 0.2)
    paths = held_paths(model.decoder, start, z, robot.chain, STEP_S, round(0.2 / STEP_S))
    np.testing.assert_allclose(robot.chain.forward(states).position, paths, atol=1e-12)


@pytest.mark.parametrize("arms", [1, 2])
def test_an_arm_is_drawn_from_its_base_to_its_tool_in_links_of_true_length(arms):
    robot = planar(5, arms=arms)
    state = np.random.default_rng(1).normal(0.0, 0.5, robot.dof)
    for tool in range(arms):
        line = arm_line(robot, state, tool)
        np.testing.assert_allclose(line[0], [0.0, 0.0 if arms == 1 else (0.4, -0.4)[tool]], atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(np.diff(line, axis=0), axis=1), 0.2, atol=1e-12)
        np.testing.assert_allclose(line[-1], robot.chain.forward(state, tool).position[:2], atol=1e-12)


def test_states_are_spread_over_the_range_of_what_is_asked_for():
    quantity = np.linspace(-1.0, 1.0, 201)
    spread = spread_states(quantity[:, None], quantity, 4)[:, 0]
    assert np.all(np.diff(spread) > 0.4)
    np.testing.assert_allclose(spread, -spread[::-1], atol=0.011)


@pytest.mark.parametrize("model", [*KINDS, *LOOKS])
def test_shades_grow_darker_and_stay_visible_on_white(model):
    greys = [
        np.dot(to_rgb(shade(look_of(model).colour, z)), (0.299, 0.587, 0.114)) for z in np.linspace(-1, 1, 9)
    ]
    assert np.all(np.diff(greys) < 0)
    assert greys[0] < 0.95


def test_no_two_models_look_alike():
    models = [look_of(name) for name in KINDS]
    for feature in ("label", "colour", "marker"):
        assert len({getattr(look, feature) for look in models}) == len(models)
    assert look_of(OURS).dash not in {look_of(model).dash for model in MODELS}
