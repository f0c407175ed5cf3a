"""What a step needs to be held: where it is lost, the step that takes it is to be done again."""

from typing import Final, final

import numpy as np

from latentarm.scene.scene import SceneState
from latentarm.tasks.steps import TaskStep
from latentarm.types import FloatArray
from latentarm.web.protocol.report import Lost

LOST_S: Final = 1.0
"""A thing is lost once it has been away for so long, s: what is put down takes a moment to come to rest."""

LOST_M: Final = 0.03
"""So far from where it was held it is away, m: what is held may rest on one finger, or be out of touch for a
moment."""

_TAKES: Final = ("holding", "stabbed")
"""Kinds of steps in which something is taken."""


@final
class Held:
    """Watches what is held in a run of a task.

    A thing that has fallen for good ends the run, and so does one that was knocked over; this is about one
    that slipped or was let go too early. What was done before need not be done again.

    Args:
        steps: of the task, in order.
    """

    def __init__(self, steps: tuple[TaskStep, ...]) -> None:
        self._steps = steps
        self._taken: int | None = None
        self._held_at: FloatArray | None = None
        self._since_s: float | None = None
        self._lost: Lost | None = None

    def see(self, done: int, state: SceneState, time_s: float) -> Lost | None:
        """Take how things stand, in every tick.

        Args:
            done: how many of the steps have been done.
            state: of the scene.
            time_s: the clock, s.

        Returns:
            What has been lost, until it is taken again; None where all is well.
        """
        taking = self._taking(done)
        if taking != self._taken or (self._lost is not None and self._steps[self._lost.step].done(state)):
            self._taken = taking
            self._held_at = self._since_s = self._lost = None
        if taking is not None and self._lost is None:
            self._lost = self._loses(self._steps[taking].thing, taking, state, time_s)
        return self._lost

    def _taking(self, done: int) -> int | None:
        """Index of the step in which was taken what is to be held now; None where nothing is."""
        thing = self._steps[done].holds if done < len(self._steps) else None
        if thing is None:
            return None
        before = [(step.kind, step.thing) for step in self._steps[:done]]
        return max(
            (i for i, (kind, one) in enumerate(before) if kind in _TAKES and one == thing), default=None
        )

    def _loses(self, thing: str, taking: int, state: SceneState, time_s: float) -> Lost | None:
        at = (state.poses[thing].position - state.tool.position) @ state.tool.rotation
        held = thing in state.gripped or thing in state.stabbed
        if self._held_at is None or held:
            self._held_at = at
        if held or np.linalg.norm(at - self._held_at) <= LOST_M:
            self._since_s = None
            return None
        if self._since_s is None:
            self._since_s = time_s
        return Lost(thing=thing, step=taking) if time_s - self._since_s >= LOST_S else None
