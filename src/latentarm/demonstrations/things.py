"""Poses of things in a dataset: the feature ``observation.environment_state`` and the names of its entries.

Each thing has seven entries in the base frame: position, m, and quaternion (w, x, y, z). The entries' names,
``cup.x`` to ``cup.qz``, are in ``meta/info.json`` and identify the things.
"""

from collections.abc import Sequence
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.types import Episode

ENVIRONMENT: Final = "observation.environment_state"
AGE: Final = "observation.environment_age."
"""Begins the name of a feature with an entry for each thing: how old its pose was, s, where it was that of
the source whose name follows, and else -1."""

ENTRIES: Final = ("x", "y", "z", "qw", "qx", "qy", "qz")


def entry_names(objects: Sequence[str]) -> tuple[str, ...]:
    """Names (7 K) of the feature's entries for K things."""
    return tuple(f"{name}.{entry}" for name in objects for entry in ENTRIES)


def object_names(entries: Sequence[str]) -> tuple[str, ...]:
    """The K things that the entries' names identify; empty if the entries are something else."""
    names = tuple(entry.rpartition(".")[0] for entry in entries[:: len(ENTRIES)])
    return names if entry_names(names) == tuple(entries) else ()


def check_things(objects: Sequence[str], episode: Episode, source: str) -> None:
    """Check the poses of named things in the first episode of a dataset."""
    if not all(objects) or len(set(objects)) != len(objects):
        raise UserError(f"{source}: the names of its things, {', '.join(objects)}, must be distinct.")
    poses = episode.extras.get(ENVIRONMENT)
    if poses is None or poses.shape[1:] != (len(ENTRIES) * len(objects),):
        width = 0 if poses is None else poses.shape[-1]
        raise UserError(
            f"{source}: {ENVIRONMENT} has {width} entries for {len(objects)} things, and must have"
            f" {len(ENTRIES)} for each: position and quaternion (w, x, y, z)."
        )
