"""Validation of demonstrations, with a one-sentence error for each fault.

Episodes and samples count from zero, as in the dataset's ``episode_index`` and ``frame_index``.
"""

from collections.abc import Iterator, Sequence
from dataclasses import astuple
from typing import Final

import numpy as np
from numpy.typing import NDArray

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray, Goal
from latentarm.demonstrations.gripper import check_gripper
from latentarm.demonstrations.things import check_things
from latentarm.robots.limits import JointLimits

LIMIT_TOLERANCE_RAD: Final = 0.01  # of a state past a limit: encoder offsets and compliance, 0.6 degrees
CLIP_HINT_RAD: Final = 0.2  # calibrations of one kind of arm differ by less
RESERVED_FEATURES: Final = frozenset(
    {"action", "episode_index", "frame_index", "index", "observation.state", "task_index", "timestamp"}
)


def validate(
    demonstrations: Demonstrations,
    source: str,
    limits: JointLimits | None = None,
    episode_names: Sequence[str] = (),
) -> None:
    """Check all that the package relies on; states may pass the limits by `LIMIT_TOLERANCE_RAD`."""
    names = demonstrations.joint_names
    if not names or not all(names) or len(set(names)) != len(names) or not all(map(_is_text, names)):
        raise UserError(f"{source}: the joint names {names} must be distinct, not empty and at least one.")
    if limits is not None and limits.lower.size != demonstrations.dof:
        raise UserError(
            f"{source}: the states have {demonstrations.dof} joints, but the robot has {limits.lower.size}; "
            "choose the robot that was recorded."
        )
    if not _is_text(demonstrations.robot):
        raise UserError(
            f"{source}: the robot's name {demonstrations.robot!a} is not text that a file can hold."
        )
    if not demonstrations.episodes:
        raise UserError(f"{source}: there are no episodes in it.")
    for index, goal in enumerate(demonstrations.goals):
        check_goal(goal, index, demonstrations.dof, source)
    first = demonstrations.episodes[0]
    if demonstrations.objects:
        check_things(demonstrations.objects, first, source)
    for index, episode in enumerate(demonstrations.episodes):
        called = episode_names[index] if episode_names else index
        validate_episode(episode, called, names, source, limits)
        check_same_features(first, episode, called, source)
    rate = demonstrations.rate_hz
    if not (np.isfinite(rate) and rate > 0):
        raise UserError(f"{source}: the sampling rate is {rate:g} Hz; it must be a finite number above zero.")


def validate_episode(
    episode: Episode,
    index: int | str,
    joint_names: tuple[str, ...],
    source: str,
    limits: JointLimits | None = None,
) -> None:
    """Check one episode; ``index`` and ``source`` are for messages."""
    where = f"{source}: episode {index}"
    _check_shapes(episode, len(joint_names), where)
    for name, values in _features(episode):
        _check_finite(name, values, where)
    check_gripper(episode, where)
    _check_times(episode.timestamp, where)
    if not _is_text(episode.task):
        raise UserError(f"{where}: its task {episode.task!a} is not text that a file can hold.")
    if episode.provenance is not None and not all(map(_is_text, map(str, astuple(episode.provenance)))):
        raise UserError(f"{where}: what is said of who recorded it is not text that a file can hold.")
    if limits is not None:
        _check_limits(episode.state, joint_names, limits, where)


def check_same_features(first: Episode, other: Episode, index: int | str, source: str) -> None:
    """Check that two episodes have the same features, as one dataset requires."""
    widths = {name: values.shape[1:] for name, values in _features(first)}
    others = {name: values.shape[1:] for name, values in _features(other)}
    for name in sorted(widths.keys() | others.keys()):
        if name not in others:
            raise UserError(f"{source}: episode {index} has no {name}, though the first episode has it.")
        if name not in widths:
            raise UserError(f"{source}: episode {index} has {name}, though the first episode has none.")
        if widths[name] != others[name]:
            raise UserError(
                f"{source}: episode {index} has a {name} of width {others[name][0]}, "
                f"though the first episode's is {widths[name][0]} wide."
            )


def _features(episode: Episode) -> Iterator[tuple[str, FloatArray]]:
    yield "observation.state", episode.state
    yield "timestamp", episode.timestamp
    if episode.action is not None:
        yield "action", episode.action
    yield from episode.extras.items()


