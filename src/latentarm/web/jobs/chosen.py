"""The recordings that a person has chosen to train on, from one or several journals."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Final, final

from latentarm.recordings.journal_reader import JournalEpisode, read_journal
from latentarm.robots.limits_file import limits_document
from latentarm.web.protocol.notice import NoticeCode, NoticeError


@final
@dataclass(frozen=True)
class Chosen:
    """An episode of a journal."""

    journal: Path
    episode: int  # its number in the journal
    number: int  # by which people call it


def read_chosen(chosen: Sequence[Chosen]) -> dict[int, JournalEpisode]:
    """Episodes by number. Raises UserError where one is not there any more, or a journal cannot be read."""
    found: dict[int, JournalEpisode] = {}
    ordered = sorted(set(chosen), key=lambda one: (str(one.journal), one.episode))
    for journal, group in groupby(ordered, key=lambda one: one.journal):
        wanted = list(group)
        episodes = read_journal(journal, [one.episode for one in wanted])
        if len(episodes) != len(wanted):
            raise NoticeError("record_unknown")
        found |= {one.number: episode for one, episode in zip(wanted, episodes, strict=True)}
    return found


def check_alike(episodes: Mapping[int, JournalEpisode]) -> None:
    """Refuse recordings that no model can learn from together, and name two that differ."""
    (first, one), *others = sorted(episodes.items())
    for number, other in others:
        for code, facts in _ALIKE.items():
            if facts(one) != facts(other):
                raise NoticeError(code, number=number, other=first)
    named = {number: one.header.provenance.task_name for number, one in episodes.items()}
    names = {number: name for number, name in named.items() if name}
    (first, known), *_ = sorted(names.items()) or [(0, "")]
    for number, name in names.items():
        if name != known:
            raise NoticeError("recordings_of_tasks", number=number, other=first)


def _robot(one: JournalEpisode) -> object:
    header = one.header
    limits = None if header.limits is None else limits_document(header.limits)
    gripper = any(record.gripper is not None for record in one.records[:1])
    return header.robot, header.joint_names, header.end_effector, limits, gripper


def _things(one: JournalEpisode) -> object:
    """Goals and things by name: where they stood may differ."""
    header = one.header
    return [goal.name for goal in header.goals], header.objects, header.things


_ALIKE: Final[dict[NoticeCode, Callable[[JournalEpisode], object]]] = {
    "recordings_of_robots": _robot,
    "recordings_of_rates": lambda one: one.header.rate_hz,
    "recordings_of_tasks": _things,
}
