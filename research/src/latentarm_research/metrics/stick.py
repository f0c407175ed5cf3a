"""What the person's hand does during a drive: how long it rests, and how often it turns round."""

from typing import Final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray

TURNED_ROUND_S: Final = 0.5  # a change of direction counts as one where it takes no longer than this, s


def idle_time(
    time_s: FloatArray,  # (T,), when each input began, s; each holds until the next
    u: FloatArray,  # (T, d), inputs as they were used, zero within the dead zone
) -> float:
    """Time without input, s: *Idle Time* of the paper's third user study."""
    return float(np.diff(time_s) @ ~u[:-1].any(axis=-1))


def turned_round_share(
    time_s: FloatArray,  # (T,), when each input began, s, at a constant period; each holds until the next
    u: FloatArray,  # (T, d), inputs as they were used, zero within the dead zone
) -> float:
    """Share of the time, in [0, 1], in which the stick points away from where it pointed a moment ago.

    *Undo* of the paper's fourth user study: "the percentage of the time that users undo their actions by
    significantly changing the joystick direction". The paper names no threshold. Here a moment counts where
    the input is more than 90° from one within the last `TURNED_ROUND_S`.
    """
    if len(u) < 2:
        return 0.0
    period_s = float(np.median(np.diff(time_s)))
    turned = np.zeros(len(u), dtype=bool)
    for back in range(1, min(round(TURNED_ROUND_S / period_s), len(u) - 1) + 1):
        turned[back:] |= np.vecdot(u[back:], u[:-back]) < 0.0
    return float(np.mean(turned[:-1]))


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
