"""What is measured of one model on one fold, and what each figure means."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Final

import numpy as np

from latentarm.experiments.compare.preset import Preset
from latentarm.metrics.controllability import ReachConfig
from latentarm.metrics.evaluation import EvaluationConfig, measure
from latentarm.metrics.samples import moving_episodes, spread_contexts, start_goal_pairs
from latentarm.metrics.shooting import ShootingConfig, planned_reach
from latentarm.metrics.turning import turning
from latentarm.models.model import LatentActionModel
from latentarm.robots.robot import Robot
from latentarm.types import Demonstrations, FloatArray

JUMPY: Final = 95.0
"""The percentile of turning that is reported beside the mean."""

MEASURES: Final[dict[str, str]] = {
    "error_percent_of_pca": "mean squared error of encode-decode on held-out pairs, in % of the plane (PCA,"
    " two components) through all other episodes' actions. Actions are taken before noise is added to the"
    " states.",
    "noise_free_error_percent_of_pca": "the same on clean states.",
    "drift": "how fast the arm is told to move with the stick at rest, ‖φ(0, s)‖, in how fast the person"
    " moved it, ‖φ(z, s)‖; both means over held-out pairs.",
    "reversal": "z for one sample, then −z for one: what is left, ‖s₂ − s₀‖ over ‖s₁ − s₀‖; both means over"
    " held-out pairs. 0 is a motion undone, 1 leaves as much to go back as the motion was long.",
    "r2_local_axis_0": "R² of one line, over 25 held-out states and 21 values in [−1, 1] of this axis alone,"
    " of the tool's signed way in a sample against z; each state has its own forward, where its +z leads.",
    "r2_local_axis_1": "as for axis 1.",
    "r2_axis_0": "the same with one forward for all states, as the paper has it.",
    "r2_axis_1": "as for axis 1.",
    "disentanglement_deg": "angle between the lines along which the two axes move the tool, mean over states;"
    " 90° is best.",
    "controllability_m": "a greedy solver with z in [−1, 1], looking one sample ahead, has 6 s to bring the"
    " tool where it was in the same held-out episode 3 s later; least distance.",
    "controllability_state_error": "‖s − s_goal‖ over all joints at that moment.",
    "planned_reach_m": "the same asked of a solver that plans all 6 s at once, in pieces of half a second,"
    " for some of the pairs and seeds; never worse than greedy on the same pairs.",
    "motion_turn": "the stick, pushed all the way, is led around in 36 turns of 10°: by what angle the"
    " arm's joint velocity turns, in that of the stick. A linear isometry has 1.",
    "motion_turn_p95": "95th percentile over held-out states and turns: how jumpy the decoder is.",
    "tool_turn": "the same of the tool's velocity.",
    "tool_turn_p95": "95th percentile of these.",
}
"""Every measure in the order of the tables, and what it says."""


@dataclass(frozen=True)
class Measured:
    """What was measured.

    Attributes:
        figures: measure -> (S,), in the order of `MEASURES`; the planned one for its first seeds alone.
        measure_s: how long it took without planning, s.
        plan_s: how long planning took for one decoder, s.
    """

    figures: Mapping[str, FloatArray]
    measure_s: float
    plan_s: float


def measure_model(
    model: LatentActionModel,
    demonstrations: Demonstrations,
    held_out: Sequence[int],
    robot: Robot,
    preset: Preset,
    rng: np.random.Generator,
) -> Measured:
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
    config = EvaluationConfig(reach=reach)
    measured = measure(model, demonstrations, held_out, robot, rng=rng, config=config)
    figures = dict(measured.per_seed)
    episodes = moving_episodes(demonstrations, held_out)
    figures |= _turning(model, spread_contexts(episodes, "state", preset.turned_states), robot)
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
    return Measured({name: figures[name] for name in MEASURES if name in figures}, measure_s, plan_s)


def _turning(model: LatentActionModel, contexts: FloatArray, robot: Robot) -> dict[str, FloatArray]:
    decoders = [model.decoder(seed) for seed in range(model.seeds)]
    turned = turning(decoders, contexts, robot.chain)
    figures: dict[str, FloatArray] = {}
    for name, values in (("motion_turn", turned.joints), ("tool_turn", turned.tool)):
        flat = values.reshape(len(values), -1)
        figures[name] = np.nanmean(flat, axis=1)
        figures[f"{name}_p95"] = np.nanpercentile(flat, JUMPY, axis=1)
    return figures


def without_planning(preset: Preset) -> Preset:
    """The same sizes, with nothing asked of the operator who plans."""
    return replace(preset, planned_pairs=0)
