"""Reversal: how much of a motion remains after the opposite input."""

from collections.abc import Sequence

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.evaluation.contract import DecodesActions, next_context


def reversal(
    decoders: Sequence[DecodesActions],
    z: FloatArray,
    context: FloatArray,
    step_s: float,
    hold_s: float | None = None,
) -> FloatArray:
    """Mean ‖s2 - s0‖ over mean ‖s1 - s0‖: z is held from s0 to s1, then -z from s1 to s2.

    While an input is held, the arm follows s' = s + phi(z, s) dt without inertia or limits. The two means
    are taken before the ratio, so that states in which z hardly moves the arm do not dominate. 0 is a motion
    fully undone; 1 leaves as far to go back as the motion was long; 2 is a decoder that ignores z's sign.

    Latent actions (S, N, d) begin in contexts (N, c) of s0. Each of z and -z is held for ``hold_s`` in equal
    steps of about ``step_s``, or for one step where that is None. The ratio (S,) is NaN where no z moves the
    arm at all, or where the arm leaves all bounds.
    """
    steps = 1 if hold_s is None else max(1, round(hold_s / step_s))
    step_s = step_s if hold_s is None else hold_s / steps
    left = np.full(len(decoders), np.nan)
    for seed, (decoder, latent) in enumerate(zip(decoders, z, strict=True)):
        # Where a decoder is fast and far from its data, a long hold may diverge.
        with np.errstate(over="ignore", invalid="ignore"):
            at, forth = _held(decoder, latent, context, step_s, steps)
            _, back = _held(decoder, -latent, at, step_s, steps)
            moved = np.linalg.norm(forth, axis=-1).mean()
            remains = np.linalg.norm(forth + back, axis=-1).mean()
        if moved > 0 and np.isfinite(remains):
            left[seed] = remains / moved
    return left


def _held(
    decoder: DecodesActions, latent: FloatArray, context: FloatArray, step_s: float, steps: int
) -> tuple[FloatArray, FloatArray]:
    """The contexts (N, c) after a held input (N, d), and the sum of the actions (N, m) on the way, rad/s."""
    action = decoder.decode(latent, context)
    total, context = action, next_context(context, action, step_s)
    for _ in range(steps - 1):
        action = decoder.decode(latent, context)
        total, context = total + action, next_context(context, action, step_s)
    return context, total
