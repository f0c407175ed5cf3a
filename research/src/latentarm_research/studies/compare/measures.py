"""What is measured of one model on one fold."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Final

import numpy as np

from latentarm.core.types import Demonstrations, FloatArray
from latentarm.evaluation.controllability import ReachConfig
from latentarm.evaluation.evaluation import EvaluationConfig, measure
from latentarm.evaluation.measures import MEASURES
from latentarm.evaluation.samples import moving_episodes, spread_contexts, start_goal_pairs
from latentarm.evaluation.turning import turning
from latentarm.models.model import LatentActionModel
from latentarm.robots.robot import Robot
from latentarm_research.metrics.nonlinearity import nonlinearity
from latentarm_research.metrics.shooting import ShootingConfig, planned_reach
from latentarm_research.studies.compare.preset import Preset

JUMPY: Final = 95.0  # the percentile of turning that is reported with the mean

EXPRESSED: Final = ("search_error_percent_of_pca", "search_noise_free_error_percent_of_pca")
"""What the decoder can express: the nearest input, of every model."""

ENCODED: Final = ("error_percent_of_pca", "noise_free_error_percent_of_pca")
"""Through the encoder network, of models that have one."""

BEHAVIOUR: Final = (
    "drift",
    "reversal",
    "reversal_0_5_s",
    "reversal_2_s",
    "state_change",
    "r2_axis_0",
    "r2_axis_1",
    "r2_local_axis_0",
    "r2_local_axis_1",
    "disentanglement_deg",
    "controllability_m",
    "controllability_state_error",
    "planned_reach_m",
    "motion_turn",
    "motion_turn_p95",
    "tool_turn",
    "tool_turn_p95",
    "nonlinearity",
)
"""How the decoder behaves; no encoder is asked."""

TABLES: Final = {
    "What the decoder can express": EXPRESSED,
    "Through the encoder network": ENCODED,
    "Behaviour": BEHAVIOUR,
}
"""Heading -> measures of a table. The two ways of encoding are never in one."""

MEASURED: Final = (*EXPRESSED, *ENCODED, *BEHAVIOUR)  # every measure in the order of the tables


def meaning_of(name: str) -> str:
    """What a measure says; of a second axis, that it is as for the first."""
    base, _, axis = name.rpartition("_axis_")
    return f"as for axis {axis}" if axis not in ("", "0") and base else MEASURES[base or name].definition


@dataclass(frozen=True)
class MeasuredDecoder:
    """What was measured."""

    # measure -> (S,), in the order of `MEASURED`; the planned one for its first seeds alone
    figures: Mapping[str, FloatArray]
    measure_s: float  # how long it took without planning, s
    plan_s: float  # how long planning took for one decoder, s


def measure_model(
    model: LatentActionModel,
    demonstrations: Demonstrations,
    held_out: Sequence[int],
    robot: Robot,
    preset: Preset,
    rng: np.random.Generator,
) -> MeasuredDecoder:
    """Measure every seed of a model on held-out episodes.

    Args:
        model: fitted, with contexts that are states.
        demonstrations: the whole dataset; PCA, of whose error others are percentages, is fitted to all of it
            that is not held out, also where the model was trained on less.
        held_out: indices of the episodes that it has not seen.
        robot: the arm.
        preset: sizes.
        rng: for the noise on held-out states.
    """
    began = perf_counter()
    reach = ReachConfig(pairs=preset.reach_pairs)
    config = EvaluationConfig(reach=reach, latents=preset.searched_pairs)
    measured = measure(model, demonstrations, held_out, robot, rng=rng, config=config)
    figures = dict(measured.per_seed)
    episodes = moving_episodes(demonstrations, held_out)
    figures |= _around_the_stick(model, spread_contexts(episodes, "state", preset.turned_states), robot)
    measure_s = perf_counter() - began

    began = perf_counter()
    seeds = min(preset.planned_seeds, model.seeds)
    if preset.planned_pairs:
        pairs = start_goal_pairs(
            episodes, "state", separation_s=reach.separation_s, count=preset.planned_pairs
        )
        planned = planned_reach(
            [model.decoder(seed) for seed in range(seeds)],
            [model.torch_decoder(seed) for seed in range(seeds)],
            pairs,
            robot.chain,
            1.0 / demonstrations.rate_hz,
            ShootingConfig(),
        )
        figures["planned_reach_m"] = planned.mean(axis=1)
    plan_s = (perf_counter() - began) / max(seeds, 1)
    return MeasuredDecoder({name: figures[name] for name in MEASURED if name in figures}, measure_s, plan_s)


def _around_the_stick(model: LatentActionModel, contexts: FloatArray, robot: Robot) -> dict[str, FloatArray]:
    decoders = [model.decoder(seed) for seed in range(model.seeds)]
    turned = turning(decoders, contexts, robot.chain)
    figures: dict[str, FloatArray] = {}
    for name, values in (("motion_turn", turned.joints), ("tool_turn", turned.tool)):
        flat = values.reshape(len(values), -1)
        figures[name] = np.nanmean(flat, axis=1)
        figures[f"{name}_p95"] = np.nanpercentile(flat, JUMPY, axis=1)
    figures["nonlinearity"] = np.nanmean(nonlinearity(decoders, contexts), axis=1)
    return figures


def without_planning(preset: Preset) -> Preset:
    """The same sizes without the operator who plans."""
    return replace(preset, planned_pairs=0)
