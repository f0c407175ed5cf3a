"""Alternative inputs: the set ``U`` over which a likelihood is normalised."""

import numpy as np

from latentarm.types import FloatArray

_ANGLES = np.arange(8) * (2 * np.pi / 8)
_COS, _SIN = np.cos(_ANGLES), np.sin(_ANGLES)
_TURNS = np.stack([np.stack([_COS, -_SIN], -1), np.stack([_SIN, _COS], -1)], -2)
"""(8, 2, 2), rotations by equal angles, no turn first."""

_LEVELS = np.array([[-1.0], [-0.6], [-0.2], [0.2], [0.6], [1.0]])
"""(6, 1), how far a person with one axis is taken to press it."""


def alternatives(u: FloatArray) -> FloatArray:
    """The inputs that the person could have given, ``u`` first.

    - Two axes: ``u`` turned through eight equal angles.
    - One axis: ``u`` and six levels from -1 to 1. A nonlinear decoder need not do the opposite at
      ``-u``, so ``{u, -u}`` would represent the rejected alternatives poorly. Pressing gently is no
      evidence against a goal: such alternatives are compared `at_one_speed`.
    - More axes: ``u`` and ``±‖u‖`` along every axis.

    Args:
        u: (..., d), the input.

    Returns:
        (..., K, d).
    """
    d = u.shape[-1]
    if d == 2:
        return np.matvec(_TURNS, u[..., None, :])
    if d == 1:
        levels = np.broadcast_to(_LEVELS, (*u.shape[:-1], *_LEVELS.shape))
        return np.concatenate([u[..., None, :], levels], axis=-2)
    along = np.sqrt(np.vecdot(u, u))[..., None, None] * np.eye(d)
    return np.concatenate([u[..., None, :], along, -along], axis=-2)


def at_one_speed(actions: FloatArray) -> FloatArray:
    """The alternatives, scaled to the speed of the chosen action, so that only directions are compared.

    Args:
        actions: (..., K, n), rad/s, the chosen one first.

    Returns:
        (..., K, n), rad/s; an action of zero stays zero.
    """
    speed = np.sqrt(np.vecdot(actions, actions))[..., None]
    return actions * (speed[..., :1, :] / np.where(speed > 0.0, speed, 1.0))
