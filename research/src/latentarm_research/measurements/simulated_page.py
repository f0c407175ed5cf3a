"""A simulated person at the page's own `Drive`, in simulated time, with sources of where things are.

The `Drive`'s tracker gets what the sources see. The person drives learned motions while the picture shows
everything where it is, and straight lines from `REACTION_S` after it does not.
"""

from collections.abc import Mapping
from dataclasses import replace
from multiprocessing import Pipe
from pathlib import Path
from typing import Any, Final, final

import numpy as np

from latentarm.arms.catalogue import make_scene_arm
from latentarm.assistance.controllers.contract import Controller
from latentarm.control.clock import SimulatedClock
from latentarm.core.types import NO_GRIPPER, NO_OBJECTS, Context, Input, Pose, StepRecord
from latentarm.robots.kinematics.pose_rows import object_rows
from latentarm.robots.scene.scene import SceneState
from latentarm.surroundings.surroundings import Surroundings
from latentarm.tasks.scene_task import Beginning
from latentarm.web.arm_process.drive import Drive
from latentarm.web.arm_process.drive_setup import PERIOD_S, DriveSetup
from latentarm.web.arm_process.episode_writer import EpisodeWriter
from latentarm.web.arm_process.steering import Steering
from latentarm.web.protocol.channel import Channel
from latentarm.web.protocol.orders import AskedGripper, ChooseMode, Enable, Given, Order
from latentarm.web.protocol.report import Report
from latentarm_research.drives.following import Following
from latentarm_research.measurements.geom_distances import Judge
from latentarm_research.measurements.thing_sources import AGE_TICKS, TOUCH, Detections, touched
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.people.contract import LoopLimits
from latentarm_research.people.person import SimulatedPerson

HOLD_S: Final = 2.0  # how long a sighting counts, as by default
WRONG_M: Final = 0.03  # a person sees that a thing is drawn so far off
REACTION_S: Final = 0.5
SEEN_S: Final = 1.0  # after so long sources have seen the things, and the person enables the arm
ENABLES_S: Final = 2.0  # after a stop, and between two tries
LOOK_TICKS: Final = 10  # between two looks at how near the arm is to the table and to itself
FAR_M: Final = 1.0  # distances beyond this are not worked out
UNSAFE: Final = ("outside_limits", "too_fast", "too_near", "old_places", "held_through_jump")
"""Ticks (of `too_near`: looks) in which a joint is outside its limits, or asked to move or to change its
speed faster than its limits; the arm is nearer to the table or itself than the filters let it come; a model
is driven with a place that counts no more; or a stick that was to be let go first moves the arm."""


