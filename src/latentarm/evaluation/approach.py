"""A greedy operator: how close it brings the tools to target positions by latent actions alone.

At every step it chooses the z in [-1, 1]^d whose next state s' = s + phi(z, s) dt is nearest to the target:

    distance^2 = (mean over tools of ‖Psi(s') - x‖^2) + (w ‖s' - s_j‖)^2,

with w in metres per radian. The tool's position dominates; joints, if the target gives them, choose among
the arm's many ways to get there. Each choice is the best of a small fixed set of latent actions (an even
grid over the box and the previous choice), refined by Gauss-Newton steps inside the box. All drives go
through the solver at once. A greedy choice can lead into a dead end, so the distance is an upper bound on
what the latent space allows.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from latentarm.core.types import FloatArray, IntArray
from latentarm.evaluation.contract import DecodesActions, next_context, zero_latent
from latentarm.robots.kinematics.chain import Chain

DIFFERENCE = 1e-4  # of z, for numeric derivatives: well under an input step, well over rounding
STEP_LENGTHS = (1.0, 0.5, 0.2)  # of a Gauss-Newton step; the best is kept, and only if it is better
DAMPING = 1e-6  # relative to the largest curvature
PROGRESS_M = 1e-4  # a drive that comes nearer by less than this has stalled


@dataclass(frozen=True)
class SolverConfig:
    """Settings of the greedy operator."""

    time_s: float = 6.0  # time limit; the closest moment counts, s
    joint_weight_m: float = 0.05  # w, what one radian of joint error weighs beside tool error, m/rad
    refinements: int = 2
    hold: int = 1  # steps for which a choice is held; it is chosen as if one step were this long
    per_axis: int = 5  # values of each latent axis in the fixed set of choices, up to d = 2
    stall_s: float = math.inf  # a drive ends after this long without progress of `PROGRESS_M`, s


@dataclass(frozen=True)
class Target:
    """The targets of P drives."""

    places: FloatArray  # (P, T, 3), of the T tools, m
    state: FloatArray | None = None  # (P, n), the posture wanted there, rad, or None where none is


@dataclass(frozen=True)
class Approach:
    """P drives up to the moment of closest approach to the target, for each of S seeds."""

    distance_m: FloatArray  # (S, P), of the tools from their places at that moment, mean over tools, m
    context: FloatArray  # (S, P, c), at that moment
    path_m: FloatArray  # (S, P), path length of the tools until then, mean over tools, m
    straight_m: FloatArray  # (S, P), the straight-line distance, m


def approach(
    decoders: Sequence[DecodesActions],
    start: FloatArray,
    target: Target,
    chain: Chain,
    step_s: float,
    config: SolverConfig,
    tools: Sequence[int] = (0,),
) -> Approach:
    """Drive from every start (P, c) towards its target with every decoder; see the module's text."""
    drives = [_drive(_Problem(decoder, target, chain, tools, step_s, config), start) for decoder in decoders]
    distance, context, path, straight = (np.stack(part) for part in zip(*drives, strict=True))
    return Approach(distance_m=distance, context=context, path_m=path, straight_m=straight)


def tool_places(chain: Chain, state: FloatArray, tools: Sequence[int]) -> FloatArray:
    """Places (..., T, 3) of T tools at states (..., n), m."""
    return np.stack([chain.forward(state, tool).position for tool in tools], axis=-2)


def mean_distance(first: FloatArray, second: FloatArray) -> FloatArray:
    """Distance (...,) between places (..., T, 3), mean over tools, m."""
    return np.linalg.norm(first - second, axis=-1).mean(axis=-1)


@dataclass(frozen=True)
class _Problem:
    """P targets and the decoder that is to reach them."""

    decoder: DecodesActions
    target: Target
    chain: Chain
    tools: Sequence[int]
    step_s: float
    config: SolverConfig

    def of(self, drives: IntArray) -> "_Problem":
        """The same problem with only some of the drives."""
        state = self.target.state
        return replace(
            self, target=Target(self.target.places[drives], None if state is None else state[drives])
        )

    def residual(self, context: FloatArray, z: FloatArray) -> FloatArray:
        """Vectors (P, K, 3 T + n) whose square is distance^2, m, after z (P, K, d) in contexts (P, c)."""
        action = self.decoder.decode(z, context[:, None])
        state = context[:, None, : action.shape[-1]] + self.config.hold * self.step_s * action
        places = tool_places(self.chain, state, self.tools)
        away = (places - self.target.places[:, None]).reshape(*places.shape[:2], -1) / math.sqrt(
            len(self.tools)
        )
        if self.target.state is None:
            return away
        joint = self.config.joint_weight_m * (state - self.target.state[:, None])
        return np.concatenate([away, joint], axis=-1)


