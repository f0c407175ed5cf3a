"""Converts toggles of a gripper to its commanded opening."""

from dataclasses import replace

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Episode, FloatArray
from latentarm.demonstrations.gripper import ACTION_GRIPPER, GRIPPER_TOGGLED, GRIPPER_WIDTH, GripperStart
from latentarm.robots.gripper import Gripper


def widths_from_toggles(
    episodes: tuple[Episode, ...], gripper: Gripper | None, starts: GripperStart | None, source: str
) -> tuple[tuple[Episode, ...], str]:
    """Episodes with `GRIPPER_WIDTH` and `ACTION_GRIPPER` instead of toggles, and a note, or "".

    The width is the commanded one, fully open or closed. Nobody measured it: a gripper that holds something
    is open further. Episodes stay as they are without `GRIPPER_TOGGLED` or without a gripper. ``starts`` is
    the state at an episode's beginning, open where None.
    """
    known = bool(episodes) and all(GRIPPER_TOGGLED in one.extras for one in episodes)
    if gripper is None or not known:
        if starts is not None:
            why = "the robot has no gripper" if known else f"{source} does not say when it was toggled"
            raise UserError(f"--gripper-starts is for toggles of a gripper, and {why}: leave it out.")
        return episodes, ""
    begun = starts or "open"
    changed = tuple(_with_width(one, begun, gripper.width_m) for one in episodes)
    count = sum(int(np.count_nonzero(np.diff(one.extras[GRIPPER_WIDTH], axis=0))) for one in changed)
    assumed = "as told" if starts else "assumed; say otherwise with --gripper-starts"
    moves = f"opened or closed {count} times" if count else "never toggled: it stays as it starts"
    return changed, (
        f"{begun} when an episode begins ({assumed}), {moves}; stored as {GRIPPER_WIDTH} and"
        f" {ACTION_GRIPPER}, {gripper.width_m:g} or 0 m: commanded, not measured"
    )


def _with_width(episode: Episode, starts: GripperStart, most_m: float) -> Episode:
    toggled = episode.extras[GRIPPER_TOGGLED]
    width: FloatArray = np.where((toggled > 0.0) ^ (starts == "open"), most_m, 0.0)
    # A toggle after a sample is commanded there, and takes effect at the next.
    target = np.concatenate([width[1:], width[-1:]])
    kept = {name: values for name, values in episode.extras.items() if name != GRIPPER_TOGGLED}
    return replace(episode, extras={**kept, GRIPPER_WIDTH: width, ACTION_GRIPPER: target})
