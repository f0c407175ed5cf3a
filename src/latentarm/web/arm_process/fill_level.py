"""How full the cups and bowls of a pouring task are."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.robots.scene.scene import SceneState
from latentarm.robots.scene.thing import Interior
from latentarm.tasks.predicates import Poured
from latentarm.tasks.scene_task import Beginning
from latentarm.web.protocol.report import Fill

SETTLES_S: Final = 1.0  # poured grains settle within this time, s


@final
@dataclass(frozen=True)
class Vessel:
    """A vessel to pour from or into."""

    name: str
    room: Interior
    grains: str
    enough: float | None  # share of the grains that must be in it, in (0, 1]; None for the vessel poured from


def vessels(begun: Beginning) -> tuple[Vessel, ...]:
    """The vessels of a run, in the order of its steps."""
    found: dict[str, Vessel] = {}
    for step in begun.steps:
        poured = step.done
        if isinstance(poured, Poured):
            if step.holds is not None:
                room = begun.scene.thing(step.holds).room
                found[step.holds] = Vessel(step.holds, room, poured.grains, None)
            found[poured.container] = Vessel(poured.container, poured.interior, poured.grains, poured.share)
    return tuple(found.values())


@final
class FillLevels:
    """How full the vessels of a run are, and whether too little is left to pour."""

    def __init__(self, found: tuple[Vessel, ...]) -> None:
        self._vessels = found
        self._enough_s: float | None = None
        self.now: tuple[Fill, ...] = ()  # the newest levels
        self.short = False  # whether too little is left

    def see(self, state: SceneState, time_s: float) -> None:
        """Update from the scene at the clock's time, s."""
        self.now = tuple(
            Fill(
                thing=one.name,
                share=round(float(state.inside(one.grains, one.name, one.room).mean()), 3),
                enough=one.enough,
            )
            for one in self._vessels
        )
        left = sum(one.share for one in self.now if one.enough is None)
        wanted = sum(max(one.enough - one.share, 0.0) for one in self.now if one.enough is not None)
        if self._enough_s is None or left >= wanted:
            self._enough_s = time_s
        self.short = time_s - self._enough_s >= SETTLES_S
