"""The interface of an alignment."""

from collections.abc import Callable

from latentarm.core.types import FloatArray

Alignment = Callable[[FloatArray, FloatArray], FloatArray]
"""``z = f(u, c)`` (equation 4): inputs (..., d) and contexts (..., c), whose leading axes broadcast, to
latent actions (..., d)."""


def identity(u: FloatArray, context: FloatArray) -> FloatArray:
    """``z = u``: the alignment before anything is known about the person."""
    return u
