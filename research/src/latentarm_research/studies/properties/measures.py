"""The figures of section 8.1, each one per seed.

Where the paper is silent:

- Controllability: start and goal are states of the test set picked at random; where episodes differ in what
  lies still (the box's middle), both are of one episode. The arm moves by ``s' = s + a dt`` with the
  demonstrations' dt, and z is chosen anew twenty times a second. The search is greedy, so distances are upper
  bounds.
- Reach: a drive begins as a demonstration does, in a posture settled on a start, and ends where it is nearest
  to a goal in the region. Only the tool's place counts. Lengths are means over the drives.
- Rotate's R^2 is of how far the grippers turn, wherever they are; each gripper counts as further states.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from latentarm.core.types import Demonstrations, FloatArray, Pairs
from latentarm.demonstrations.pairs import make_pairs
from latentarm.evaluation.accuracy import pca_error, percent_of, reconstruction_error
from latentarm.evaluation.approach import SolverConfig, Target, approach
from latentarm.evaluation.consistency import consistency
from latentarm.evaluation.contract import DecodesActions
from latentarm.evaluation.controllability import ReachedGoals, reach_goals
from latentarm.evaluation.disentanglement import disentanglement_deg
from latentarm.evaluation.drift import drift
from latentarm.evaluation.effects import axis_effects, axis_grid, axis_turns
from latentarm.evaluation.reversal import reversal
from latentarm.evaluation.samples import StartGoalPairs, evenly_spread
from latentarm.models.model import LatentActionModel
from latentarm_research.studies.properties.preset import Preset
from latentarm_research.tasks.planar.motion import PlanarMotion
from latentarm_research.tasks.planar.paths import STEP_S
from latentarm_research.tasks.planar.reach import ReachRegion
from latentarm_research.tasks.planar.rotate import Rotate

SOLVER: Final = SolverConfig(time_s=5.0, joint_weight_m=0.0, refinements=1, hold=5, stall_s=0.6)
"""Only the tools' distance counts, in the search as in the figure: whatever else the search weighed would
enlarge the figure of a model that is free to wander in the other joints."""

CHOICES: Final = {1: 17, 2: 5}
"""Values of each axis that the search begins from, for d = 1 and d = 2. Over one latent axis, the decoders of
AE and VAE are curves with several nearest places, and 3 values leave them several times as far from their
goals. With 33 values and a choice every 0.02 s they come nearer by another 1.3 mm at most, conditioned models
by less than 0.1 mm (tried on two seeds each of sine and rotate)."""

RESOLUTION_M: Final = 1e-3
"""A mean distance to goals below this is the solver's more than the model's: a ratio to it says nothing. With
as many latent axes as the plane has, any model comes so near."""


def recorded_pairs(
    demonstrations: Demonstrations,
    rng: np.random.Generator,
) -> Pairs:
    """State-action pairs as recorded."""
    return make_pairs(demonstrations, 1, 0.0, "state", rng, actions="recorded")


def accuracy_figures(
    model: LatentActionModel,
    decoders: Sequence[DecodesActions],
    fitted: Pairs,
    pairs: Pairs,  # `recorded_pairs` of other demonstrations
) -> dict[str, FloatArray]:
    """Measure -> (S,), % of PCA's: the mean error over pairs, and the median of the episodes' mean errors."""
    baseline = pca_error(fitted.action, pairs.action, decoders[0].latent_dim)
    z = model.encode(pairs.context, pairs.action)
    of_all = reconstruction_error(decoders, z, pairs.context, pairs.action)
    each = [pairs.episode == episode for episode in np.unique(pairs.episode)]
    errors = [
        reconstruction_error(decoders, z[:, one], pairs.context[one], pairs.action[one]) for one in each
    ]
    by_pca = [pca_error(fitted.action, pairs.action[one], decoders[0].latent_dim) for one in each]
    return {
        "error_percent_of_pca": percent_of(baseline, of_all),
        "median_error_percent_of_pca": percent_of(float(np.median(by_pca)), np.median(errors, axis=0)),
    }


def latent_figures(
    motion: PlanarMotion,
    model: LatentActionModel,
    decoders: Sequence[DecodesActions],
    pairs: Pairs,
    preset: Preset,
) -> dict[str, FloatArray]:
    """Measure -> (S,): consistency with scalability, the angle between axes, drift and reversal."""
    chain, context = motion.robot.chain, pairs.context
    grid = axis_grid(preset.grid)
    states = context[evenly_spread(preset.states, len(context))]
    effects = axis_effects(decoders, states, grid, chain, STEP_S)
    turning = isinstance(motion, Rotate)
    seen = axis_turns(decoders, states, grid, chain, STEP_S, _tools(motion)) if turning else effects
    z = model.encode(context, pairs.action)
    figures = {
        "r2": consistency(seen, grid).mean(axis=1),
        "drift": drift(decoders, z, context),
        "reversal": reversal(decoders, z, context, STEP_S),
    }
    if motion.latent_dim > 1:
        figures["disentanglement_deg"] = disentanglement_deg(effects)
    return figures


def control_figures(
    motion: PlanarMotion,
    decoders: Sequence[DecodesActions],
    pca: DecodesActions,
    goals: StartGoalPairs,
) -> dict[str, FloatArray]:
    """Controllability, also in percent of PCA's on the same pairs: measure -> (S,).

    Of the mean over pairs and of the median, and the distance at the start, (1,), which does not depend on
    the model. Percentages are NaN where PCA's distance is below `RESOLUTION_M`.
    """

    def driven(some: Sequence[DecodesActions]) -> ReachedGoals:
        return reach_goals(some, goals, motion.robot.chain, STEP_S, _solver(motion), _tools(motion))

    def percent(left: FloatArray, by_pca: float) -> FloatArray:
        return percent_of(by_pca if by_pca > RESOLUTION_M else 0.0, left)

    reach, by_pca = driven(decoders), driven([pca]).tool_error_m
    left = reach.tool_error_m
    return {
        "controllability_m": left.mean(axis=1),
        "controllability_percent_of_pca": percent(left.mean(axis=1), float(by_pca.mean())),
        "median_controllability_percent_of_pca": percent(np.median(left, axis=1), float(np.median(by_pca))),
        "start_distance_m": reach.start_distance_m.mean(keepdims=True),
    }


def start_goal_pairs(
    motion: PlanarMotion,
    demonstrations: Demonstrations,  # E episodes, all of the same length
    count: int,
    rng: np.random.Generator,
) -> StartGoalPairs:
    """Pairs of states of demonstrations at random."""
    state = np.stack([episode.state for episode in demonstrations.episodes])
    episode = rng.integers(len(state), size=(2, count))
    if isinstance(motion, Rotate):
        episode[1] = episode[0]  # another box cannot be reached by turning this one
    start, goal = state[episode, rng.integers(state.shape[1], size=(2, count))]
    return StartGoalPairs(start=start, goal=goal)


def reach_figures(
    motion: ReachRegion, decoders: Sequence[DecodesActions], count: int, rng: np.random.Generator
) -> dict[str, FloatArray]:
    """Final distances to goals in the region, path lengths, and how crooked the paths are: measure -> (S,).

    Also the distance at the start, (1,). How crooked is the length over the way from start to end as the crow
    flies, of all drives together: NaN where none moves.
    """
    goals = motion.sample_goals(count, rng)
    places = np.concatenate([goals, np.zeros((count, 1))], axis=-1)
    start = np.stack([episode.state[0] for episode in motion.demonstrate(count, rng).episodes])
    chain = motion.robot.chain
    came = approach(decoders, start, Target(places[:, None]), chain, STEP_S, _solver(motion), _tools(motion))
    length, straight = came.path_m.mean(axis=1), came.straight_m.mean(axis=1)
    away = np.linalg.norm(chain.forward(start).position - places, axis=-1)
    return {
        "final_distance": came.distance_m.mean(axis=1),
        "path_length": length,
        "path_over_straight": np.divide(
            length, straight, out=np.full_like(length, np.nan), where=straight > 0
        ),
        "start_distance_m": away.mean(keepdims=True),
    }


def _tools(motion: PlanarMotion) -> range:
    return range(len(motion.robot.chain.tools))


def _solver(motion: PlanarMotion) -> SolverConfig:
    return replace(SOLVER, per_axis=CHOICES[motion.latent_dim])
