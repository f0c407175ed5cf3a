"""Joins separate demonstrations of one robot."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations
from latentarm.demonstrations.info import goals_document

_SAME: Final = {
    "robot": "the robot",
    "joint_names": "the joints",
    "end_effector": "the end-effector",
    "limits": "the stated limits",
    "objects": "the things",
}


def join(parts: Mapping[str, Demonstrations]) -> Demonstrations:
    """The episodes of all parts in order, with the first part's rate and the record of each import."""
    (where, first), *others = parts.items()
    for name, other in others:
        differing = [word for field, word in _SAME.items() if getattr(other, field) != getattr(first, field)]
        if goals_document(other.goals) != goals_document(first.goals):
            differing.append("the goals")
        if differing:
            raise UserError(f"{name} and {where} differ in {differing[0]}: they cannot be one dataset.")
    record: dict[str, list[str]] = {}
    for part in parts.values():
        for subject, decision in part.import_record.items():
            record.setdefault(subject, []).append(decision)
    return replace(
        first,
        episodes=tuple(episode for part in parts.values() for episode in part.episodes),
        import_record={subject: "; ".join(dict.fromkeys(said)) for subject, said in record.items()},
    )