@final
class SimulatedPage:
    """A simulated person at the page of one drive, in simulated time."""

    def __init__(
        self,
        setup: DriveSetup,
        source: str,  # of where the things are, one of `SOURCES`
        begun: Beginning,  # a second one: steps remember what they have seen, and the page has its own
        controllers: Mapping[str, Controller],  # by the page's modes
        rng: np.random.Generator,
    ) -> None:
        self._rng = rng
        robot, clock = setup.task.robot, SimulatedClock()
        self._setup, self._controllers, self._names = setup, controllers, setup.controller.objects
        self._arm = make_scene_arm("mujoco", robot, setup.start, clock.now_s, begun.scene)
        self._arm.connect()
        reading, self._orders = Pipe(duplex=False)
        self._channel = Channel(reading)
        self._followed = Surroundings(setup.tracked, stand=True, sightings=None)
        self._steering = Steering("end_effector", things=self._followed)
        if source == TOUCH:
            touched(self._followed, begun, self._rng)
        self._source = Detections(source, begun, self._rng)
        self._follow = Following(begun)
        step = setup.step()
        self._most, self._clearance_m = step.joint_speed, step.safety.clearance
        person = PEOPLE["planning"]
        self._person = SimulatedPerson(robot, person, PERIOD_S, LoopLimits(step.dead_zone, self._most))
        self._judge = Judge(robot, tuple(setup.task.obstacles))
        writer, over = EpisodeWriter(Path("unused")), lambda: self._over
        about = (writer, over, self._steering)
        self._drive = Drive(setup, self._arm, self._channel, clock, *about, observers=[self._tick])
        self._over = self._switching = self._waited = False
        self._stops = self._ticks = 0
        self._stopped_s: float | None = SEEN_S - ENABLES_S  # begins as after a stop
        self._doubtful_s = 0.0
        self._mode = self._steering.mode
        self._velocity = np.zeros(robot.dof)
        self._counts = dict.fromkeys((*UNSAFE, "straight"), 0)
        self._nearest_m = np.inf

    def run(self, limit_s: float) -> None:
        """Drive until the task is done, has failed, or the time is over."""
        with self._arm:
            self._drive.run(round(limit_s / PERIOD_S))
        self._orders.close()
        self._channel.orders.close()

    def figures(self, choice: int) -> dict[str, float]:
        """Measures of the drive, by name."""
        found = self._follow.trace(choice, self._setup.task.robot.chain, self._stops).figures
        return {
            **self._counts,
            "success": found.success,
            "time_s": found.time_s,
            "stops": self._stops,
            "table_force_n": found.table_force_n,
            "straight_share": self._counts["straight"] / max(self._ticks, 1),
            "nearest_m": self._nearest_m,
        }

    def _tick(self, record: StepRecord) -> None:
        """After each command: look, judge, and give the input for the next tick."""
        if self._over:
            return
        state = self._arm.scene_state()
        self._follow.sees(state)
        if self._follow.ending is not None:
            self._over = True
            return
        self._follow.records.append(record)
        self._ticks += 1
        for one in self._source.look(record.time_s, state.poses, state.tool):
            taken = replace(one, time_s=record.time_s - PERIOD_S * AGE_TICKS)
            self._followed.tracker.saw(taken, "detector", HOLD_S, record.time_s)
        found = self._channel.report.read()
        report = None if found is None else Report.parse(found[1])
        if report is None:
            raise RuntimeError("the page has no report")
        drawn = self._drawn(state, record.time_s)
        self._judge_tick(record, report, known=len(drawn) == len(self._names))
        self._give(self._input(record, report, state, drawn), report)

    def _drawn(self, state: SceneState, now_s: float) -> Mapping[str, Pose]:
        """Poses at which the page draws the things that the model needs; lost things are left out."""
        things = self._steering.things
        if things is None:
            return {name: state.poses[name] for name in self._names}
        found = {name: things.tracker.look(name, now_s) for name in self._names}
        return {name: where.pose for name, where in found.items() if where.known and where.pose is not None}

    def _judge_tick(self, record: StepRecord, report: Report, *, known: bool) -> None:
        limits, v, counts = self._setup.task.robot.limits, record.command.velocity, self._counts
        counts["outside_limits"] += bool(limits.violation(record.state).any())
        faster = np.abs(v - self._velocity) / PERIOD_S > limits.acceleration + 1e-6
        counts["too_fast"] += bool((np.abs(v) > self._most + 1e-9).any() or faster.any())
        self._velocity = v
        if self._ticks % LOOK_TICKS == 0:
            nearest_m = float(self._judge.distances(record.state, FAR_M).min())
            self._nearest_m = min(self._nearest_m, nearest_m)
            counts["too_near"] += nearest_m < self._clearance_m - 1e-5
        pushed = bool(record.input.any())
        counts["old_places"] += pushed and record.mode == 0 and not known
        counts["held_through_jump"] += pushed and self._waited
        self._waited = report.let_go_first
        counts["straight"] += report.mode == "end_effector"

    def _input(
        self, record: StepRecord, report: Report, state: SceneState, drawn: Mapping[str, Pose]
    ) -> Input:
        progress, waypoint = self._follow.progress, self._follow.progress.waypoint
        rest = Input(np.zeros(self._setup.controller.input_dim), gripper=progress.asks)
        if report.phase in ("disengaged", "neutral_needed", "stopping"):
            self._enable(record.time_s)
            return rest
        self._stopped_s = None
        self._choose(report, state, drawn, record.time_s)
        lost = report.mode == "latent" and len(drawn) < len(self._names)
        if waypoint is None or rest.gripper is not None or report.let_go_first or lost:
            return rest
        rows = object_rows(drawn, self._names) if len(drawn) == len(self._names) else NO_OBJECTS
        carries = state.stabbed | state.gripped
        controller = self._controllers[report.mode]
        given = self._person.act(
            Context(record.state, record.belief, NO_GRIPPER, rows, NO_GRIPPER),
            controller,
            0 if report.mode == "latent" else report.axes,
            waypoint.pose(state),
            self._rng,
            waypoint.within_m,
            waypoint.speed,
            np.array([name in carries for name in self._names], dtype=np.bool_),
        )
        if given.switch_mode and not self._switching:
            axes = (report.axes + 1) % len(controller.modes)
            self._order(ChooseMode(mode="end_effector", axes=axes))
        self._switching = given.switch_mode
        return given

    def _enable(self, now_s: float) -> None:
        """After a stop the person lets go, waits, presses Enable, and tries the step again."""
        if self._stopped_s is None:
            self._stopped_s = now_s
            self._stops += 1
            self._person.reset()
            self._follow.progress.again()
        if now_s - self._stopped_s >= ENABLES_S:
            self._stopped_s = now_s
            self._order(Enable(driver=1, stops=0))

    def _choose(self, report: Report, state: SceneState, drawn: Mapping[str, Pose], now_s: float) -> None:
        """Choose learned motions or straight lines, by what the picture shows."""
        if report.mode != self._mode:
            self._mode = report.mode
            self._person.reset()
        off_m = [np.linalg.norm(one.position - state.poses[name].position) for name, one in drawn.items()]
        right = len(drawn) == len(self._names) and max(off_m) <= WRONG_M
        if right == (report.mode == "latent"):
            self._doubtful_s = now_s
        elif now_s - self._doubtful_s >= REACTION_S and not report.let_go_first:
            self._doubtful_s = now_s
            self._order(ChooseMode(mode="latent" if right else "end_effector", axes=0))

    def _order(self, order: Order) -> None:
        self._orders.send_bytes(order.model_dump_json().encode())

    def _give(self, given: Input, report: Report) -> None:
        stamps: dict[str, Any] = {"seq": self._ticks, "nonce": report.nonce}
        ask = None if given.gripper is None else AskedGripper(ask=given.gripper, **stamps)
        rest: dict[str, Any] = {"latched": False, "source": "gamepad", "gripper": ask, **stamps}
        message = Given(driver=1, u=tuple(given.u.tolist()), **rest)
        self._channel.given.write(message.model_dump_json().encode())
