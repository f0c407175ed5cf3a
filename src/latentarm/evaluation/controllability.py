"""Controllability: how close latent actions alone can bring the arm to another demonstrated state.

Section 8.1: take pairs of start and goal states of the test set, solve for the latent actions that
minimise the error to the goal, and report the least error. The solver is the greedy operator of
`latentarm.evaluation.approach`, so the figure is an upper bound on what the latent space allows.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.evaluation.approach import SolverConfig, Target, approach, mean_distance, tool_places
from latentarm.evaluation.contract import DecodesActions
from latentarm.evaluation.samples import StartGoalPairs
from latentarm.robots.kinematics.chain import Chain


@dataclass(frozen=True)
class ReachConfig:
    """The controllability test for the greedy operator."""

    pairs: int = 200  # number of start-goal pairs
    separation_s: float = 3.0  # time between start and goal in the demonstration, s
    solver: SolverConfig = field(default_factory=SolverConfig)


@dataclass(frozen=True)
class ReachedGoals:
    """How close the arm came to each of P goals, for each of S seeds."""

    tool_error_m: FloatArray  # (S, P), least distance of the tools from the goal, mean over tools, m
    state_error_rad: FloatArray  # (S, P), ‖s - s_j‖ at that moment, rad
    start_distance_m: FloatArray  # (P,), distance of the tools at the start, mean over tools, m


def reach_goals(
    decoders: Sequence[DecodesActions],
    pairs: StartGoalPairs,
    chain: Chain,
    step_s: float,
    config: SolverConfig,
    tools: Sequence[int] = (0,),
) -> ReachedGoals:
    """Drive from every start towards its goal with every decoder, in steps of ``step_s``."""
    dof = pairs.goal.shape[1]
    goal = Target(tool_places(chain, pairs.goal, tools), pairs.goal)
    came = approach(decoders, pairs.start, goal, chain, step_s, config, tools)
    first = tool_places(chain, pairs.start[:, :dof], tools)
    return ReachedGoals(
        tool_error_m=came.distance_m,
        state_error_rad=np.linalg.norm(came.context[..., :dof] - pairs.goal, axis=-1),
        start_distance_m=mean_distance(first, goal.places),
    )
