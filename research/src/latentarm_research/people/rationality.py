"""How likely a Boltzmann-rational person is to take each option (equation 24)."""

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray


def boltzmann(cost: FloatArray, beta: FloatArray | float) -> FloatArray:
    """``p ∝ exp(-beta cost)`` over options, for any number of people at once.

    An option whose cost is not finite is never taken; where all are such, the first is taken for
    certain, so the first should be to do nothing. At beta = infinity the cheapest option gets all,
    ties share; at beta = 0 all options are as likely.

    Args:
        cost: (..., K), what each option costs, such as squared distances, m².
        beta: (...), rationality, zero or more, 1 over the unit of the cost; its axes broadcast
            against the leading axes of ``cost``.

    Returns:
        (..., K), each row sums to one.

    Raises:
        UserError: there are no options, or a beta is negative or not a number.
    """
    rationality = np.asarray(beta, dtype=np.float64)[..., None]
    if not cost.ndim or not cost.shape[-1]:
        raise UserError("A simulated person who chooses needs at least one option.")
    if not (rationality >= 0).all():
        raise UserError("A simulated person's rationality beta must be zero or more.")
    possible = np.isfinite(cost)
    possible[..., 0] |= ~possible.any(axis=-1)
    known = np.where(possible, cost, np.inf)
    least = known.min(axis=-1, keepdims=True)
    # No option has a finite cost, or the costs differ by more than floats can represent.
    with np.errstate(over="ignore", invalid="ignore"):
        above = np.minimum(known - least, np.finfo(np.float64).max)
        loss = np.where(known > least, rationality * above, 0.0)
    weight = np.where(possible, np.exp(-loss), 0.0)
    return weight / weight.sum(axis=-1, keepdims=True)
