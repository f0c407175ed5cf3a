"""Time that goes into mode switches."""

import numpy as np

from latentarm.core.types import BoolArray, FloatArray


def switching(
    mode: FloatArray,  # (T,), the controller's mode
    pushed: BoolArray,  # (T,), whether the stick was pushed
) -> BoolArray:
    """Which samples of a drive are spent on switching modes, (T,).

    Those from the last push before a switch until the first one after it; several switches on the way to a
    mode are one such time.
    """
    spent = np.zeros(len(mode), dtype=np.bool_)
    pushes = np.flatnonzero(pushed)
    for switched in np.flatnonzero(np.diff(mode)) + 1:
        before, after = pushes[pushes < switched], pushes[pushes >= switched]
        first = before[-1] + 1 if len(before) else 0
        spent[first : after[0] if len(after) else len(mode)] = True
    return spent
