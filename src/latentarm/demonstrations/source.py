"""The raw contents of a file of demonstrations."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, final

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations
from latentarm.demonstrations.joining import join

ActionKind = Literal["velocity", "position", "unknown"]


@final
@dataclass(frozen=True)
class SourceData:
    """Demonstrations as a file has them: all its columns, in its order and its units.

    Attributes:
        demonstrations: the states' columns stand as joints, under the file's names or made-up ones;
            ``robot`` is what the file calls the robot, or "".
        layout: the kind of file, for people.
        in_rad: whether the file, or its layout, says that positions are in rad.
        actions: what the file's actions are, as far as it says so.
        names: of the episodes; () where they are merely numbered.
        record: what reading decided, by subject, in words.
    """

    demonstrations: Demonstrations
    layout: str
    in_rad: bool
    actions: ActionKind = "velocity"
    names: tuple[str, ...] = ()
    record: Mapping[str, str] = field(default_factory=dict)

    @property
    def episode_names(self) -> tuple[str, ...]:
        """A name for each episode."""
        return self.names or tuple(map(str, range(len(self.demonstrations.episodes))))

    def without(self, names: Sequence[str], source: str) -> "SourceData":
        """All episodes but those of some names."""
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
    """Several files of one kind as one, their episodes named after them.

    Args:
        files: what each holds, by its name.
        source: the folder, for messages.
    """
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
