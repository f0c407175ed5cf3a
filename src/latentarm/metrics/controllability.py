"""Controllability: how near latent actions alone can bring the arm to another demonstrated state.

Section 8.1: take pairs of start and goal states of the test set, solve for the latent actions that
minimise the error to the goal, and report the least error. The solver here is a greedy operator: at every
step it chooses the z in [-1, 1]^d whose next state s + phi(z, s) dt is nearest to the goal, where

    distance^2 = ‖Psi(s') - Psi(s_j)‖^2 + (w ‖s' - s_j‖)^2,

with w in metres per radian. The tool's place decides; the joints say which of the arm's many ways to get
there leads on. Each choice is the best of a small fixed set of latent actions (an even grid over the box
and the choice before), bettered by Gauss-Newton steps inside the box. All pairs go
through the solver at once. A greedy choice can lead into a dead end, so the figure is an upper bound on
what the latent space allows.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from latentarm.metrics.contract import DecodesActions, PlacesTool, next_context
from latentarm.metrics.samples import StartGoalPairs
from latentarm.types import FloatArray

DIFFERENCE = 1e-4  # of z, for numeric derivatives: well under an input step, well over rounding
STEP_LENGTHS = (1.0, 0.5, 0.2)  # of a Gauss-Newton step; the best is kept, and only if it is better
DAMPING = 1e-6  # relative to the largest curvature


@dataclass(frozen=True)
class ReachConfig:
    """What is asked of the greedy operator.

    Attributes:
        pairs: number of start-goal pairs.
        separation_s: time between start and goal in the demonstration, s.
        time_s: time in which to get there; the nearest moment counts, s.
        joint_weight_m: w, what one radian of joint error weighs beside tool error, m/rad.
        refinements: Gauss-Newton steps at every choice.
    """

    pairs: int = 200
    separation_s: float = 3.0
    time_s: float = 6.0
    joint_weight_m: float = 0.05
    refinements: int = 2


@dataclass(frozen=True)
class Reach:
    """How near the arm came to each of P goals, for each of S seeds.

    Attributes:
        tool_error_m: (S, P), least distance of the tool from its place at the goal, m.
        state_error_rad: (S, P), ‖s - s_j‖ at that moment, rad.
        start_distance_m: (P,), distance of the tool at the start, m.
    """

    tool_error_m: FloatArray
    state_error_rad: FloatArray
    start_distance_m: FloatArray


def reach_goals(
    decoders: Sequence[DecodesActions],
    pairs: StartGoalPairs,
    chain: PlacesTool,
    step_s: float,
    config: ReachConfig,
    tool: int = 0,
) -> Reach:
    """Drive from every start towards its goal with every decoder; see the module's text.

    Args:
        decoders: S decoders.
        pairs: P start-goal pairs.
        chain: the robot's forward kinematics.
        step_s: dt of the transition, s.
        config: the solver's settings.
        tool: which end-effector, where there are several.
    """
    goal_place = chain.forward(pairs.goal, tool).position
    start_place = chain.forward(pairs.start[:, : pairs.goal.shape[1]], tool).position
    steps = max(1, round(config.time_s / step_s))
    tool_errors: list[FloatArray] = []
    state_errors: list[FloatArray] = []
    for decoder in decoders:
        problem = _Problem(decoder, pairs.goal, goal_place, chain, tool, step_s, config.joint_weight_m)
        tool_error, state_error = _drive(problem, pairs.start, steps, config.refinements)
        tool_errors.append(tool_error)
        state_errors.append(state_error)
    return Reach(
        tool_error_m=np.stack(tool_errors),
        state_error_rad=np.stack(state_errors),
        start_distance_m=np.linalg.norm(start_place - goal_place, axis=-1),
    )


@dataclass(frozen=True)
class _Problem:
    """P goals and the decoder that is to reach them."""

    decoder: DecodesActions
    goal: FloatArray  # (P, n)
    goal_place: FloatArray  # (P, 3)
    chain: PlacesTool
    tool: int
    step_s: float
    joint_weight_m: float

    def residual(self, context: FloatArray) -> FloatArray:
        """Weighted error (P, K, 3 + n), m, of contexts (P, K, c)."""
        state = context[..., : self.goal.shape[-1]]
        place = self.chain.forward(state, self.tool).position
        joint = self.joint_weight_m * (state - self.goal[:, None])
        return np.concatenate([place - self.goal_place[:, None], joint], axis=-1)

    def outcome(self, context: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Next contexts (P, K, c) and their residuals for latent actions z (P, K, d) in contexts (P, c)."""
        repeated = np.broadcast_to(context[:, None], (*z.shape[:-1], context.shape[-1]))
        following = next_context(repeated, self.decoder.decode(z, repeated), self.step_s)
        return following, self.residual(following)


