"""A task with things as steps that tick off one after the other."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, final

import numpy as np

from latentarm.core.types import FloatArray, GripperAsk, Pose
from latentarm.robots.kinematics.rotations import angle_between
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.mishap import Mishap

StepKind = Literal[
    "approached",
    "reached",
    "passed",
    "holding",
    "stabbed",
    "above",
    "poured",
    "cut",
    "scooped",
    "dipped",
    "stirred",
    "placed",
]
"""What is done in a step."""

Predicate = Callable[[SceneState], bool]
"""Whether something holds of the things at one moment. One that remembers is made anew for every run."""

Failure = Callable[[SceneState], Mishap | None]
"""What has gone wrong for good, or None."""


CAREFUL: Final = 0.5
"""Share of a waypoint's tolerances that counts with each further try of its step."""

FINE_M: Final = 0.002
FINE_RAD: Final = 0.04
"""No person comes nearer than this where something is done."""

ROUGH_M: Final = 0.01
ROUGH_RAD: Final = float(np.deg2rad(7.5))
"""The same of waypoints that are only passed."""

PATIENCE_S: Final = 3.0
"""So long a person presses on at a waypoint for what they look at there, s."""


@final
@dataclass(frozen=True, eq=False)
class Waypoint:
    """Where a person brings the tool in a step, and what they do there.

    Attributes:
        pose: where, as things stand now.
        within_m: how near it counts as reached, m.
        within_rad: how nearly in that orientation, rad.
        gripper: what is asked of the gripper there.
        wait_s: how long they wait there, for what they have begun to happen, s.
        speed: share of their usual speed on the way there, in (0, 1].
        until: what they look at there. They press on until it holds, and go on as soon as it does; if it does
            not within `PATIENCE_S`, they try the step again.
    """

    pose: Callable[[SceneState], Pose]
    within_m: float = 0.02
    within_rad: float = float(np.deg2rad(15.0))
    gripper: GripperAsk | None = None
    wait_s: float = 0.0
    speed: float = 1.0
    until: Predicate | None = None

    def reached(self, state: SceneState) -> bool:
        """Whether the tool is there."""
        pose = self.pose(state)
        # Far from it, as the tool mostly is, the angle need not be known.
        return self._distance(state, pose) <= 1.0 and self._turn(state, pose) <= 1.0

    def missed_by(self, state: SceneState) -> float:
        """How far the tool is from there; 1 is the farthest that counts as reached."""
        pose = self.pose(state)
        return max(self._distance(state, pose), self._turn(state, pose))

    def closer(self, tries: int) -> "Waypoint":
        """The same with smaller tolerances, after so many tries."""
        if tries == 0:
            return self
        acts = self.gripper is not None or self.wait_s > 0 or self.until is not None
        fine_m, fine_rad = (FINE_M, FINE_RAD) if acts else (ROUGH_M, ROUGH_RAD)
        share = CAREFUL**tries
        return replace(
            self,
            within_m=min(self.within_m, max(share * self.within_m, fine_m)),
            within_rad=min(self.within_rad, max(share * self.within_rad, fine_rad)),
        )

    def _distance(self, state: SceneState, pose: Pose) -> float:
        """From the tool to a pose, in `within_m`."""
        return float(np.linalg.norm(state.tool.position - pose.position)) / self.within_m

    def _turn(self, state: SceneState, pose: Pose) -> float:
        """The same for orientation, in `within_rad`."""
        return float(angle_between(state.tool.rotation, pose.rotation)) / self.within_rad


@final
@dataclass(frozen=True, eq=False)
class TaskStep:
    """Something to be done.

    Attributes:
        kind: what is done.
        thing: name of the thing that it is done to, or where it is done.
        name: both in words.
        done: whether it has been done.
        waypoints: how a person does it; tried again from the first, with more care, if it is not done after
            the last.
        holds: name of what must be in the hand or on the fork until it is done, which an earlier step took;
            None for nothing.
    """

    kind: StepKind
    thing: str
    name: str
    done: Predicate
    waypoints: tuple[Waypoint, ...]
    holds: str | None = None


RETRY_S: Final = 1.0
"""A step that is not done so long after its last waypoint is tried again, s."""

LOST_S: Final = 1.0
"""A thing is lost once it has been away for so long, s: what is put down takes a moment to come to rest."""

LOST_M: Final = 0.03
"""So far from where it was held it is away, m: what is held may rest on one finger, or be out of touch for a
moment."""

_TAKES: Final = ("holding", "stabbed")
"""Kinds of steps in which something is taken."""


