"""A scene about the arm: its beginning, and its state at a later moment."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, FloatArray, Pose
from latentarm.robots.kinematics.obstacles import HalfSpace
from latentarm.robots.scene.thing import Bond, Grains, Interior, Thing

TABLE: Final = "table"  # the table in `SceneState.force_n`
TOOL: Final = "tool"  # everything beyond the arm's last joint, in `SceneState.force_n`


@final
@dataclass(frozen=True, eq=False)
class Scene:
    """Things about the arm when a task begins.

    Raises UserError where two of its parts have one name, or a bond names a thing that is not there.
    """

    things: tuple[Thing, ...] = ()  # rigid things; later ones may stand on earlier ones
    grains: tuple[Grains, ...] = ()  # loose grains
    bonds: tuple[Bond, ...] = ()  # things that are one until a cut parts them
    table_m: float = 0.0  # height of the table top in the arm's base frame, m

    def __post_init__(self) -> None:
        names = [one.name for one in (*self.things, *self.grains)]
        doubled = sorted({name for name in names if names.count(name) > 1} | ({TABLE, TOOL} & set(names)))
        if doubled:
            raise UserError(f"A scene has several things named {doubled[0]!r}: give each its own name.")
        known = set(self.names)
        for bond in self.bonds:
            for name in (bond.first, bond.second):
                if name not in known:
                    raise UserError(f"A bond of the scene names {name!r}, and there is no such thing.")

    @property
    def table(self) -> HalfSpace:
        """The table top, for safety filters."""
        return HalfSpace(TABLE, np.array([0.0, 0.0, self.table_m]), np.array([0.0, 0.0, 1.0]))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the things, in order."""
        return tuple(thing.name for thing in self.things)

    def thing(self, name: str) -> Thing:
        """The thing of that name."""
        for thing in self.things:
            if thing.name == name:
                return thing
        raise UserError(f"The scene has no {name!r}; it has: {', '.join(self.names)}.")


@final
@dataclass(frozen=True, eq=False)
class SceneState:
    """State of a scene at one moment; truth, not a measurement."""

    time_s: float  # since the scene began, s
    tool: Pose  # pose of the arm's end-effector
    poses: Mapping[str, Pose]  # of every thing, by name
    speed_m_s: Mapping[str, float]  # of every thing's middle, by name, m/s
    stabbed: frozenset[str]  # names of things on the tines of the arm's fork
    gripped: frozenset[str]  # names of things that both fingers touch
    bonds: frozenset[tuple[str, str]]  # pairs of names that nothing has cut apart
    grains: Mapping[str, FloatArray]  # (K, 3), middles by the grains' name, m
    # Largest normal force between two of the tool (`TOOL`), the table (`TABLE`) and the things since the
    # state of an earlier moment, N; by pairs of names in alphabetical order, pairs without contact left out
    force_n: Mapping[tuple[str, str], float]

    def inside(self, grains: str, container: str, interior: Interior) -> BoolArray:
        """Whether each grain lies in a container, (K,)."""
        pose = self.poses[container]
        local = (self.grains[grains] - pose.position) @ pose.rotation
        in_height = (local[:, 2] >= interior.bottom_m) & (local[:, 2] <= interior.top_m)
        return in_height & (np.hypot(local[:, 0], local[:, 1]) <= interior.radius_m)
