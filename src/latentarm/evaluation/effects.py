"""The effect of each latent axis on the end-effector: the basis of consistency and angles."""

from collections.abc import Sequence

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.evaluation.contract import DecodesActions, next_context
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.rotations import rotation_vector


def axis_grid(points: int) -> FloatArray:
    """A fixed, even grid (K,) of latent actions over [-1, 1]."""
    return np.linspace(-1.0, 1.0, points)


def axis_effects(
    decoders: Sequence[DecodesActions],
    context: FloatArray,
    grid: FloatArray,
    chain: Chain,
    step_s: float,
) -> FloatArray:
    """Displacement Psi(T(s, phi(z, s))) - Psi(s), (S, d, N, K, 3), m, for each latent axis alone.

    Each axis takes the values of ``grid`` (K,) in turn, for one step from each context (N, c), with the
    others at zero.
    """
    effects: list[FloatArray] = []
    for decoder in decoders:
        before, after = _axis_states(decoder, context, grid, step_s)
        moved = chain.forward(after).position - chain.forward(before).position[:, None]
        effects.append(moved)
    return np.stack(effects)


def axis_turns(
    decoders: Sequence[DecodesActions],
    context: FloatArray,
    grid: FloatArray,
    chain: Chain,
    step_s: float,
    tools: Sequence[int] = (0,),
) -> FloatArray:
    """Rotation vectors (S, d, T N, K, 3), rad, in the base frame, as `axis_effects` takes displacements.

    Each of the T end-effectors counts as N further states.
    """
    turns: list[FloatArray] = []
    for decoder in decoders:
        before, after = _axis_states(decoder, context, grid, step_s)
        of_tools = [
            rotation_vector(
                chain.forward(after, tool).rotation @ chain.forward(before, tool).rotation[:, None].mT
            )
            for tool in tools
        ]
        turns.append(np.concatenate(of_tools, axis=1))
    return np.stack(turns)


def _axis_states(
    decoder: DecodesActions, context: FloatArray, grid: FloatArray, step_s: float
) -> tuple[FloatArray, FloatArray]:
    """States (N, n) before and (d, N, K, n) after one step of each axis alone, rad."""
    dim = decoder.latent_dim
    z = np.einsum("k,ij->ikj", grid, np.eye(dim))[:, None]  # (d, 1, K, d)
    shape = (dim, len(context), len(grid))
    repeated = np.broadcast_to(context[:, None], (*shape, context.shape[-1]))
    action = decoder.decode(np.broadcast_to(z, (*shape, dim)), repeated)
    dof = action.shape[-1]
    return context[:, :dof], next_context(repeated, action, step_s)[..., :dof]


def held_paths(
    decoder: DecodesActions,
    context: FloatArray,
    z: FloatArray,
    chain: Chain,
    step_s: float,
    steps: int,
) -> FloatArray:
    """Places (L, N, T + 1, 3), m, of the end-effector while latent actions (L, d) are held for T steps."""
    latent = np.broadcast_to(z[:, None], (len(z), len(context), z.shape[-1]))
    now = np.broadcast_to(context, (len(z), *context.shape))
    action = decoder.decode(latent, now)
    dof = action.shape[-1]
    states = [now[..., :dof]]
    for _ in range(steps):
        now = next_context(now, action, step_s)
        states.append(now[..., :dof])
        action = decoder.decode(latent, now)
    return chain.forward(np.stack(states, axis=2)).position
