"""Predicates of things: conditions for the steps of tasks, and failures that end a run.

Called with the present state, a condition says whether it holds, and a failure what has happened, if it has.
"""

from dataclasses import dataclass, field
from typing import final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.scene.scene import TOOL, SceneState
from latentarm.robots.scene.thing import Interior
from latentarm.tasks.mishap import Mishap


@final
@dataclass(frozen=True)
class Above:
    """The tool is over a thing."""

    thing: str
    aside_m: float  # largest horizontal distance, m
    lowest_m: float  # least height over the thing's middle, m
    highest_m: float  # largest, m

    def __call__(self, state: SceneState) -> bool:
        away = state.tool.position - state.poses[self.thing].position
        near = np.hypot(away[0], away[1]) <= self.aside_m
        return bool(near and self.lowest_m <= away[2] <= self.highest_m)


@final
@dataclass(frozen=True)
class Taken:
    """A thing is between the fingers or on the tines."""

    thing: str

    def __call__(self, state: SceneState) -> bool:
        return self.thing in state.stabbed | state.gripped


@final
@dataclass(frozen=True)
class Lifted:
    """A thing is between the fingers or on the tines, and has left its place."""

    thing: str
    above_m: float  # least height of its frame in the base frame, m

    def __call__(self, state: SceneState) -> bool:
        return Taken(self.thing)(state) and state.poses[self.thing].position[2] >= self.above_m


@final
@dataclass(frozen=True)
class CarriedOver:
    """A thing that the arm holds is over another one."""

    thing: str
    over: str
    aside_m: float  # largest horizontal distance, m

    def __call__(self, state: SceneState) -> bool:
        away = state.poses[self.thing].position - state.poses[self.over].position
        return bool(Taken(self.thing)(state) and np.hypot(away[0], away[1]) <= self.aside_m)


@final
@dataclass(frozen=True)
class Poured:
    """A share of the grains is in a container."""

    grains: str
    container: str
    interior: Interior  # of the container
    share: float  # of the grains, in (0, 1]

    def __call__(self, state: SceneState) -> bool:
        inside = state.inside(self.grains, self.container, self.interior)
        return bool(inside.mean() >= self.share)


@final
@dataclass(frozen=True)
class Apart:
    """Two things that were one have been cut apart."""

    first: str
    second: str

    def __call__(self, state: SceneState) -> bool:
        return (self.first, self.second) not in state.bonds


@final
@dataclass(frozen=True)
class Within:
    """A thing's middle is inside a container."""

    thing: str
    container: str
    interior: Interior

    def __call__(self, state: SceneState) -> bool:
        pose = state.poses[self.container]
        x, y, z = (state.poses[self.thing].position - pose.position) @ pose.rotation
        inside = np.hypot(x, y) <= self.interior.radius_m
        return bool(inside and self.interior.bottom_m <= z <= self.interior.top_m)


@final
@dataclass(frozen=True, eq=False)
class Placed:
    """A thing rests in a region."""

    thing: str
    centre: FloatArray  # (3,), target of its frame in the base frame, m
    within_m: FloatArray  # (3,), tolerance along each axis, m
    let_go: bool  # whether nothing may hold it any more; food may stay on the fork
    still_m_s: float = 0.02  # slower than this it rests

    def __call__(self, state: SceneState) -> bool:
        away = np.abs(state.poses[self.thing].position - self.centre)
        held = self.let_go and self.thing in state.gripped | state.stabbed
        still = state.speed_m_s[self.thing] <= self.still_m_s
        return bool(still and not held and (away <= self.within_m).all())


@final
@dataclass(eq=False)
class Swept:
    """A thing has been drawn through a container, as through icing. It has memory: make one for each run."""

    thing: str
    container: str
    interior: Interior  # of the container
    length_m: float  # way inside, m
    _swept_m: float = field(default=0.0, init=False)
    _last: FloatArray | None = field(default=None, init=False)

    def __call__(self, state: SceneState) -> bool:
        place = state.poses[self.thing].position
        if Within(self.thing, self.container, self.interior)(state):
            if self._last is not None:
                self._swept_m += float(np.linalg.norm((place - self._last)[:2]))
            self._last = place
        else:
            self._last = None
        return self._swept_m >= self.length_m


@final
@dataclass(eq=False)
class Stirred:
    """A thing has gone to and fro about the middle of a container. It has memory: make one for each run."""

    thing: str
    container: str
    interior: Interior  # of the container; the thing's frame must be below its rim
    turns: float  # way about the middle in whole turns, both directions counted alike
    _swept_rad: float = field(default=0.0, init=False)
    _last_rad: float | None = field(default=None, init=False)

    def __call__(self, state: SceneState) -> bool:
        pose = state.poses[self.container]
        x, y, z = (state.poses[self.thing].position - pose.position) @ pose.rotation
        if not (np.hypot(x, y) <= self.interior.radius_m and z <= self.interior.top_m):
            self._last_rad = None
            return self._enough
        angle_rad = float(np.arctan2(y, x))
        if self._last_rad is not None:
            self._swept_rad += abs(float(np.angle(np.exp(1j * (angle_rad - self._last_rad)))))
        self._last_rad = angle_rad
        return self._enough

    @property
    def _enough(self) -> bool:
        return self._swept_rad >= 2.0 * np.pi * self.turns


@final
@dataclass(frozen=True)
class Dropped:
    """A thing has fallen below a height."""

    thing: str
    below_m: float  # in the base frame, m

    def __call__(self, state: SceneState) -> Mishap | None:
        fell = state.poses[self.thing].position[2] < self.below_m
        return Mishap("dropped", self.thing) if fell else None


@final
@dataclass(frozen=True)
class KnockedOver:
    """A thing lies on its side, and nobody holds it."""

    thing: str
    angle_rad: float = float(np.deg2rad(60.0))  # largest lean

    def __call__(self, state: SceneState) -> Mishap | None:
        up = state.poses[self.thing].rotation[2, 2]
        fallen = up < np.cos(self.angle_rad) and self.thing not in state.gripped
        return Mishap("knocked_over", self.thing) if fallen else None


@final
@dataclass(frozen=True)
class Spilled:
    """Too many grains are neither in given containers nor in the air above them."""

    grains: str
    below_m: float  # outside of the containers, grains below this height in the base frame are spilled, m
    containers: tuple[tuple[str, Interior], ...]  # names and interiors
    share: float  # of the grains that may be spilled

    def __call__(self, state: SceneState) -> Mishap | None:
        most = self.share * len(state.grains[self.grains])
        return Mishap("spilled", self.grains) if self.count(state) > most else None

    def count(self, state: SceneState) -> int:
        """The number of spilled grains."""
        spilled = state.grains[self.grains][:, 2] < self.below_m
        for name, interior in self.containers:
            spilled &= ~state.inside(self.grains, name, interior)
        return int(spilled.sum())


@final
@dataclass(frozen=True)
class Pressed:
    """The tool presses on something with more than ``most_n``."""

    thing: str  # a name, or `latentarm.robots.scene.scene.TABLE`
    most_n: float

    def __call__(self, state: SceneState) -> Mishap | None:
        first, second = sorted((self.thing, TOOL))
        pressed = state.force_n.get((first, second), 0.0) > self.most_n
        return Mishap("pressed", self.thing) if pressed else None
