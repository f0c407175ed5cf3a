"""Drives with models that look at things, whose places come from sources, as the page drives them.

The page's own `Drive` follows the things, in simulated time, by messages like those of `--objects`. A
simulated person drives learned motions while the picture shows everything where it is, and straight lines
from `REACTION_S` after it does not. Things stand where no demonstration had them.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from multiprocessing import Pipe
from pathlib import Path
from typing import Any, Final, cast, final

import numpy as np

from latentarm.arms.catalogue import make_scene_arm
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.joined import JoinedController
from latentarm.assistance.controllers.latent import LatentController
from latentarm.control.clock import SimulatedClock
from latentarm.core.types import NO_GRIPPER, Context, FloatArray, Input, StepRecord
from latentarm.core.untrusted.documents import read_object
from latentarm.models.decoder import Decoder
from latentarm.robots.kinematics.pose_rows import object_rows
from latentarm.robots.scene.scene import SceneState
from latentarm.runs.results_folder import write_json
from latentarm.surroundings.catalogue import TOUCH as BY_TOUCH
from latentarm.surroundings.process import as_message
from latentarm.surroundings.surroundings import Surroundings
from latentarm.tasks.place import ScenePlace
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm.web.arm_process.drive import Drive
from latentarm.web.arm_process.drive_setup import PERIOD_S, DriveSetup, Spec
from latentarm.web.arm_process.episode_writer import EpisodeWriter
from latentarm.web.arm_process.help import Help
from latentarm.web.arm_process.steering import Steering
from latentarm.web.arm_process.task_run import things_to_do
from latentarm.web.protocol.channel import new_channel
from latentarm.web.protocol.orders import AskedGripper, ChooseMode, Enable, Given, Order
from latentarm.web.protocol.report import Report, parse_report
from latentarm_research.drives.following import Following
from latentarm_research.measurements import catalogue
from latentarm_research.measurements.geom_distances import Judge
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.measurements.thing_sources import SOURCES, TOUCH, TRUE, Detections, touched
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.people.contract import LoopLimits
from latentarm_research.people.person import SimulatedPerson
from latentarm_research.studies.streams import generator
from latentarm_research.studies.study import Grid, Keep, Request
from latentarm_research.studies.tasks import kept
from latentarm_research.studies.tasks.cell import ModelCell, ShownCell, show, train, training_set
from latentarm_research.studies.tasks.moved import task_of
from latentarm_research.studies.tasks.preset import Condition, Preset, Stream
from latentarm_research.studies.tasks.runs import choice_of, decoders_of

MODEL: Final = Condition("joints objects_in_tool", "homogeneous", way_back=True)
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


def measure(options: catalogue.Surroundings, work: Work) -> Outcome:
    """How many drives succeed with each source, and in how many ticks anything is unsafe."""
    preset = Preset(
        "surroundings", options.runs, demonstrations=options.demonstrations, seeds=1, epochs=options.epochs
    )
    quiet = not work.bars
    grid = Grid(Request(work.out, preset, seed=work.seed, jobs=work.jobs, bars=work.bars, quiet=quiet))
    decoders: dict[str, Decoder] = {}
    for task in options.tasks:
        cells = [ShownCell(task, Stream.DEMONSTRATIONS, n, work.seed) for n in range(preset.demonstrations)]
        shown = grid.run("Demonstrations", show, cells, str, kept.KEEP_SHOWN)
        model = ModelCell(task, MODEL, training_set(task, shown), preset, work.seed)
        (trained,) = grid.run("Models", train, [model], lambda cell: cell.task, kept.KEEP_MODELS)
        (decoders[task],) = decoders_of(trained.model)
    drives = [
        DriveCell(task, source, number, work.seed, decoders[task])
        for number in range(options.runs)
        for task in options.tasks
        for source in options.sources or SOURCES
    ]
    found = grid.run("Drives", drive, drives, lambda cell: cell.label, Keep(_read, _write))
    rows, broken = [], list[str]()
    for task, source in dict.fromkeys((one.task, one.source) for one in drives):
        mine = [f for one, f in zip(drives, found, strict=True) if (one.task, one.source) == (task, source)]
        done_s = [one["time_s"] for one in mine if one["success"]]
        figures: dict[str, float | None] = {
            "succeeded": sum(one["success"] for one in mine),
            "median_time_s": float(np.median(done_s)) if done_s else None,
            "in_straight_lines_percent": 100.0 * float(np.mean([one["straight_share"] for one in mine])),
            "left_by_the_page": sum(one["left"] for one in mine),
            "stops": sum(one["stops"] for one in mine),
            "nearest_mm": 1000.0 * min(one["nearest_m"] for one in mine),
            "most_table_force_n": max(one["table_force_n"] for one in mine),
            **{name: sum(one[name] for one in mine) for name in UNSAFE},
        }
        rows += line("surroundings", source, len(mine), figures, task)
        broken += [f"{task}, {source}: {name} in {figures[name]:g} ticks" for name in UNSAFE if figures[name]]
    return Outcome(rows, broken)


@final
@dataclass(frozen=True, eq=False)
class DriveCell:
    """One drive."""

    task: str
    source: str  # one of `SOURCES`
    number: int
    seed: int
    decoder: Decoder

    @property
    def label(self) -> str:
        """Its name in errors, and of its file."""
        return f"{self.task}/{self.source}/{self.number}"


def _read(out: Path, cell: DriveCell) -> dict[str, float] | None:
    path = out / "runs" / f"{cell.label}.json"
    return cast(dict[str, float], read_object(path)) if path.exists() else None


def _write(out: Path, cell: DriveCell, figures: Mapping[str, float]) -> None:
    write_json(out / "runs" / f"{cell.label}.json", figures)


def drive(cell: DriveCell) -> dict[str, float]:
    """Drive once; the figures of the drive."""
    task = task_of(cell.task, Stream.RUNS)
    choice = choice_of(task, cell.number)
    # Steps remember what they have seen: the page and the person have their own.
    begun, theirs = (
        task.begin(choice, generator(cell.seed, cell.task, Stream.RUNS, cell.number)) for _ in range(2)
    )
    page = SimulatedPage(cell, _setup(task, choice, begun, cell), theirs)
    page.run(task.time_limit_s)
    return page.figures(choice)


def _setup(task: SceneTask, choice: int, begun: Beginning, cell: DriveCell) -> DriveSetup:
    robot, straight = task.robot, EndEffectorController(task.robot)
    latent = LatentController(cell.decoder)
    return DriveSetup(
        spec=Spec(objects=() if cell.source == TRUE else (BY_TOUCH,), incidents=False),
        arm="mujoco",
        task=ScenePlace(robot, begun.goals, task.obstacles, begun.objects),
        controller=JoinedController([latent, straight]),
        latent_dim=latent.input_dim,
        axes=straight.modes,
        help=Help(),
        start=begun.state,
        todo=things_to_do(task, choice, begun),
        scene=begun.scene,
    )


@final
class SimulatedPage:
    """A simulated person at the page of one drive, in simulated time."""

    def __init__(self, cell: DriveCell, setup: DriveSetup, begun: Beginning) -> None:
        self._rng = generator(cell.seed, cell.task, 3, cell.number)
        robot, self._setup, self._clock = setup.task.robot, setup, SimulatedClock()
        scene = setup.scene or begun.scene
        self._arm = make_scene_arm("mujoco", robot, setup.start, self._clock.now_s, scene)
        self._arm.connect()
        reading, self._orders = Pipe(duplex=False)
        seen, self._seen = Pipe(duplex=False)
        self._channel = new_channel(reading, seen)
        self._steering = Steering("end_effector")
        if cell.source == TOUCH:
            self._steering.things = Surroundings(setup.tracked, stand=True, sightings=None)
            touched(self._steering.things, begun, self._rng)
        self._source = Detections(cell.source, begun, self._rng)
        self._follow = Following(begun)
        step = setup.step()
        self._most = step.joint_speed
        self._person = SimulatedPerson(
            robot, PEOPLE["unsteady"], PERIOD_S, LoopLimits(step.dead_zone, step.joint_speed)
        )
        self._judge = Judge(robot, tuple(setup.task.obstacles))
        self._clearance_m = step.safety.clearance
        self._straight = EndEffectorController(robot)
        self._latent = LatentController(cell.decoder)
        self._drive = Drive(
            setup,
            self._arm,
            self._channel,
            self._clock,
            EpisodeWriter(Path("unused")),
            lambda: self._over,
            self._steering,
            observers=[self._tick],
        )
        self._over = self._switching = self._waited = False
        self._stops = self._ticks = self._sequence = 0
        self._stopped_s: float | None = SEEN_S - ENABLES_S  # begins as after a stop
        self._doubtful_s = 0.0
        self._mode = self._steering.mode
        self._velocity = np.zeros(robot.dof)
        self._counts = dict.fromkeys((*UNSAFE, "left", "straight"), 0)
        self._nearest_m = np.inf

    def run(self, limit_s: float) -> None:
        """Drive until the task is done, has failed, or the time is over."""
        with self._arm:
            self._drive.run(round(limit_s / PERIOD_S))
        for end in (self._seen, self._orders, self._channel.orders):
            end.close()

    def figures(self, choice: int) -> dict[str, float]:
        """What is measured of the drive."""
        found = self._follow.trace(choice, self._setup.task.robot.chain, self._stops).figures
        counts = {name: float(count) for name, count in self._counts.items()}
        return {
            **counts,
            "success": float(found.success),
            "time_s": found.time_s,
            "stops": float(self._stops),
            "table_force_n": found.table_force_n,
            "straight_share": counts.pop("straight") / max(self._ticks, 1),
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
            taken_s = time.monotonic() - 0.06
            self._seen.send_bytes(as_message(replace(one, time_s=taken_s), "detector", HOLD_S))
        found = self._channel.report.read()
        report = None if found is None else parse_report(found[1])
        if report is None:
            raise RuntimeError("the page has no report")
        self._judge_tick(record, report)
        self._give(self._input(record, report, state), report)

    def _judge_tick(self, record: StepRecord, report: Report) -> None:
        limits, v, counts = self._setup.task.robot.limits, record.command.velocity, self._counts
        counts["outside_limits"] += bool(limits.violation(record.state).any())
        asked = np.abs(v - self._velocity) / PERIOD_S
        counts["too_fast"] += bool(
            (np.abs(v) > self._most + 1e-9).any() or (asked > limits.acceleration + 1e-6).any()
        )
        self._velocity = v
        if self._ticks % LOOK_TICKS == 0:
            nearest_m = float(self._judge.distances(record.state, FAR_M).min())
            self._nearest_m = min(self._nearest_m, nearest_m)
            counts["too_near"] += nearest_m < self._clearance_m - 1e-5
        driven = record.mode == 0 and bool(record.input.any())
        counts["old_places"] += driven and not self._known(record.time_s)
        counts["held_through_jump"] += self._waited and bool(record.input.any())
        self._waited = report.let_go_first
        counts["straight"] += report.mode == "end_effector"

    def _known(self, now_s: float) -> bool:
        things, names = self._steering.things, self._setup.controller.objects
        return things is None or not things.tracker.unknown(names, now_s)

    def _drawn_right(self, state: SceneState, now_s: float) -> bool:
        things = self._steering.things
        if things is None:
            return True
        for name in self._setup.controller.objects:
            where = things.tracker.look(name, now_s)
            off = np.inf if where.pose is None else where.pose.position - state.poses[name].position
            if not where.known or np.linalg.norm(off) > WRONG_M:
                return False
        return True

    def _input(self, record: StepRecord, report: Report, state: SceneState) -> Input:
        progress, now_s = self._follow.progress, record.time_s
        rest = Input(np.zeros(self._setup.controller.input_dim), gripper=progress.asks)
        if report.phase in ("disengaged", "neutral_needed", "stopping"):
            self._enable(now_s)
            return rest
        self._stopped_s = None
        self._choose(report, state, now_s)
        waypoint = progress.waypoint
        latent = report.mode == "latent"
        if waypoint is None or rest.gripper is not None or report.let_go_first:
            return rest
        if latent and not self._known(now_s):
            return rest
        carries = state.stabbed | state.gripped
        given = self._person.act(
            Context(record.state, record.belief, NO_GRIPPER, self._rows(state, now_s), NO_GRIPPER),
            self._latent if latent else self._straight,
            0 if latent else report.axes,
            waypoint.pose(state),
            self._rng,
            waypoint.within_m,
            waypoint.speed,
            np.array([name in carries for name in self._setup.controller.objects], dtype=np.bool_),
        )
        if given.switch_mode and not self._switching:
            axes = (report.axes + 1) % len(self._straight.modes)
            self._order(ChooseMode(mode="end_effector", axes=axes))
        self._switching = given.switch_mode
        return given

    def _rows(self, state: SceneState, now_s: float) -> FloatArray:
        names, things = self._setup.controller.objects, self._steering.things
        return object_rows(state.poses, names) if things is None else things.tracker.rows(names, now_s)

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

    def _choose(self, report: Report, state: SceneState, now_s: float) -> None:
        """Choose learned motions or straight lines, by what the picture shows."""
        if report.mode != self._mode:
            self._counts["left"] += report.mode == "end_effector" and not self._known(now_s)
            self._mode = report.mode
            self._person.reset()
        right = self._drawn_right(state, now_s)
        if right == (report.mode == "latent"):
            self._doubtful_s = now_s
        elif now_s - self._doubtful_s >= REACTION_S and not report.let_go_first:
            self._doubtful_s = now_s
            self._order(ChooseMode(mode="latent" if right else "end_effector", axes=0))

    def _order(self, order: Order) -> None:
        self._orders.send_bytes(order.model_dump_json().encode())

    def _give(self, given: Input, report: Report) -> None:
        self._sequence += 1
        stamps: dict[str, Any] = {"seq": self._sequence, "nonce": report.nonce}
        ask = None if given.gripper is None else AskedGripper(ask=given.gripper, **stamps)
        message = Given(
            driver=1, u=tuple(given.u.tolist()), latched=False, source="gamepad", gripper=ask, **stamps
        )
        self._channel.given.write(message.model_dump_json().encode())
