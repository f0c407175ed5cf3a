"""What a dataset says of a gripper: its features, what is checked of them, and how they are counted."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, Demonstrations, Episode, FloatArray
from latentarm.robots.gripper import Gripper

GRIPPER_WIDTH: Final = "observation.gripper_width"
"""Opening between the fingers, m: as measured, or as commanded where only that is known; the record of the
import then says so."""

GRIPPER_HOLDING: Final = "observation.gripper_holding"
"""Whether something is held between them: 0 or 1."""

GRIPPER_TOGGLED: Final = "observation.gripper_toggled"
"""Whether the gripper is other than when the episode began: 0 or 1."""

GRIPPER_OPENING: Final = "observation.gripper_opening"
"""Share of the gripper's opening, from 0 (closed) to 1 (open)."""

GRIPPER: Final = "observation.gripper"
"""The gripper as it was recorded, where its unit is unknown."""

ACTION_GRIPPER: Final = "action.gripper"
"""Where the gripper is to go, in the unit of what was observed of it: m with `GRIPPER_WIDTH`."""

OBSERVED: Final = (GRIPPER_WIDTH, GRIPPER_HOLDING, GRIPPER_TOGGLED, GRIPPER_OPENING, GRIPPER)
"""What a gripper is at a moment, rather than what is done with it then."""

GripperStart = Literal["open", "closed"]
"""How a gripper is when an episode begins."""

_WIDEST_M: Final = 1.0
"""No gripper opens further: a width beyond it is in another unit, m."""

_YES_OR_NO: Final = (GRIPPER_HOLDING, GRIPPER_TOGGLED)


@final
@dataclass(frozen=True)
class GripperUse:
    """What a gripper did in an episode.

    Attributes:
        changes: how often it was opened or closed.
        closed_fraction: share of the time in which it was closed or closing, or None where that is not known.
        toggled_fraction: share of the time in which it was other than at the beginning, where no more than
            that is known, or else None.
    """

    changes: int
    closed_fraction: float | None = None
    toggled_fraction: float | None = None


def gripper_uses(demonstrations: Demonstrations, gripper: Gripper | None = None) -> tuple[GripperUse, ...]:
    """What the gripper did in each episode.

    It counts as closed where it holds something, or is to go (or, where that is not recorded, is) at most
    half of its largest opening.

    Args:
        demonstrations: whole, validated episodes.
        gripper: what it is; without it the largest opening is the one in the demonstrations.

    Returns:
        As many as episodes; none where no feature of a known unit and of one gripper is recorded.
    """
    extras = [episode.extras for episode in demonstrations.episodes]
    observed = next(
        (
            name
            for name in (GRIPPER_WIDTH, GRIPPER_OPENING, GRIPPER_TOGGLED)
            if name in extras[0] and extras[0][name].shape[1] == 1
        ),
        None,
    )
    if observed is None:
        return ()
    if observed == GRIPPER_TOGGLED:
        return tuple(_toggled(episode) for episode in demonstrations.episodes)
    if observed == GRIPPER_OPENING:
        most = 1.0
    elif gripper is not None:
        most = gripper.width_m
    else:
        most = max(float(one[GRIPPER_WIDTH].max()) for one in extras)
    return tuple(_closed(episode, observed, most / 2.0) for episode in demonstrations.episodes)


def _toggled(episode: Episode) -> GripperUse:
    toggled = episode.extras[GRIPPER_TOGGLED][:, 0] > 0.0
    return GripperUse(_changes(toggled), toggled_fraction=_share(toggled, episode.timestamp))


def _closed(episode: Episode, observed: str, half: float) -> GripperUse:
    width = episode.extras[observed]
    target = episode.extras.get(ACTION_GRIPPER, width)
    closed = (target if target.shape == width.shape else width)[:, 0] <= half
    if GRIPPER_HOLDING in episode.extras:
        closed |= episode.extras[GRIPPER_HOLDING].any(axis=1)
    return GripperUse(_changes(closed), closed_fraction=_share(closed, episode.timestamp))


def _changes(state: BoolArray) -> int:
    return int(np.count_nonzero(state[1:] != state[:-1]))


def _share(state: BoolArray, time_s: FloatArray) -> float:
    """Share of the time in which it is true: each sample counts until the next."""
    elapsed_s = np.diff(time_s)
    return float(elapsed_s[state[:-1]].sum() / elapsed_s.sum())


def check_gripper(episode: Episode, where: str) -> None:
    """Check an episode's features of a gripper, whose shapes are known to be right.

    Args:
        episode: what to check.
        where: the file and the episode, for the message.

    Raises:
        UserError: an opening in m is below zero or absurdly large, or what is yes or no is neither 0 nor 1.
    """
    for name in (GRIPPER_WIDTH, ACTION_GRIPPER) if GRIPPER_WIDTH in episode.extras else ():
        if name in episode.extras:
            values = episode.extras[name]
            wrong = (values < 0.0) | (values > _WIDEST_M)
            _refuse(name, episode, wrong, f"an opening is from 0 to {_WIDEST_M:g} m", where)
    for name in _YES_OR_NO:
        if name in episode.extras:
            values = episode.extras[name]
            _refuse(name, episode, (values != 0.0) & (values != 1.0), "it must be 0 or 1", where)


def going_to(commanded: FloatArray, width_m: FloatArray, holding: BoolArray) -> FloatArray:
    """Where a gripper is going at each sample: a command counts until the next one.

    Until the first one, it stays where it is; where it holds something it goes on pressing, as if told to
    close. This is what `Context.gripper_target` is in a drive.

    Args:
        commanded: (T,), m; NaN where nothing new is commanded.
        width_m: (T,), as measured, m; not below zero.
        holding: (T,), whether something is held.

    Returns:
        (T,), m.
    """
    samples = np.arange(len(commanded))
    newest = np.maximum.accumulate(np.where(np.isnan(commanded), -1, samples))
    return np.where(newest < 0, np.where(holding, 0.0, width_m), commanded[newest])


def opening_source(extras: Mapping[str, FloatArray]) -> str:
    """The feature that tells a decoder the gripper's opening: the best of those that are there, or "".

    Where it was told to go is better than where it measures to be: that is one number for every thing that
    is held, wide or narrow, and the only one that toggles tell.
    """
    if GRIPPER_WIDTH in extras:
        told = extras.get(ACTION_GRIPPER)
        return GRIPPER_WIDTH if told is None or told.shape != extras[GRIPPER_WIDTH].shape else ACTION_GRIPPER
    return GRIPPER_TOGGLED if GRIPPER_TOGGLED in extras else ""


def told_by(demonstrations: Demonstrations, source: str) -> Demonstrations:
    """Demonstrations whose gripper is told by a feature, for a model that was trained when it was.

    Args:
        demonstrations: with all their features.
        source: what `opening_source` shall find; "" changes nothing.
    """
    if source != GRIPPER_WIDTH:
        return demonstrations
    episodes = (
        replace(one, extras={name: one.extras[name] for name in one.extras if name != ACTION_GRIPPER})
        for one in demonstrations.episodes
    )
    return replace(demonstrations, episodes=tuple(episodes))


def _refuse(name: str, episode: Episode, wrong: BoolArray, why: str, where: str) -> None:
    for sample, entry in np.argwhere(wrong)[:1]:
        value = episode.extras[name][sample, entry]
        raise UserError(f"{where}, sample {sample}: {name}[{entry}] is {value:g}; {why}.")
