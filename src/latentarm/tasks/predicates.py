"""What can be true of things: the conditions that steps of tasks wait for, and those that end a run."""

from dataclasses import dataclass, field
from typing import final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.scene.interior import Interior
from latentarm.robots.scene.scene import TOOL, SceneState
from latentarm.tasks.mishap import Mishap


@final
@dataclass(frozen=True)
class Above:
    """The tool is over a thing.

    Attributes:
        thing: its name.
        aside_m: how far aside it may be, m.
        lowest_m: how far over the thing's middle it must be, at least, m.
        highest_m: at most, m.
    """

    thing: str
    aside_m: float
    lowest_m: float
    highest_m: float

    def __call__(self, state: SceneState) -> bool:
        """Whether it is."""
        away = state.tool.position - state.poses[self.thing].position
        near = np.hypot(away[0], away[1]) <= self.aside_m
        return bool(near and self.lowest_m <= away[2] <= self.highest_m)


@final
@dataclass(frozen=True)
class Taken:
    """A thing is between the fingers or on the tines.

    Attributes:
        thing: its name.
    """

    thing: str

    def __call__(self, state: SceneState) -> bool:
        """Whether it is."""
        return self.thing in state.stabbed | state.gripped


@final
@dataclass(frozen=True)
class Stabbed:
    """A thing is on the tines, and has left what it lay on.

    Attributes:
        thing: its name.
        above_m: height of its middle in the base frame that it must have, m.
    """

    thing: str
    above_m: float

    def __call__(self, state: SceneState) -> bool:
        """Whether it is."""
        return self.thing in state.stabbed and state.poses[self.thing].position[2] >= self.above_m


@final
@dataclass(frozen=True)
class CarriedOver:
    """A thing that the arm holds is over another one.

    Attributes:
        thing: its name.
        over: the other's name.
        aside_m: how far aside it may be, m.
    """

    thing: str
    over: str
    aside_m: float

    def __call__(self, state: SceneState) -> bool:
        """Whether it is."""
        away = state.poses[self.thing].position - state.poses[self.over].position
        return bool(Taken(self.thing)(state) and np.hypot(away[0], away[1]) <= self.aside_m)


@final
@dataclass(frozen=True)
class Holding:
    """A thing is between the fingers, and has left what it stood on.

    Attributes:
        thing: its name.
        above_m: height of its frame in the base frame of the arm that it must have, m.
    """

    thing: str
    above_m: float

    def __call__(self, state: SceneState) -> bool:
        """Whether it is."""
        return self.thing in state.gripped and state.poses[self.thing].position[2] >= self.above_m


@final
@dataclass(frozen=True)
class Poured:
    """A share of the grains is in a container.

    Attributes:
        grains: their name.
        container: its name.
        interior: the room in it.
        share: of the grains, in (0, 1].
    """

    grains: str
    container: str
    interior: Interior
    share: float

    def __call__(self, state: SceneState) -> bool:
        """Whether it is."""
        inside = state.inside(self.grains, self.container, self.interior)
        return bool(inside.mean() >= self.share)


@final
@dataclass(frozen=True)
class Apart:
    """Two things that were one have been cut apart.

    Attributes:
        first: name of one.
        second: name of the other.
    """

    first: str
    second: str

    def __call__(self, state: SceneState) -> bool:
        """Whether they have."""
        return (self.first, self.second) not in state.bonds


@final
@dataclass(frozen=True)
class Within:
    """A thing's middle is inside a container.

    Attributes:
        thing: its name.
        container: its name.
        interior: the room in it.
    """

    thing: str
    container: str
    interior: Interior

    def __call__(self, state: SceneState) -> bool:
        """Whether it is."""
        pose = state.poses[self.container]
        x, y, z = (state.poses[self.thing].position - pose.position) @ pose.rotation
        inside = np.hypot(x, y) <= self.interior.radius_m
        return bool(inside and self.interior.bottom_m <= z <= self.interior.top_m)


