"""Export of a journal to the native dataset."""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, FloatArray, StepRecord
from latentarm.demonstrations.gripper import ACTION_GRIPPER, GRIPPER_HOLDING, GRIPPER_WIDTH, going_to
from latentarm.demonstrations.provenance import BY_HAND
from latentarm.demonstrations.things import AGE, ENVIRONMENT
from latentarm.recordings.journal_reader import JournalEpisode
from latentarm.recordings.journal_writer import EpisodeHeader
from latentarm.recordings.recorded_states import first_implausible
from latentarm.robots.kinematics.pose_rows import stored_rows
from latentarm.robots.limits import JointLimits

NO_BOUND = -1.0
"""Stands for "no bound" in a dataset, whose numbers are all finite: a radius is never negative."""

_SHORTEST = 2  # an episode with fewer samples has no motion in it


@final
class ImplausibleWarning(UserWarning):
    """Some samples of an episode are impossible and were not exported; ``kept_s`` is the exported part, s."""

    def __init__(self, message: str, task: str, kept_s: float) -> None:
        super().__init__(message)
        self.task = task
        self.kept_s = kept_s


def demonstrations_of(
    episodes: Sequence[JournalEpisode], *, source: str, incomplete: bool = False
) -> Demonstrations:
    """Episodes of `read_journal` as a dataset, with every decision of a step as further features.

    The command is the action; where the arm was guided by hand, it is the velocity of the joints. Further
    features: ``input.u``, ``latent.z``, ``action.human``, ``action.assist``, ``assist.alpha``, ``mode``,
    where there are goals ``belief`` and ``assist.bound`` (rad; -1 where nothing helps or no bound is known),
    and ``assist.added`` where help was ever added to the person's action (see `StepRecord.added`).
    ``observation.environment_state`` has the poses of the things that matter or, where no things were
    recorded, of the goals; these are the dataset's objects. ``observation.environment_age.SOURCE`` has for
    each thing how old its pose was, s, in the samples in which it was that source's, and else -1. An arm
    with a gripper adds ``observation.gripper_width`` (m; a reading below zero counts as zero),
    ``observation.gripper_holding`` (0 or 1) and ``action.gripper`` (m): the width commanded last, or until a
    command the measured one (0 where it holds something). Time starts at each episode's first sample.
    Incomplete episodes are skipped unless asked for. An episode is cut before its first impossible sample
    (see `first_implausible`), or skipped where too little of it remains, with an `ImplausibleWarning`. Errors
    name the ``source``.

    Raises UserError where no episode is complete and long enough, or the episodes are of different robots,
    goals or things, or of an arm with a gripper and one without.
    """
    usable = [_until_implausible(episode) for episode in episodes if incomplete or episode.complete]
    kept = [episode for episode in usable if len(episode.records) >= _SHORTEST]
    if not kept:
        raise UserError(f"{source} holds no complete episode: end an episode while recording it.")
    first = kept[0].header
    names = [goal.name for goal in first.goals]
    objects = _objects(first)
    for episode in kept:
        header = episode.header
        differ = header.joint_names != first.joint_names or [goal.name for goal in header.goals] != names
        if differ or _objects(header) != objects:
            raise UserError(
                f"{source} holds episodes of different robots, goals or things: export them apart, with"
                " --episodes."
            )
        if _has_gripper(episode) != _has_gripper(kept[0]):
            raise UserError(
                f"{source} holds episodes with a gripper and without: export them apart, with --episodes."
            )
    sources = tuple(dict.fromkeys(source for one in kept for source in one.header.sources))
    return Demonstrations(
        episodes=_with_added(kept, tuple(_episode(episode, sources) for episode in kept)),
        rate_hz=first.rate_hz,
        joint_names=first.joint_names,
        robot=first.robot,
        goals=first.goals,
        end_effector=first.end_effector,
        limits=first.limits,
        objects=objects,
    )


def _with_added(kept: Sequence[JournalEpisode], episodes: tuple[Episode, ...]) -> tuple[Episode, ...]:
    """The episodes with how much help was added, if any was in any of them."""
    added = [np.array([[record.added] for record in one.records]) for one in kept]
    if not any(one.any() for one in added):
        return episodes
    return tuple(
        replace(episode, extras={**episode.extras, "assist.added": one})
        for episode, one in zip(episodes, added, strict=True)
    )


