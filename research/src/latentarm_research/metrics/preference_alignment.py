"""*Preference Alignment* of the paper's third user study: how the tool points, compared with the need."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.types import FloatArray, IntArray


def preference_alignment(
    points: FloatArray,  # (T, 3), unit vectors along which the tool points
    needed: FloatArray,  # (T, 3), unit vectors along which it should
) -> float:
    """The mean dot product of how the tool points and how it should, in [-1, 1]; NaN for no moments."""
    return float(np.vecdot(points, needed).mean()) if len(points) else np.nan


@final
@dataclass(frozen=True)
class StepAlignment:
    """*Preference Alignment* while one step of a task was under way."""

    step: str  # what was to be done, in words
    alignment: float  # mean dot product, as `preference_alignment`
    ticks: int  # of the loop that it took


def alignment_by_step(
    steps: Sequence[str],
    under_way: IntArray,  # (T,), index of the step that was under way
    points: FloatArray,  # (T, 3), see `preference_alignment`
    needed: FloatArray,  # (T, 3), as there
) -> tuple[StepAlignment, ...]:
    """*Preference Alignment* in each step that was begun, in order."""
    found: list[StepAlignment] = []
    for index, step in enumerate(steps):
        here = under_way == index
        if here.any():
            mean = preference_alignment(points[here], needed[here])
            found.append(StepAlignment(step, mean, int(here.sum())))
    return tuple(found)
