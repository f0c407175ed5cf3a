"""A task with things as a sequence of steps."""

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
"""Kinds of acts in a step."""

Predicate = Callable[[SceneState], bool]
"""Whether something holds of the things at one moment. One that remembers is made anew for every run."""

Failure = Callable[[SceneState], Mishap | None]  # an irreversible failure, or None
CAREFUL: Final = 0.5  # factor of a waypoint's tolerances with each further try
FINE_M: Final = 0.002
FINE_RAD: Final = 0.04  # least tolerances where something is done
ROUGH_M: Final = 0.01
ROUGH_RAD: Final = float(np.deg2rad(7.5))  # the same at waypoints on the way
PATIENCE_S: Final = 3.0  # the person waits so long at a waypoint for its condition


@final
@dataclass(frozen=True, eq=False)
class Waypoint:
    """A pose of the tool in a step, and the person's acts there."""

    pose: Callable[[SceneState], Pose]  # from the present state
    within_m: float = 0.02  # tolerance, m
    within_rad: float = float(np.deg2rad(15.0))  # tolerance of the orientation
    gripper: GripperAsk | None = None  # request to the gripper there
    wait_s: float = 0.0  # the person waits so long there for the effect of their act
    speed: float = 1.0  # share of their usual speed on the way there, in (0, 1]
    # the person presses on there until this holds and goes on as soon as it does; if it does not within
    # `PATIENCE_S`, they try the step again
    until: Predicate | None = None

    def reached(self, state: SceneState) -> bool:
        """Whether the tool is there."""
        pose = self.pose(state)
        # Far from it, as the tool mostly is, the angle need not be known.
        return self._distance(state, pose) <= 1.0 and self._turn(state, pose) <= 1.0

    def missed_by(self, state: SceneState) -> float:
        """Distance of the tool from there; 1 is the farthest that counts as reached."""
        pose = self.pose(state)
        return max(self._distance(state, pose), self._turn(state, pose))

    def closer(self, tries: int) -> "Waypoint":
        """The same with smaller tolerances, for a further try."""
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
        return float(np.linalg.norm(state.tool.position - pose.position)) / self.within_m

    def _turn(self, state: SceneState, pose: Pose) -> float:
        return float(angle_between(state.tool.rotation, pose.rotation)) / self.within_rad


@final
@dataclass(frozen=True, eq=False)
class TaskStep:
    """One step of a task."""

    kind: StepKind
    thing: str  # the object or the place of the step
    name: str  # in words
    done: Predicate  # whether the step is complete
    # the person's way; they try again from the first, with more care, if the step is not done after the last
    waypoints: tuple[Waypoint, ...]
    holds: str | None = None  # thing that an earlier step took and that must stay in the hand or on the fork


RETRY_S: Final = 1.0  # an unfinished step is tried again so long after its last waypoint
LOST_S: Final = 1.0  # a thing is lost after so long away: a released thing takes a moment to come to rest
LOST_M: Final = 0.03  # distance from its hold that counts as away: one finger may lose touch for a moment
_TAKES: Final = ("holding", "stabbed")  # kinds of steps that take something


@final
class Progress:
    """The progress of a run, and the person's next waypoint.

    A step is tried again, each time with more care, when it is not done after its last waypoint, when a
    waypoint's condition does not come true, and when `again` says so. Where a thing has slipped, or was let
    go too early, the step that took it is done again; later steps that are done stay done.
    """

    def __init__(self, steps: Sequence[TaskStep], failures: Sequence[Failure] = ()) -> None:
        self.steps = tuple(steps)
        self.done = 0  # number of steps done
        self.failure: Mishap | None = None  # the irreversible one, if any
        self.lost: int | None = None  # index of the step to repeat, as what it took is no longer held
        self.tries = 0  # number of earlier tries of the step
        self._failures = tuple(failures)
        self._index = 0
        self._arrived_s: float | None = None
        self._held_at: FloatArray | None = None
        self._away_s: float | None = None
        self.waypoint = self._next()  # the tool's present target; None where nothing is left

    @property
    def share(self) -> float:
        """Share of the steps done."""
        return self.done / len(self.steps)

    @property
    def succeeded(self) -> bool:
        """Whether all steps are done without a failure."""
        return self.done == len(self.steps) and self.failure is None

    @property
    def step(self) -> TaskStep | None:
        """The present step; None where nothing is left."""
        if self.lost is not None:
            return self.steps[self.lost]
        return self.steps[self.done] if self.done < len(self.steps) else None

    @property
    def asks(self) -> GripperAsk | None:
        """The person's present request to the gripper."""
        waypoint = self.waypoint
        return None if waypoint is None or self._arrived_s is None else waypoint.gripper

    @property
    def waits(self) -> bool:
        """Whether the person waits at a waypoint for the effect of their act."""
        return self._arrived_s is not None

    def update(self, state: SceneState) -> None:
        """Take the present state, at every tick of the loop."""
        if self.failure is None:
            self.failure = next((found for fails in self._failures if (found := fails(state))), None)
        before = self.step
        while self.done < len(self.steps) and self.steps[self.done].done(state):
            self.done += 1
            self._held_at = self._away_s = self.lost = None
        self.lost = self._slipped(state)
        if self.step is not before:
            self._index, self.tries, self._arrived_s = 0, 0, None
            self.waypoint = self._next()
        if self.waypoint is not None:
            self._go_on(self.waypoint, state)

    def again(self) -> None:
        """Try the step again from its first waypoint, with more care."""
        self._index, self._arrived_s = 0, None
        self.tries += 1
        self.waypoint = self._next()

    def _go_on(self, waypoint: Waypoint, state: SceneState) -> None:
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
        last = self.step is not None and self._index == len(self.step.waypoints) - 1
        if waited_s < (max(waypoint.wait_s, RETRY_S) if last else waypoint.wait_s):
            return
        if last:
            self.again()
            return
        self._index, self._arrived_s = self._index + 1, None
        self.waypoint = self._next()

    def _next(self) -> Waypoint | None:
        step = self.step
        return None if step is None else step.waypoints[self._index].closer(self.tries)

    def _slipped(self, state: SceneState) -> int | None:
        """Index of the step that took the thing that should be held now and is not."""
        if self.lost is not None:
            return None if self.steps[self.lost].done(state) else self.lost
        thing = self.steps[self.done].holds if self.done < len(self.steps) else None
        done = enumerate(self.steps[: self.done])
        taking = [index for index, step in done if step.kind in _TAKES and step.thing == thing]
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
