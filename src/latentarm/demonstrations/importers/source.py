"""The raw contents of a file of demonstrations."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal, final

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


ActionKind = Literal["velocity", "position", "unknown"]


@final
@dataclass(frozen=True)
class SourceData:
    """Demonstrations in a file's own columns, order and units."""

    # columns of the states stand as joints, under the file's names or generated ones; ``robot`` is the file's
    # word for the robot, or ""
    demonstrations: Demonstrations
    layout: str  # kind of file, for people
    in_rad: bool  # whether the file, or its layout, says that positions are in rad
    actions: ActionKind = "velocity"  # kind of the file's actions, if it says so
    names: tuple[str, ...] = ()  # of the episodes; () if they are only numbered
    record: Mapping[str, str] = field(default_factory=dict)  # decisions of reading, by subject, in words

    @property
    def episode_names(self) -> tuple[str, ...]:
        """A name for each episode."""
        return self.names or tuple(map(str, range(len(self.demonstrations.episodes))))

    def without(self, names: Sequence[str], source: str) -> "SourceData":
        """All episodes but those of the given names."""
        known = self.episode_names
        for name in names:
            if name not in known:
                raise UserError(f"{source} has no episode {name!r}; it has {', '.join(known[:50])}.")
        kept = [index for index, name in enumerate(known) if name not in names]
        episodes = tuple(self.demonstrations.episodes[index] for index in kept)
        return replace(
            self,
            demonstrations=replace(self.demonstrations, episodes=episodes),
            names=tuple(known[index] for index in kept),
            record={**self.record, "episodes left out": ", ".join(names)},
        )


def join_files(files: Mapping[str, SourceData], source: str) -> SourceData:
    """Several files of one kind as one, with episodes named after the files."""
    first, *others = files.values()
    names = [
        name if len(one.demonstrations.episodes) == 1 else f"{name}/{episode}"
        for name, one in files.items()
        for episode in one.episode_names
    ]
    for name, other in files.items():
        if (other.layout, other.in_rad, other.actions) != (first.layout, first.in_rad, first.actions):
            raise UserError(f"{source} holds files of different kinds, such as {name}: import them apart.")
    return SourceData(
        join({f"{source}/{name}": one.demonstrations for name, one in files.items()}),
        f"{len(files)} files, {first.layout}",
        first.in_rad,
        first.actions,
        tuple(names),
        {subject: text for one in (first, *others) for subject, text in one.record.items()},
    )
