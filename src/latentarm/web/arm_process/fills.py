"""How much is in the cups and bowls of a task in which something is poured."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.robots.scene.scene import SceneState
from latentarm.robots.scene.thing import Interior
from latentarm.tasks.predicates import Poured
from latentarm.tasks.scene_task import Beginning
from latentarm.web.protocol.report import Fill

SETTLES_S: Final = 1.0
"""What is poured falls for no longer than this, s."""


@final
@dataclass(frozen=True)
class Vessel:
    """What something is poured from, or into.

    Attributes:
        name: of the container.
        room: in it.
        grains: name of what is poured.
        enough: share of the grains that must be in it, in (0, 1]; None for what is poured from.
    """

    name: str
    room: Interior
    grains: str
    enough: float | None


def vessels(begun: Beginning) -> tuple[Vessel, ...]:
    """What is poured from and into in a run, in the order of its steps.

    Args:
        begun: how the run begins.
    """
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
class Fills:
    """How full the vessels of a run are, and whether what is left is enough.

    Args:
        found: from `vessels`.
    """

    def __init__(self, found: tuple[Vessel, ...]) -> None:
        self._vessels = found
        self._enough_s: float | None = None
        self.now: tuple[Fill, ...] = ()
        self.short = False

    def see(self, state: SceneState, time_s: float) -> None:
        """Take how things stand.

        Args:
            state: of the scene.
            time_s: the clock, s.
        """
        self.now = tuple(_fill_of(vessel, state) for vessel in self._vessels)
        left = sum(one.share for one in self.now if one.enough is None)
        wanted = sum(max(one.enough - one.share, 0.0) for one in self.now if one.enough is not None)
        if self._enough_s is None or left >= wanted:
            self._enough_s = time_s
        self.short = time_s - self._enough_s >= SETTLES_S


def _fill_of(vessel: Vessel, state: SceneState) -> Fill:
    share = float(state.inside(vessel.grains, vessel.name, vessel.room).mean())
    return Fill(thing=vessel.name, share=round(share, 3), enough=vessel.enough)
