"""All measures of a latent action model on held-out episodes, as rows with mean and SD over seeds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final, final

import numpy as np

from latentarm.core.context import Named
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray, Row
from latentarm.demonstrations.pairs import make_pairs
from latentarm.demonstrations.split import select_episodes
from latentarm.evaluation.accuracy import Accuracy, accuracy
from latentarm.evaluation.consistency import consistency, local_consistency
from latentarm.evaluation.contract import DecodesActions
from latentarm.evaluation.controllability import ReachConfig, reach_goals
from latentarm.evaluation.disentanglement import disentanglement_deg
from latentarm.evaluation.drift import drift
from latentarm.evaluation.effects import axis_effects, axis_grid
from latentarm.evaluation.reversal import reversal
from latentarm.evaluation.samples import (
    StartGoalPairs,
    evenly_spread,
    moving_episodes,
    spread_contexts,
    start_goal_pairs,
)
from latentarm.evaluation.state_change import state_change
from latentarm.evaluation.summary import Subject, summarise
from latentarm.evaluation.turning import turning
from latentarm.robots.robot import Robot

if TYPE_CHECKING:
    from latentarm.models.model import LatentActionModel

STATES: Final = 25  # for consistency, disentanglement and turning
GRID: Final = 21  # values of z in [-1, 1] on each axis, at each of these states
HELD_LATENTS: Final = 300  # held-out pairs for reversal after longer holds
HOLDS_S: Final = {"reversal_0_5_s": 0.5, "reversal_2_s": 2.0}
"""Measure -> how long z and -z are each held for it, s: longer than any loss looks ahead."""


@dataclass(frozen=True)
class EvaluationConfig:
    """Settings of the measures; the same for all models that are compared."""

    latents: int = 2000  # held-out pairs whose nearest inputs are searched for
    reach: ReachConfig = field(default_factory=ReachConfig)


@dataclass(frozen=True)
class PropertyFigures:
    """The measures of a model for each seed, before averaging."""

    per_seed: Mapping[str, FloatArray]  # measure -> (S,)
    start_distance_m: FloatArray  # (P,), of the tools from the goals before any drive, m

    def rows(self, subject: Subject) -> list[Row]:
        """Mean and SD over seeds, one row per measure."""
        rows = [summarise(subject, name, values) for name, values in self.per_seed.items()]
        return [*rows, summarise(subject, "start_distance_m", self.start_distance_m)]


def measure(
    model: "LatentActionModel",
    demonstrations: Demonstrations,
    held_out: Sequence[int],
    robot: Robot,
    *,
    rng: np.random.Generator,
    config: EvaluationConfig | None = None,
) -> PropertyFigures:
    """Measure every seed of a fitted model on held-out episodes of the dataset that it was trained on.

    PCA is fitted to all episodes that are not held out, so also to validation episodes. ``rng`` draws the
    noise on held-out states.

    Raises UserError where no episode is held out, none is left for PCA, or the contexts lack a feature.
    """
    config = config or EvaluationConfig()
    episodes = moving_episodes(demonstrations, held_out)
    found = _measure_accuracy(model, demonstrations, held_out, rng, config)
    probe = _probe(model.context, episodes, demonstrations.rate_hz, config, found.context, found.action)
    behaviour = measure_behaviour(found.decoders, found.z, probe, robot, config)
    return replace(behaviour, per_seed={**found.figures, **behaviour.per_seed})


@final
@dataclass(frozen=True, eq=False)
class Probe:
    """Held-out samples on which a model's behaviour is measured."""

    pairs: StartGoalPairs
    states: FloatArray  # (K, c), contexts for consistency, disentanglement and turning
    context: FloatArray  # (L, c), contexts for drift, reversal and change in state
    action: FloatArray  # (L, m), the actions there, rad/s
    step_s: float  # dt of s' = s + a dt, and of `reversal`'s holds, s