def _is_text(text: str) -> bool:
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True


def _check_shapes(episode: Episode, dof: int, where: str) -> None:
    if episode.state.ndim != 2:
        raise UserError(f"{where}: its states have the shape {episode.state.shape}, not (samples, joints).")
    samples, width = episode.state.shape
    if samples == 0:
        raise UserError(f"{where} is empty.")
    if samples == 1:
        raise UserError(
            f"{where} has a single sample; a motion needs at least two: import the rest with --leave-out."
        )
    if width != dof:
        raise UserError(f"{where}: its states have {width} joints where {dof} are expected.")
    if episode.timestamp.shape != (samples,):
        raise UserError(
            f"{where} is ragged: {samples} states but timestamps of shape {episode.timestamp.shape}."
        )
    if episode.action is not None and episode.action.shape != (samples, dof):
        raise UserError(
            f"{where} is ragged: {samples} states of {dof} joints "
            f"but actions of shape {episode.action.shape}."
        )
    for name, values in episode.extras.items():
        if not name or "/" in name or name in RESERVED_FEATURES or not _is_text(name):
            raise UserError(f"{where}: {name!r} cannot be the name of a feature.")
        if values.ndim != 2 or values.shape[0] != samples or values.shape[1] == 0:
            raise UserError(f"{where} is ragged: {samples} states but {name} of shape {values.shape}.")


def _check_finite(name: str, values: FloatArray, where: str) -> None:
    representable: NDArray[np.bool_] = np.abs(values) <= np.finfo(np.float32).max
    if representable.all():
        return
    place = np.argwhere(~representable)[0]
    value = values[tuple(place)]
    fault = "not a number" if np.isnan(value) else "infinite" if np.isinf(value) else "absurdly large"
    entry = f"[{place[1]}]" if len(place) > 1 else ""
    raise UserError(f"{where}, sample {place[0]}: {name}{entry} is {fault} ({value:g}).")


def _check_times(timestamp: FloatArray, where: str) -> None:
    steps = np.diff(timestamp)
    for sample in np.flatnonzero(steps <= 0)[:1] + 1:
        before, now = timestamp[sample - 1], timestamp[sample]
        if now == before:
            raise UserError(f"{where}, sample {sample}: the timestamp {now:g} s repeats; times must grow.")
        raise UserError(
            f"{where}, sample {sample}: the timestamp falls from {before:g} s to {now:g} s; times must grow."
        )
    for sample in np.flatnonzero(np.diff(timestamp.astype(np.float32)) <= 0)[:1] + 1:
        raise UserError(
            f"{where}, sample {sample}: the timestamp {timestamp[sample]:.9g} s cannot be told from the one "
            "before it in single precision; count times from the episode's start."
        )


def _check_limits(state: FloatArray, joint_names: tuple[str, ...], limits: JointLimits, where: str) -> None:
    above = state - limits.upper
    below = limits.lower - state
    excess = np.maximum(above, below)
    hint = ""
    if excess.max() < CLIP_HINT_RAD:
        most = np.ceil(100.0 * excess.max()) / 100.0
        hint = f", or pass --clip-rad {most:g} to move such samples to the limit"
    for sample, joint in np.argwhere(excess > LIMIT_TOLERANCE_RAD)[:1]:
        side, bound = (
            ("above its upper", limits.upper[joint])
            if above[sample, joint] > below[sample, joint]
            else ("below its lower", limits.lower[joint])
        )
        raise UserError(
            f"{where}, sample {sample}: joint {joint_names[joint]} is at {state[sample, joint]:.4f} rad, "
            f"{side} limit of {bound:.4f} rad; check the robot, the units and the order of the joints{hint}."
        )


def check_goal(goal: Goal, index: int, dof: int, source: str) -> None:
    """Check one goal for n = ``dof`` joints."""
    shapes = (goal.configuration.shape, goal.pose.position.shape, goal.pose.rotation.shape)
    if shapes != ((dof,), (3,), (3, 3)):
        raise UserError(f"{source}: goal {index} must be a configuration of {dof} joints with its pose.")
    values = np.concatenate([goal.configuration, goal.pose.position, goal.pose.rotation.ravel()])
    if not (np.isfinite(values).all() and _is_text(goal.name)):
        raise UserError(f"{source}: goal {index} ({goal.name!a}) holds a value that is not a finite number.")
