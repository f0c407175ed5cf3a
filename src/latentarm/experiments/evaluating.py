"""`latentarm evaluate`: a run measured on the episodes that it never saw."""

from pathlib import Path

import numpy as np

from latentarm.errors import UserError
from latentarm.metrics.effects import axis_effects, axis_grid
from latentarm.metrics.evaluation import EvaluationConfig, evaluate
from latentarm.metrics.latent_effect_figure import latent_effect_figure
from latentarm.metrics.properties_figure import properties_figure
from latentarm.metrics.results import write_results
from latentarm.metrics.samples import ContextKind, moving_episodes, spread_contexts
from latentarm.metrics.summary import Subject
from latentarm.models.catalogue import load_model
from latentarm.models.model import LatentActionModel
from latentarm.robots.robot import Robot
from latentarm.runs.checks import check_seed
from latentarm.runs.folder import Run, read_run, robot_of
from latentarm.runs.training import prepared
from latentarm.style import save_figure
from latentarm.types import Demonstrations, Row

DRAWN_STATES = 3
"""States from which the effect of each latent axis is drawn."""


def evaluate_run(folder: Path, out: Path, seed: int, dataset: Path | None = None) -> list[Row]:
    """Measure a run and write ``metrics.json`` and two figures.

    Args:
        folder: the run.
        out: where to write.
        seed: of the noise on held-out states.
        dataset: where the run's dataset lies now, if it was moved.

    Returns:
        One row per measure: mean and SD over the run's seeds.

    Raises:
        UserError: the folder is not a run, its dataset is gone or does not fit it, or its robot is
            not to be had.
    """
    check_seed(seed)
    run = read_run(folder)
    model = load_model(folder)
    demonstrations = prepared(run.dataset(dataset), run.context)
    robot = robot_of(run)
    if demonstrations.dof != robot.dof:
        raise UserError(
            f"{run.demonstrations} has {demonstrations.dof} joints, but robot {robot.name} has {robot.dof}:"
            " train on a dataset of that robot."
        )
    config = EvaluationConfig()
    rows = evaluate(
        model,
        demonstrations,
        run.held_out,
        robot,
        subject=Subject("evaluate", task=run.demonstrations.name, model=run.model),
        rng=np.random.default_rng(seed),
        config=config,
    )
    write_results(
        out / "metrics.json", rows, {"run": str(folder), "seed": seed, "held_out": list(run.held_out)}
    )
    _draw(run, model, demonstrations, robot, config, out)
    return rows


def _draw(
    run: Run,
    model: LatentActionModel,
    demonstrations: Demonstrations,
    robot: Robot,
    config: EvaluationConfig,
    out: Path,
) -> None:
    """Figures of the first seed: distance against z, and where each axis leads."""
    kind: ContextKind = model.context
    decoder = model.decoder(0)
    episodes = moving_episodes(demonstrations, run.held_out)
    step_s = 1.0 / demonstrations.rate_hz
    grid = axis_grid(config.grid)
    states = spread_contexts(episodes, kind, config.states)
    effects = axis_effects([decoder], states, grid, robot.chain, step_s)[0]
    save_figure(properties_figure(effects, grid, run.model), out / "consistency.png")
    shown = episodes[:1]
    path = robot.chain.forward(shown[0].state).position
    starts = spread_contexts(shown, kind, DRAWN_STATES)
    figure = latent_effect_figure(decoder, starts, robot.chain, step_s, run.model, path)
    save_figure(figure, out / "latent_axes.png")
