"""Follows a simulated drive: its progress, its end, and its trace."""

from collections.abc import Mapping
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray, Pose, StepRecord
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.scene.scene import TABLE, TOOL, Scene, SceneState
from latentarm.tasks.predicates import Spilled
from latentarm.tasks.scene_task import Beginning
from latentarm.tasks.steps import Progress, Waypoint
from latentarm_research.drives.trace import Trace
from latentarm_research.metrics.drives import measure_drive
from latentarm_research.metrics.ending import NOT_NEARER, STUCK_S, Ending, why_it_timed_out
from latentarm_research.metrics.preference_alignment import alignment_by_step, preference_alignment

NEARER: Final = 0.1
"""Least progress towards a waypoint, in its tolerances: with less for `STUCK_S` the person is stuck."""

STATES_EVERY: Final = 10
"""Ticks between two states that are kept."""


@final
class Following:
    """Follows a drive."""

    def __init__(self, begun: Beginning) -> None:
        self.progress = Progress(begun.steps, begun.failures)
        self.records: list[StepRecord] = []
        self.ending: Ending | None = None
        self.poses = poses_at(begun)
        self._begun = begun
        self._tool: list[Pose] = []
        self._points: list[FloatArray] = []
        self._needed: list[FloatArray] = []
        self._under_way: list[int] = []
        self._states: list[SceneState] = []
        self._newest: SceneState
        self._ticks = 0
        self._done_s: list[float] = []
        self._force_n: dict[str, float] = {}
        self._waypoint: Waypoint | None = None
        self._nearest = np.inf
        self._nearer_s = 0.0

    def sees(self, state: SceneState) -> None:
        """Take how things stand before the next input."""
        self.poses, self._newest = state.poses, state
        self.progress.update(state)
        self._done_s += [state.time_s] * (self.progress.done - len(self._done_s))
        self._feel(state)
        if self._ticks % STATES_EVERY == 0:
            self._states.append(state)
        self._ticks += 1
        self._tool.append(state.tool)
        waypoint = self.progress.waypoint
        if self.progress.failure is not None:
            self.ending = Ending("mishap", self.progress.failure.text)
        elif waypoint is None:
            self.ending = Ending("done", "done")
        else:
            self._points.append(state.tool.rotation[:, 2])
            self._needed.append(waypoint.pose(state).rotation[:, 2])
            self._under_way.append(self.progress.done)
            if not self._begun.patient and self._stuck(waypoint, state):
                self.ending = Ending("operator_stuck", NOT_NEARER)

    def trace(self, choice: int, chain: Chain, stops: int) -> Trace:
        """The drive so far."""
        begun, records, newest = self._begun, self.records, self._newest
        if begun.scene.names:
            kept = self._tool[: len(records)]
            tool = Pose(np.stack([one.position for one in kept]), np.stack([one.rotation for one in kept]))
        else:
            tool = chain.forward(np.stack([record.state for record in records]))
        points, needed = np.array(self._points), np.array(self._needed)
        spilled = [fails for fails in begun.failures if isinstance(fails, Spilled)]
        unfelt = 0.0 if begun.scene.names else np.nan
        figures = measure_drive(
            records,
            tool,
            target=begun.steps[-1].waypoints[-1].pose(newest),
            goals=np.array([goal.pose.position for goal in begun.goals]),
            success=self.progress.succeeded,
            steps_done=self.progress.share,
            stops=stops,
            preference_alignment=preference_alignment(points, needed),
            table_force_n=self._force_n.get("table", unfelt),
            food_force_n=self._force_n.get("food", unfelt),
            spilled=sum(one.count(newest) for one in spilled),
            grains=sum(len(one) for one in newest.grains.values()),
        )
        return Trace(
            figures=figures,
            choice=choice,
            text=begun.text,
            steps=begun.steps,
            done_s=tuple(self._done_s),
            target=begun.steps[0].waypoints[0].pose(self._states[0]).position,
            ending=self.ending or self._timed_out(chain),
            time_s=np.array([record.time_s for record in records]),
            position=tool.position,
            input=np.stack([record.input for record in records]),
            delay_s=np.array([record.delay_s for record in records]),
            mode=np.array([record.mode for record in records]),
            belief=np.stack([record.belief for record in records]),
            aligned=alignment_by_step(
                [step.name for step in begun.steps], np.array(self._under_way), points, needed
            ),
            states=tuple(self._states),
        )

    def _timed_out(self, chain: Chain) -> Ending:
        waypoint = self.progress.waypoint
        if waypoint is None:
            raise ValueError("the drive was done in time")
        since_s = self._done_s[-1] if self._done_s else self.records[0].time_s
        return why_it_timed_out(self.records, chain, waypoint.pose(self._newest), since_s)

    def _feel(self, state: SceneState) -> None:
        for (first, second), force_n in state.force_n.items():
            if TOOL in (first, second):
                other = second if first == TOOL else first
                kind = _kind(self._begun.scene, other)
                self._force_n[kind] = max(self._force_n.get(kind, 0.0), force_n)

    def _stuck(self, waypoint: Waypoint, state: SceneState) -> bool:
        missed = waypoint.missed_by(state)
        if waypoint is not self._waypoint or missed < self._nearest - NEARER or self.progress.waits:
            self._waypoint, self._nearest, self._nearer_s = waypoint, missed, state.time_s
        return state.time_s - self._nearer_s > STUCK_S


def poses_at(begun: Beginning) -> Mapping[str, Pose]:
    """Poses of the things at the start, for the decoder; of the goals where there are no things."""
    return {one.name: one.pose for one in (begun.scene.things or begun.goals)}


def _kind(scene: Scene, name: str) -> str:
    """``food``, or ``table`` for the table and everything that stands on it for good, or ``thing``."""
    if name == TABLE:
        return "table"
    thing = scene.thing(name)
    if thing.food is not None:
        return "food"
    return "table" if thing.fixed else "thing"
