"""What the tests of all studies have in common."""

from collections.abc import Callable, Sequence
from typing import Any, Final, cast

import numpy as np

from latentarm.types import FloatArray

LEVEL: Final = 0.05
"""A test holds where p, after Holm's correction, is below this."""

NO_SPREAD: Final = 1e-9
"""SD, in the largest figure, below which several figures are the same but for rounding."""


def spreads(values: FloatArray) -> bool:
    """Whether figures (n,) differ by more than rounding."""
    return len(values) > 1 and float(values.std(ddof=1)) > NO_SPREAD * float(np.abs(values).max())


def holm(p: Sequence[float | None]) -> list[float | None]:
    """p-values of one family after Holm's correction; None is what was not tested, and does not count."""
    import pingouin  # takes a second, and only a finished study needs it

    tested = [one for one in p if one is not None]
    if not tested:
        return list(p)
    multicomp = cast(Callable[..., tuple[Any, FloatArray]], pingouin.multicomp)
    corrected = iter(multicomp(np.array(tested), alpha=LEVEL, method="holm")[1])
    return [None if one is None else float(next(corrected)) for one in p]


def format_p(p: float | None) -> str:
    """A p-value to three places, or ``< 0.001``."""
    if p is None:
        return "not tested"
    return "< 0.001" if p < 0.001 else f"{p:.3f}"