def _until_implausible(recorded: JournalEpisode) -> JournalEpisode:
    """The episode up to its first sample that cannot be true."""
    header, records = recorded.header, recorded.records
    found = first_implausible(records, header.joint_names, _limits(header))
    if found is None:
        return recorded
    index, reason = found
    whole = index < _SHORTEST
    left_out = "the episode is" if whole else "it and what comes after it are"
    said = (
        f"Sample {index + 1} of {len(records)} in the episode {header.task!r} cannot be true ({reason}):"
        f" {left_out} left out."
    )
    kept_s = 0.0 if whole else records[index - 1].time_s - records[0].time_s
    warnings.warn(ImplausibleWarning(said, header.task, kept_s), stacklevel=3)
    return replace(recorded, records=records[:index])


def _limits(header: EpisodeHeader) -> JointLimits | None:
    """Limits of the joints. Older journals do not store them but name the robot."""
    if header.joint_limits is not None:
        return header.joint_limits
    # MuJoCo is slow to load, and current journals do not need it here.
    from latentarm.robots.catalogue import ROBOTS

    if header.robot not in ROBOTS:
        return None
    limits = ROBOTS[header.robot]().limits
    return limits if limits.dof == len(header.joint_names) else None


def _has_gripper(episode: JournalEpisode) -> bool:
    """Whether its samples, which agree in this, have a gripper."""
    return episode.records[0].gripper is not None


def _gripper(records: Sequence[StepRecord]) -> dict[str, FloatArray]:
    """Features of the gripper; none without one."""
    measured = [one.gripper for one in records if one.gripper is not None]
    if not measured:
        return {}
    width_m = np.array([max(one.width_m, 0.0) for one in measured])
    holding = np.array([one.holding for one in measured])
    commands = [one.command.gripper for one in records]
    commanded = np.array([np.nan if one is None else one.width_m for one in commands])
    return {
        GRIPPER_WIDTH: width_m[:, None],
        GRIPPER_HOLDING: holding[:, None].astype(np.float64),
        ACTION_GRIPPER: going_to(commanded, width_m, holding)[:, None],
    }


def _objects(header: EpisodeHeader) -> tuple[str, ...]:
    """The things whose poses go into the dataset: those that matter; where none were seen, the goals."""
    return header.objects or header.things or tuple(goal.name for goal in header.goals)


def _poses(recorded: JournalEpisode, objects: Sequence[str]) -> FloatArray:
    """Where they are at each sample, (T, 7 K)."""
    header, records = recorded.header, recorded.records
    if not header.things:
        goals = [stored_rows(goal.pose) for goal in header.goals]
        return np.tile(np.concatenate(goals), (len(records), 1))
    chosen = [header.things.index(name) for name in objects]
    return np.stack([record.things[chosen].ravel() for record in records])


def _action(recorded: JournalEpisode) -> FloatArray:
    """The joint velocities that moved the arm, (T, n), rad/s: its commands, or a person's hand."""
    records = recorded.records
    if recorded.header.provenance.controller != BY_HAND:
        return np.stack([record.command.velocity for record in records])
    time_s = np.array([record.time_s for record in records])
    return np.gradient(np.stack([record.state for record in records]), time_s, axis=0)


def _ages(recorded: JournalEpisode, objects: Sequence[str], source: str) -> FloatArray:
    """Age of each pose from this source at each sample, (T, K), s; -1 where it is from another source."""
    header, records = recorded.header, recorded.records
    if source not in header.sources:
        return np.full((len(records), len(objects)), -1.0)
    chosen = [header.things.index(name) for name in objects]
    by, age_s = np.moveaxis(np.stack([record.sightings[chosen] for record in records]), -1, 0)
    return np.where(by == header.sources.index(source), age_s, -1.0)


def _episode(recorded: JournalEpisode, sources: Sequence[str]) -> Episode:
    records, goals = recorded.records, recorded.header.goals
    time_s = np.array([record.time_s for record in records])
    extras: dict[str, FloatArray] = {
        "input.u": np.stack([record.input for record in records]),
        "latent.z": np.stack([record.latent for record in records]),
        "action.human": np.stack([record.action_human for record in records]),
        "action.assist": np.stack([record.action_assist for record in records]),
        "assist.alpha": np.array([[record.alpha] for record in records]),
        "mode": np.array([[float(record.mode)] for record in records]),
    }
    if goals:
        extras["belief"] = np.stack([record.belief for record in records])
        bound = np.array([[record.bound_rad] for record in records])
        extras["assist.bound"] = np.where(np.isnan(bound), NO_BOUND, bound)
    if objects := _objects(recorded.header):
        extras[ENVIRONMENT] = _poses(recorded, objects)
        extras |= {AGE + source: _ages(recorded, objects, source) for source in sources}
    extras |= _gripper(records)
    return Episode(
        state=np.stack([record.state for record in records]),
        timestamp=time_s - time_s[0],
        action=_action(recorded),
        task=recorded.header.task,
        extras=extras,
        provenance=replace(recorded.header.provenance, complete=recorded.complete),
    )