@final
@dataclass(frozen=True, eq=False)
class Placed:
    """A thing rests in a region.

    Attributes:
        thing: its name.
        centre: (3,), where its frame is to be, in the base frame of the arm, m.
        within_m: (3,), how far from there it may be along each axis, m.
        let_go: whether nothing may hold it any more; food may stay on the fork where it lies on a plate.
        still_m_s: slower than this it rests, m/s.
    """

    thing: str
    centre: FloatArray
    within_m: FloatArray
    let_go: bool
    still_m_s: float = 0.02

    def __call__(self, state: SceneState) -> bool:
        """Whether it does."""
        away = np.abs(state.poses[self.thing].position - self.centre)
        held = self.let_go and self.thing in state.gripped | state.stabbed
        still = state.speed_m_s[self.thing] <= self.still_m_s
        return bool(still and not held and (away <= self.within_m).all())


@final
@dataclass(eq=False)
class Swept:
    """A thing has been drawn through a container, as through icing.

    It remembers: made anew for every run.

    Attributes:
        thing: its name.
        container: its name.
        interior: the room in it.
        length_m: how far it must have come inside, m.
    """

    thing: str
    container: str
    interior: Interior
    length_m: float
    _swept_m: float = field(default=0.0, init=False)
    _last: FloatArray | None = field(default=None, init=False)

    def __call__(self, state: SceneState) -> bool:
        """Whether it has, counting what it has seen so far."""
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
    """A thing has been led to and fro about the middle of a container.

    It remembers: made anew for every run.

    Attributes:
        thing: its name.
        container: its name.
        interior: the room in it; the thing's frame must be below its rim.
        turns: how far it must go about the middle, to and fro counted alike, in whole turns.
    """

    thing: str
    container: str
    interior: Interior
    turns: float
    _swept_rad: float = field(default=0.0, init=False)
    _last_rad: float | None = field(default=None, init=False)

    def __call__(self, state: SceneState) -> bool:
        """Whether it has, counting what it has seen so far."""
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
    """A thing has fallen below a height.

    Attributes:
        thing: its name.
        below_m: height in the base frame of the arm, m.
    """

    thing: str
    below_m: float

    def __call__(self, state: SceneState) -> Mishap | None:
        """That it has."""
        fell = state.poses[self.thing].position[2] < self.below_m
        return Mishap("dropped", self.thing) if fell else None


@final
@dataclass(frozen=True)
class KnockedOver:
    """A thing lies on its side, and nobody holds it.

    Attributes:
        thing: its name.
        angle_rad: how far it may lean, rad.
    """

    thing: str
    angle_rad: float = float(np.deg2rad(60.0))

    def __call__(self, state: SceneState) -> Mishap | None:
        """That it does."""
        up = state.poses[self.thing].rotation[2, 2]
        fallen = up < np.cos(self.angle_rad) and self.thing not in state.gripped
        return Mishap("knocked_over", self.thing) if fallen else None


@final
@dataclass(frozen=True)
class Spilled:
    """Too many grains are neither in one of some containers nor in the air above them.

    Attributes:
        grains: their name.
        below_m: below this height in the base frame of the arm, outside of the containers, they are spilled.
        containers: names, and the room in each.
        share: of the grains that may be spilled.
    """

    grains: str
    below_m: float
    containers: tuple[tuple[str, Interior], ...]
    share: float

    def __call__(self, state: SceneState) -> Mishap | None:
        """That they are."""
        most = self.share * len(state.grains[self.grains])
        return Mishap("spilled", self.grains) if self.count(state) > most else None

    def count(self, state: SceneState) -> int:
        """How many grains are spilled."""
        spilled = state.grains[self.grains][:, 2] < self.below_m
        for name, interior in self.containers:
            spilled &= ~state.inside(self.grains, name, interior)
        return int(spilled.sum())


@final
@dataclass(frozen=True)
class Pressed:
    """The tool presses harder on something than it may.

    Attributes:
        thing: its name, or `latentarm.robots.scene.scene.TABLE`.
        most_n: N.
    """

    thing: str
    most_n: float

    def __call__(self, state: SceneState) -> Mishap | None:
        """That it does."""
        first, second = sorted((self.thing, TOOL))
        pressed = state.force_n.get((first, second), 0.0) > self.most_n
        return Mishap("pressed", self.thing) if pressed else None
