"""What is measured of one model on one fold."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.core.types import Demonstrations, FloatArray
from latentarm.evaluation.controllability import ReachConfig
from latentarm.evaluation.evaluation import EvaluationConfig, measure
from latentarm.evaluation.measures import MEASURES
from latentarm.evaluation.samples import moving_episodes, spread_contexts
from latentarm.evaluation.turning import turning
from latentarm.models.model import LatentActionModel
from latentarm.robots.robot import Robot
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
    "motion_turn",
    "motion_turn_p95",
    "tool_turn",
    "tool_turn_p95",
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


def measure_model(
    model: LatentActionModel,  # fitted, with contexts that are states
    # the whole dataset; PCA, of whose error others are percentages, is fitted to all of it that is not held
    # out, also where the model was trained on less
    demonstrations: Demonstrations,
    held_out: Sequence[int],  # indices of the episodes that it has not seen
    robot: Robot,  # the arm
    preset: Preset,  # sizes
    rng: np.random.Generator,  # for the noise on held-out states
) -> dict[str, FloatArray]:
    """Figures of every seed of a model on held-out episodes: measure -> (S,), in the order of `MEASURED`."""
    reach = ReachConfig(pairs=preset.reach_pairs)
    config = EvaluationConfig(reach=reach, latents=preset.searched_pairs)
    measured = measure(model, demonstrations, held_out, robot, rng=rng, config=config)
    figures = dict(measured.per_seed)
    episodes = moving_episodes(demonstrations, held_out)
    figures |= _around_the_stick(model, spread_contexts(episodes, "state", preset.turned_states), robot)
    return {name: figures[name] for name in MEASURED if name in figures}


def _around_the_stick(model: LatentActionModel, contexts: FloatArray, robot: Robot) -> dict[str, FloatArray]:
    decoders = [model.decoder(seed) for seed in range(model.seeds)]
    turned = turning(decoders, contexts, robot.chain)
    figures: dict[str, FloatArray] = {}
    for name, values in (("motion_turn", turned.joints), ("tool_turn", turned.tool)):
        flat = values.reshape(len(values), -1)
        figures[name] = np.nanmean(flat, axis=1)
        figures[f"{name}_p95"] = np.nanpercentile(flat, JUMPY, axis=1)
    return figures
