"""A task with things as steps that tick off one after the other."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, final

import numpy as np

from latentarm.kinematics.rotations import angle_between
from latentarm.scene.scene import SceneState
from latentarm.tasks.mishap import Mishap
from latentarm.types import GripperAsk, Pose

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
"""Share of a waypoint's tolerances that counts once a step is tried again."""

FINE_M: Final = 0.01
FINE_RAD: Final = float(np.deg2rad(7.5))
"""Tolerances that are no larger stay as they are: what was missed there is not for want of care."""


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
    """

    pose: Callable[[SceneState], Pose]
    within_m: float = 0.02
    within_rad: float = float(np.deg2rad(15.0))
    gripper: GripperAsk | None = None
    wait_s: float = 0.0
    speed: float = 1.0

    def reached(self, state: SceneState) -> bool:
        """Whether the tool is there."""
        pose = self.pose(state)
        # Far from it, as the tool mostly is, the angle need not be known.
        return self._distance(state, pose) <= 1.0 and self._turn(state, pose) <= 1.0

    def missed_by(self, state: SceneState) -> float:
        """How far the tool is from there; 1 is the farthest that counts as reached."""
        pose = self.pose(state)
        return max(self._distance(state, pose), self._turn(state, pose))

    def closer(self) -> "Waypoint":
        """The same with smaller tolerances, for another try."""
        return replace(
            self,
            within_m=min(self.within_m, max(CAREFUL * self.within_m, FINE_M)),
            within_rad=min(self.within_rad, max(CAREFUL * self.within_rad, FINE_RAD)),
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


@final
class Progress:
    """How far a run of a task has come.

    Args:
        steps: of the task, in order.
        failures: what ends the run.
    """

    def __init__(self, steps: Sequence[TaskStep], failures: Sequence[Failure] = ()) -> None:
        self._steps = tuple(steps)
        self._failures = tuple(failures)
        self._done = self._waypoint = self._tries = 0
        self._careful = False
        self._arrived_s: float | None = None
        self._failure: Mishap | None = None
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
    def step(self) -> TaskStep | None:
        """What is to be done now; None where nothing is left."""
        return self._steps[self._done] if self._done < len(self._steps) else None

    @property
    def waypoint(self) -> Waypoint | None:
        """Where the tool is to go now; None where nothing is left to do."""
        return self._at

    @property
    def tries(self) -> int:
        """How often a step was tried again."""
        return self._tries

    @property
    def careful(self) -> bool:
        """Whether the step is being tried again."""
        return self._careful

    @property
    def asks(self) -> GripperAsk | None:
        """What the person asks of the gripper now."""
        waypoint = self.waypoint
        return None if waypoint is None or self._arrived_s is None else waypoint.gripper

    @property
    def waits(self) -> bool:
        """Whether the person waits at a waypoint."""
        return self._arrived_s is not None

    def update(self, state: SceneState) -> None:
        """Take how things stand now.

        Args:
            state: at every tick of the loop.
        """
        if self._failure is None:
            self._failure = next((found for fails in self._failures if (found := fails(state))), None)
        while (step := self.step) is not None and step.done(state):
            self._done += 1
            self._waypoint, self._careful, self._arrived_s = 0, False, None
            self._at = self._next()
        if step is None or self._at is None:
            return
        waypoint = self._at
        if self._arrived_s is None:
            if not waypoint.reached(state):
                return
            self._arrived_s = state.time_s
        last = self._waypoint == len(step.waypoints) - 1
        if state.time_s - self._arrived_s < (max(waypoint.wait_s, RETRY_S) if last else waypoint.wait_s):
            return
        self._arrived_s = None
        before = self._waypoint, self._careful
        self._waypoint = 0 if last else self._waypoint + 1
        self._tries += last
        self._careful = self._careful or last
        if (self._waypoint, self._careful) != before:
            self._at = self._next()

    def _next(self) -> Waypoint | None:
        if self.step is None:
            return None
        waypoint = self.step.waypoints[self._waypoint]
        return waypoint.closer() if self._careful else waypoint