@final
class Progress:
    """How far a run of a task has come, and where a person brings the tool next.

    A step is tried again, each time with more care, when it is not done after its last waypoint, when what a
    waypoint waits for does not come, and when `again` says so. Where a thing has slipped or was let go too
    early, the step that took it is done again; what was done after that need not be.

    Args:
        steps: of the task, in order.
        failures: what ends the run.
    """

    def __init__(self, steps: Sequence[TaskStep], failures: Sequence[Failure] = ()) -> None:
        self._steps = tuple(steps)
        self._failures = tuple(failures)
        self._done = self._waypoint = self._tries = 0
        self._arrived_s: float | None = None
        self._failure: Mishap | None = None
        self._lost: int | None = None
        self._held_at: FloatArray | None = None
        self._away_s: float | None = None
        self._at = self._next()

    @property
    def steps(self) -> tuple[TaskStep, ...]:
        """What is to be done, in order."""
        return self._steps

    @property
    def done(self) -> int:
        """How many steps have been done."""
        return self._done

    @property
    def share(self) -> float:
        """Share of the steps that have been done."""
        return self._done / len(self._steps)

    @property
    def succeeded(self) -> bool:
        """Whether all steps have been done, and nothing has gone wrong."""
        return self._done == len(self._steps) and self._failure is None

    @property
    def failure(self) -> Mishap | None:
        """What has gone wrong for good."""
        return self._failure

    @property
    def lost(self) -> int | None:
        """Index of the step that is to be done again, because what it took is no longer held."""
        return self._lost

    @property
    def step(self) -> TaskStep | None:
        """What is to be done now; None where nothing is left."""
        if self._lost is not None:
            return self._steps[self._lost]
        return self._steps[self._done] if self._done < len(self._steps) else None

    @property
    def waypoint(self) -> Waypoint | None:
        """Where the tool is to go now; None where nothing is left to do."""
        return self._at

    @property
    def tries(self) -> int:
        """How often the step was tried before."""
        return self._tries

    @property
    def asks(self) -> GripperAsk | None:
        """What the person asks of the gripper now."""
        waypoint = self.waypoint
        return None if waypoint is None or self._arrived_s is None else waypoint.gripper

    @property
    def waits(self) -> bool:
        """Whether the person is at a waypoint and waits for what they have begun there."""
        return self._arrived_s is not None

    def update(self, state: SceneState) -> None:
        """Take how things stand now.

        Args:
            state: at every tick of the loop.
        """
        if self._failure is None:
            self._failure = next((found for fails in self._failures if (found := fails(state))), None)
        before = self.step
        while self._done < len(self._steps) and self._steps[self._done].done(state):
            self._done += 1
            self._held_at = self._away_s = self._lost = None
        self._lost = self._slipped(state)
        if self.step is not before:
            self._waypoint, self._tries, self._arrived_s = 0, 0, None
            self._at = self._next()
        if self._at is not None:
            self._go_on(self._at, state)

    def again(self) -> None:
        """Try the step again from its first waypoint, with more care."""
        self._waypoint, self._arrived_s = 0, None
        self._tries += 1
        self._at = self._next()

    def _go_on(self, waypoint: Waypoint, state: SceneState) -> None:
        """To the next waypoint, once everything is done at this one."""
        seen = waypoint.until is not None and waypoint.until(state)
        if self._arrived_s is None:
            if not waypoint.reached(state) and not (seen and waypoint.gripper is None):
                return
            self._arrived_s = state.time_s
            if waypoint.gripper is not None:
                return  # it is asked once at least
        waited_s = state.time_s - self._arrived_s
        if waypoint.until is not None and not seen:
            if waited_s >= max(waypoint.wait_s, PATIENCE_S):
                self.again()
            return
        last = self.step is not None and self._waypoint == len(self.step.waypoints) - 1
        if waited_s < (max(waypoint.wait_s, RETRY_S) if last else waypoint.wait_s):
            return
        if last:
            self.again()
            return
        self._waypoint, self._arrived_s = self._waypoint + 1, None
        self._at = self._next()

    def _next(self) -> Waypoint | None:
        step = self.step
        return None if step is None else step.waypoints[self._waypoint].closer(self._tries)

    def _slipped(self, state: SceneState) -> int | None:
        """Index of the step that took what should be held now and is not."""
        if self._lost is not None:
            return None if self._steps[self._lost].done(state) else self._lost
        thing = self._steps[self._done].holds if self._done < len(self._steps) else None
        taking = [
            index
            for index, step in enumerate(self._steps[: self._done])
            if step.kind in _TAKES and step.thing == thing
        ]
        if thing is None or not taking:
            return None
        at = (state.poses[thing].position - state.tool.position) @ state.tool.rotation
        held = thing in state.gripped or thing in state.stabbed
        if self._held_at is None or held:
            self._held_at = at
        if held or np.linalg.norm(at - self._held_at) <= LOST_M:
            self._away_s = None
            return None
        if self._away_s is None:
            self._away_s = state.time_s
        return taking[-1] if state.time_s - self._away_s >= LOST_S else None
