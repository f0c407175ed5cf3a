"""The interface of an alignment, and the seats of a person without one."""

from collections.abc import Callable
from typing import Literal

from latentarm.core.types import FloatArray

Alignment = Callable[[FloatArray, FloatArray], FloatArray]
"""``z = f(u, c)`` (equation 4): inputs (..., d) and contexts (..., c), whose leading axes broadcast, to
latent actions (..., d)."""

Seat = Literal["facing", "behind"]  # a person sits facing the arm or behind it


def identity(u: FloatArray, context: FloatArray) -> FloatArray:
    """``z = u``: the alignment before anything is known about the person."""
    return u
