"""A dataset's features of a gripper: their checks, their statistics, and widths from toggles."""

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

GRIPPER_HOLDING: Final = "observation.gripper_holding"  # whether something is held between them: 0 or 1
GRIPPER_TOGGLED: Final = "observation.gripper_toggled"
"""Whether the gripper is other than when the episode began: 0 or 1."""

GRIPPER_OPENING: Final = "observation.gripper_opening"
"""Share of the gripper's opening, from 0 (closed) to 1 (open)."""

GRIPPER: Final = "observation.gripper"  # as recorded, where its unit is unknown
ACTION_GRIPPER: Final = "action.gripper"
"""Target of the gripper, in the unit of its observation: m with `GRIPPER_WIDTH`."""

OBSERVED: Final = (GRIPPER_WIDTH, GRIPPER_HOLDING, GRIPPER_TOGGLED, GRIPPER_OPENING, GRIPPER)
"""States of a gripper, rather than commands."""

GripperStart = Literal["open", "closed"]  # state of a gripper when an episode begins
_WIDEST_M: Final = 1.0  # a larger width is not in m
_YES_OR_NO: Final = (GRIPPER_HOLDING, GRIPPER_TOGGLED)


@final
@dataclass(frozen=True)
class GripperUse:
    """A gripper's use in an episode; None where unknown."""

    changes: int  # number of openings and closings
    closed_fraction: float | None = None  # share of the time closed or closing
    # share of the time in another state than at the beginning, where only toggles are known
    toggled_fraction: float | None = None


def gripper_uses(demonstrations: Demonstrations, gripper: Gripper | None = None) -> tuple[GripperUse, ...]:
    """The use of the gripper in each episode; none where no feature of one gripper has a known unit.

    The gripper counts as closed where it holds something, or where its target (or, if not recorded, its
    opening) is at most half of its largest opening. Without ``gripper`` the largest opening is that of the
    demonstrations.
    """
    extras = [episode.extras for episode in demonstrations.episodes]
    known = (name for name in (GRIPPER_WIDTH, GRIPPER_OPENING, GRIPPER_TOGGLED) if name in extras[0])
    observed = next((name for name in known if extras[0][name].shape[1] == 1), None)
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
    """Check the values of an episode's features of a gripper: openings in m, yes or no."""
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
    """The target of a gripper at each sample, (T,), m: a command counts until the next one.

    Commands (T,), m, are NaN where there is no new one. Before the first command a gripper stays where it is,
    or keeps pressing if it holds something, as if commanded to close. A drive's `Context.gripper_target` is
    the same.
    """
    samples = np.arange(len(commanded))
    newest = np.maximum.accumulate(np.where(np.isnan(commanded), -1, samples))
    return np.where(newest < 0, np.where(holding, 0.0, width_m), commanded[newest])


def opening_source(extras: Mapping[str, FloatArray]) -> str:
    """The best feature for a decoder's gripper opening among those present, or "".

    The commanded opening is better than the measured one: it is one number for every held thing, wide or
    narrow, and the only one that toggles give.
    """
    if GRIPPER_WIDTH in extras:
        told = extras.get(ACTION_GRIPPER)
        return GRIPPER_WIDTH if told is None or told.shape != extras[GRIPPER_WIDTH].shape else ACTION_GRIPPER
    return GRIPPER_TOGGLED if GRIPPER_TOGGLED in extras else ""


def told_by(demonstrations: Demonstrations, source: str) -> Demonstrations:
    """Demonstrations for a model that was trained on a feature, see `opening_source`."""
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
