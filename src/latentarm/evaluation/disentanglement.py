"""Disentanglement: the angle between the directions in which z_1 and z_2 move the end-effector."""

import numpy as np

from latentarm.core.types import FloatArray

DEAD_SHARE = 0.01
"""An axis that changes the end-effector's motion by less than this share is dead: its remaining direction is
random, and random directions look half disentangled (57°)."""


def disentanglement_deg(effects: FloatArray) -> FloatArray:
    """Mean angle (S,), degrees in [0, 90], between the end-effector's directions for the first two axes.

    The direction of an axis at a state is half the difference between the effects of its ends, so a drift
    that both share does not count. The sign of a latent axis is arbitrary, so the angle is that between
    lines: 90 degrees is best, 0 is two axes that do the same.

    The mean is over the states in which both axes move the end-effector; NaN where d < 2, in no state both
    move it, or one of them is dead (`DEAD_SHARE`).
    """
    seeds, dim = effects.shape[:2]
    if dim < 2:
        return np.full(seeds, np.nan)
    first, second = np.moveaxis(effects[:, :2, :, -1] - effects[:, :2, :, 0], 1, 0) / 2.0
    sine = np.linalg.norm(np.cross(first, second), axis=-1)
    cosine = np.abs(np.sum(first * second, axis=-1))
    # atan2 keeps its precision near 0 and near 90 degrees, where arccos does not.
    angle = np.degrees(np.arctan2(sine, cosine))
    length = np.minimum(np.linalg.norm(first, axis=-1), np.linalg.norm(second, axis=-1))
    motion = np.linalg.norm(effects[:, :2, :, [0, -1]], axis=-1)
    alive = np.sqrt(np.mean(length**2, axis=-1)) > DEAD_SHARE * np.sqrt(np.mean(motion**2, axis=(1, 2, 3)))
    moves = (length > 0) & alive[:, None]
    count = moves.sum(axis=-1)
    total = np.where(moves, angle, 0.0).sum(axis=-1)
    return np.divide(total, count, out=np.full(seeds, np.nan), where=count > 0)
