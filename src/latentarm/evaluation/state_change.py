"""Consistency in state: how much the same input means something else close by.

Section 4 of the paper calls a latent space consistent if the same z has a similar effect in nearby states,
d_M(T(s1, phi(z, s1)), T(s2, phi(z, s2))) < eps where ‖s1 - s2‖ < delta (equation 5). With d_M the distance
in joint space, less that of the two states themselves, this is ‖phi(z, s1) - phi(z, s2)‖ dt. R^2 of section
8.1 (see `latentarm.evaluation.consistency`) takes states from all over a task instead, and the tool for the
arm.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.evaluation.contract import DecodesActions, decode_all

NEAR_RAD: Final = 0.1
"""Distance ‖s1 - s2‖ of two neighbouring states, rad: what recorded arms cross in 0.1 to 0.2 s."""


def state_change(decoders: Sequence[DecodesActions], z: FloatArray, context: FloatArray) -> FloatArray:
    """Mean ‖phi(z, s2) - phi(z, s1)‖ over mean ‖phi(z, s1)‖, with ‖s2 - s1‖ = `NEAR_RAD`.

    The directions from s1 to s2 are drawn evenly from all directions, the same for every decoder. 0 is a
    decoder that does not see the state; 1 changes the motion as much as the motion is fast. Latent actions
    are (S, N, d), contexts (N, c). The ratio (S,) is NaN where no z moves the arm at all.
    """
    here = decode_all(decoders, z, context)
    drawn = np.random.default_rng(0).normal(size=here.shape[1:])
    beside = context.copy()
    beside[:, : here.shape[-1]] += NEAR_RAD * drawn / np.linalg.norm(drawn, axis=-1, keepdims=True)
    changed = np.linalg.norm(decode_all(decoders, z, beside) - here, axis=-1).mean(axis=1)
    moved = np.linalg.norm(here, axis=-1).mean(axis=1)
    return np.divide(changed, moved, out=np.full_like(moved, np.nan), where=moved > 0)
