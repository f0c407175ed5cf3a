"""From when a gripper was toggled to how far it was told to be open."""

from dataclasses import replace

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Episode, FloatArray
from latentarm.demonstrations.gripper import ACTION_GRIPPER, GRIPPER_TOGGLED, GRIPPER_WIDTH, GripperStart
from latentarm.robots.gripper import Gripper


def widths_from_toggles(
    episodes: tuple[Episode, ...], gripper: Gripper | None, starts: GripperStart | None, source: str
) -> tuple[tuple[Episode, ...], str]:
    """Episodes whose gripper has a width where they say only when it was toggled.

    The width is the one that was commanded, fully open or fully closed. Nobody measured it: a gripper that
    holds something is open further.

    Args:
        episodes: with the feature `GRIPPER_TOGGLED`; without it they stay as they are.
        gripper: the robot's; without one the toggles stay what they are.
        starts: how the gripper is when an episode begins; open where None.
        source: the file, for messages.

    Returns:
        The episodes with `GRIPPER_WIDTH` and `ACTION_GRIPPER` in place of the toggles, and what was decided,
        in words; "" where nothing was.
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
    # Toggled after a sample: it is told there, and is so at the next.
    target = np.concatenate([width[1:], width[-1:]])
    kept = {name: values for name, values in episode.extras.items() if name != GRIPPER_TOGGLED}
    return replace(episode, extras={**kept, GRIPPER_WIDTH: width, ACTION_GRIPPER: target})
