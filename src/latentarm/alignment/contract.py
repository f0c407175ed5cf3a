"""The interface of an alignment, the seats of a person without one, and why one is refused."""

from collections.abc import Callable
from typing import Literal

from latentarm.core.types import FloatArray

Alignment = Callable[[FloatArray, FloatArray], FloatArray]
"""``z = f(u, c)`` (equation 4): inputs (..., d) and contexts (..., c), whose leading axes broadcast, to
latent actions (..., d)."""

Seat = Literal["facing", "behind"]  # a person sits facing the arm or behind it

Refusal = Literal["answers_agree", "answers_alike", "answers_few", "answers_unclear", "answers_weak"]
"""Why nothing is kept of answers: they agree with the present directions, are all the same or on one line,
are too few, do not fit the motions, or leave a direction that hardly moves the arm."""


def identity(u: FloatArray, context: FloatArray) -> FloatArray:
    """``z = u``: the alignment before anything is known about the person."""
    return u