def _drive(
    problem: _Problem, start: FloatArray, steps: int, refinements: int
) -> tuple[FloatArray, FloatArray]:
    """Least tool error (P,), m, on the way from the starts (P, c), and the joint error then, rad."""
    context = start
    z = np.zeros((len(start), problem.decoder.latent_dim))
    residual = problem.residual(context[:, None])[:, 0]
    best_tool = np.linalg.norm(residual[:, :3], axis=-1)
    best_state = np.linalg.norm(context[:, : problem.goal.shape[1]] - problem.goal, axis=-1)
    for _ in range(steps):
        z, context, residual = _choose(problem, context, z, refinements)
        tool_error = np.linalg.norm(residual[:, :3], axis=-1)
        nearer = tool_error < best_tool
        state_error = np.linalg.norm(context[:, : problem.goal.shape[1]] - problem.goal, axis=-1)
        best_state = np.where(nearer, state_error, best_state)
        best_tool = np.where(nearer, tool_error, best_tool)
    return best_tool, best_state


def _choose(
    problem: _Problem, context: FloatArray, previous: FloatArray, refinements: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The latent action (P, d) that leads nearest to the goal, the next context and its residual."""
    fixed = candidates(problem.decoder.latent_dim)
    tried = np.broadcast_to(fixed, (len(context), *fixed.shape))
    z, following, residual = _best(problem, context, np.concatenate([previous[:, None], tried], axis=1))
    for _ in range(refinements):
        step = _gauss_newton(problem, context, z, residual)
        lengths = np.array((0.0, *STEP_LENGTHS))[:, None]
        z, following, residual = _best(
            problem, context, np.clip(z[:, None] + lengths * step[:, None], -1.0, 1.0)
        )
    return z, following, residual


def candidates(latent_dim: int) -> FloatArray:
    """Latent actions (K, d) to start from: an even grid up to d = 3, beyond that the ends of each axis."""
    if latent_dim <= 3:
        per_axis = np.linspace(-1.0, 1.0, 5 if latent_dim < 3 else 3)
        return np.array(list(itertools.product(per_axis, repeat=latent_dim)))
    ends = np.eye(latent_dim)
    return np.concatenate([np.zeros((1, latent_dim)), ends, -ends])


def _best(problem: _Problem, context: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of latent actions (P, K, d) the best for each pair, with its next context and residual."""
    following, residual = problem.outcome(context, z)
    cost = np.sum(residual**2, axis=-1)
    # A decoder that overflows far from its data must lose, not win, the comparison.
    row, best = np.arange(len(context)), np.argmin(np.where(np.isfinite(cost), cost, np.inf), axis=1)
    return z[row, best], following[row, best], residual[row, best]


def _gauss_newton(problem: _Problem, context: FloatArray, z: FloatArray, residual: FloatArray) -> FloatArray:
    """Gauss-Newton step (P, d) in the latent axes that are free to move inside the box."""
    dim = z.shape[-1]
    # Differences are taken inwards, so that z never leaves the box.
    inward = np.where(z > 0, -DIFFERENCE, DIFFERENCE)
    _, shifted = problem.outcome(context, z[:, None] + np.eye(dim) * inward[:, None])
    jacobian = np.swapaxes(shifted - residual[:, None], 1, 2) / inward[:, None]  # (P, 3 + n, d)
    gradient = np.einsum("pri,pr->pi", jacobian, residual)
    held = ((z >= 1.0) & (gradient < 0)) | ((z <= -1.0) & (gradient > 0))
    jacobian = np.where(held[:, None], 0.0, jacobian)
    curvature = np.einsum("pri,prj->pij", jacobian, jacobian)
    damping = DAMPING * np.trace(curvature, axis1=1, axis2=2) + np.finfo(float).tiny
    damped = curvature + (damping[:, None] + held)[..., None] * np.eye(dim)
    return -np.linalg.solve(damped, np.where(held, 0.0, gradient)[..., None])[..., 0]