def _drive(problem: _Problem, start: FloatArray) -> tuple[FloatArray, ...]:
    """The arrays of `Approach` for one seed: distance, context, path and straight way."""
    config, target, z = problem.config, problem.target.places, zero_latent(problem.decoder, start)
    dof = problem.decoder.decode(z, start).shape[-1]
    first = tool_places(problem.chain, start[:, :dof], problem.tools)
    distance, nearest = mean_distance(first, target), start.copy()
    path, straight = np.zeros((2, len(start)))
    steps = max(1, round(config.time_s / problem.step_s))
    # The drives still running: their indices and their progress.
    running, waited, way = np.arange(len(start)), np.zeros(len(start)), np.zeros(len(start))
    mark, context, places = distance.copy(), start, first
    for step in range(steps):
        if step % config.hold == 0:
            z = _choose(problem.of(running), context, z)
        context = next_context(context, problem.decoder.decode(z, context), problem.step_s)
        before, places = places, tool_places(problem.chain, context[:, :dof], problem.tools)
        way = way + mean_distance(places, before)
        left = mean_distance(places, target[running])
        nearer = left < distance[running]
        better = running[nearer]
        distance[better], nearest[better], path[better] = left[nearer], context[nearer], way[nearer]
        straight[better] = mean_distance(places[nearer], first[better])
        advanced = left < mark - PROGRESS_M
        mark, waited = np.where(advanced, left, mark), np.where(advanced, 0.0, waited + problem.step_s)
        on = waited < config.stall_s
        running, waited, way, mark = running[on], waited[on], way[on], mark[on]
        context, places, z = context[on], places[on], z[on]
        if not len(running):
            break
    return distance, nearest, path, straight


def _choose(problem: _Problem, context: FloatArray, previous: FloatArray) -> FloatArray:
    """The latent action (P, d) that leads nearest to the target."""
    fixed = candidates(problem.decoder.latent_dim, problem.config.per_axis)
    tried = np.broadcast_to(fixed, (len(context), *fixed.shape))
    z, residual = _best(problem, context, np.concatenate([previous[:, None], tried], axis=1))
    for _ in range(problem.config.refinements):
        step = _gauss_newton(problem, context, z, residual)
        lengths = np.array((0.0, *STEP_LENGTHS))[:, None]
        z, residual = _best(problem, context, np.clip(z[:, None] + lengths * step[:, None], -1.0, 1.0))
    return z


def candidates(latent_dim: int, per_axis: int) -> FloatArray:
    """Latent actions (K, d) to start from: an even grid up to d = 3, beyond that the ends of each axis."""
    if latent_dim <= 3:
        values = np.linspace(-1.0, 1.0, per_axis if latent_dim < 3 else 3)
        return np.array(list(itertools.product(values, repeat=latent_dim)))
    ends = np.eye(latent_dim)
    return np.concatenate([np.zeros((1, latent_dim)), ends, -ends])


def _best(problem: _Problem, context: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Of latent actions (P, K, d) the best for each drive, and its residual."""
    residual = problem.residual(context, z)
    cost = np.sum(residual**2, axis=-1)
    # A decoder that overflows far from its data must lose the comparison.
    row, best = np.arange(len(context)), np.argmin(np.where(np.isfinite(cost), cost, np.inf), axis=1)
    return z[row, best], residual[row, best]


def _gauss_newton(problem: _Problem, context: FloatArray, z: FloatArray, residual: FloatArray) -> FloatArray:
    """Gauss-Newton step (P, d) in the latent axes that are free to move inside the box."""
    dim = z.shape[-1]
    # Differences are taken inwards, so that z never leaves the box.
    inward = np.where(z > 0, -DIFFERENCE, DIFFERENCE)
    shifted = problem.residual(context, z[:, None] + np.eye(dim) * inward[:, None])
    jacobian = np.swapaxes(shifted - residual[:, None], 1, 2) / inward[:, None]  # (P, residuals, d)
    gradient = np.einsum("pri,pr->pi", jacobian, residual)
    held = ((z >= 1.0) & (gradient < 0)) | ((z <= -1.0) & (gradient > 0))
    jacobian = np.where(held[:, None], 0.0, jacobian)
    curvature = np.einsum("pri,prj->pij", jacobian, jacobian)
    damping = DAMPING * np.trace(curvature, axis1=1, axis2=2) + np.finfo(float).tiny
    damped = curvature + (damping[:, None] + held)[..., None] * np.eye(dim)
    return -np.linalg.solve(damped, np.where(held, 0.0, gradient)[..., None])[..., 0]