def take_probe(model: "LatentActionModel", demonstrations: Demonstrations, held_out: Sequence[int]) -> Probe:
    """The samples that `measure` takes by default, for a run to keep.

    Raises UserError as `measure` does, and where nothing moves in the held-out episodes.
    """
    config = EvaluationConfig()
    episodes = moving_episodes(demonstrations, held_out)
    how = (model.context, np.random.default_rng(0), model.actions)
    pairs = make_pairs(select_episodes(demonstrations, held_out), model.window, 0.0, *how)
    chosen = evenly_spread(config.latents, len(pairs.action))
    samples = (pairs.clean_context[chosen], pairs.action[chosen])
    return _probe(model.context, episodes, demonstrations.rate_hz, config, *samples)


def measure_behaviour(
    decoders: Sequence[DecodesActions],
    z: FloatArray,
    probe: Probe,
    robot: Robot,
    config: EvaluationConfig | None = None,
) -> PropertyFigures:
    """All measures of `measure` but the errors of reconstruction, which need the demonstrations.

    ``z`` (S, L, d) are the inputs whose actions are nearest to the probe's, see `nearest_latents`.
    """
    config = config or EvaluationConfig()
    figures: dict[str, FloatArray] = {}
    reach = reach_goals(decoders, probe.pairs, robot.chain, probe.step_s, config.reach.solver)
    figures["controllability_m"] = reach.tool_error_m.mean(axis=1)
    figures["controllability_state_error"] = reach.state_error_rad.mean(axis=1)
    grid = axis_grid(GRID)
    effects = axis_effects(decoders, probe.states, grid, robot.chain, probe.step_s)
    for name, per_axis in (
        ("r2", consistency(effects, grid)),
        ("r2_local", local_consistency(effects, grid)),
    ):
        figures[name] = per_axis.mean(axis=1)
        figures |= {f"{name}_axis_{axis}": per_axis[:, axis] for axis in range(per_axis.shape[1])}
    figures["disentanglement_deg"] = disentanglement_deg(effects)
    figures["drift"] = drift(decoders, z, probe.context)
    figures["reversal"] = reversal(decoders, z, probe.context, probe.step_s)
    held = evenly_spread(HELD_LATENTS, len(probe.context))
    for name, hold_s in HOLDS_S.items():
        figures[name] = reversal(decoders, z[:, held], probe.context[held], probe.step_s, hold_s)
    figures["state_change"] = state_change(decoders, z, probe.context)
    if z.shape[-1] == 2:
        turned = turning(decoders, probe.states, robot.chain).joints
        count = np.isfinite(turned).sum(axis=(1, 2))
        figures["motion_turn"] = np.divide(
            np.nansum(turned, axis=(1, 2)), count, out=np.full(len(turned), np.nan), where=count > 0
        )
    return PropertyFigures(per_seed=figures, start_distance_m=reach.start_distance_m)


def _probe(
    names: Named,
    episodes: Sequence[Episode],
    rate_hz: float,
    config: EvaluationConfig,
    context: FloatArray,
    action: FloatArray,
) -> Probe:
    pairs = start_goal_pairs(
        episodes, names, separation_s=config.reach.separation_s, count=config.reach.pairs
    )
    states = spread_contexts(episodes, names, STATES)
    return Probe(pairs, states, context, action, 1.0 / rate_hz)


def _measure_accuracy(
    model: "LatentActionModel",
    demonstrations: Demonstrations,
    held_out: Sequence[int],
    rng: np.random.Generator,
    config: EvaluationConfig,
) -> Accuracy:
    """Reconstruction errors with and without state noise, relative to PCA on the other episodes."""
    trained_on = [index for index in range(len(demonstrations.episodes)) if index not in set(held_out)]
    if not trained_on:
        raise UserError("Every episode is held out: leave at least one to fit PCA, the baseline, to.")
    how = (model.context, rng, model.actions)
    training = make_pairs(select_episodes(demonstrations, trained_on), model.window, 0.0, *how)
    pairs = make_pairs(select_episodes(demonstrations, held_out), model.window, model.state_noise_rad, *how)
    return accuracy(model, training.action, pairs, config.latents)
