"""One arm being driven: inputs in, orders carried out, reports out."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.arms.contract import INPUT_BUDGET_S, Arm
from latentarm.control.clock import Clock
from latentarm.control.loop import ControlLoop
from latentarm.control.stick_ring import STRETCHES
from latentarm.core.call_log import CallLog
from latentarm.core.types import StepRecord, Stop
from latentarm.safety.straight_way import StraightWay
from latentarm.safety.tool_force import FORCE
from latentarm.safety.zones import zone_of_filter
from latentarm.tasks.step_goals import StepGoals
from latentarm.web.arm_process.disengaged import Disengaged
from latentarm.web.arm_process.drive_setup import PERIOD_S, DriveSetup
from latentarm.web.arm_process.episode_writer import EpisodeWriter
from latentarm.web.arm_process.episodes import Episodes
from latentarm.web.arm_process.ghosts import GhostPaths
from latentarm.web.arm_process.idle_limit import IdleLimit
from latentarm.web.arm_process.latest_readings import LatestReadings
from latentarm.web.arm_process.neutral_interlock import NeutralInterlock
from latentarm.web.arm_process.page_inputs import PageInputs
from latentarm.web.arm_process.pose_motion import AT_START_RAD, PoseMotion
from latentarm.web.arm_process.steering import Steering
from latentarm.web.arm_process.task_run import TaskRun
from latentarm.web.arm_process.thing_poses import ThingPoses, follow
from latentarm.web.protocol import orders
from latentarm.web.protocol.channel import Channel
from latentarm.web.protocol.notice import Notice, notice_of_stop
from latentarm.web.protocol.orders import Change, HelpLevel, ModeName, Order, PoseToGoTo
from latentarm.web.protocol.report import HeldBack, Phase, Report

ENABLE_WAITS_S: Final = 0.3
"""How long an order to enable waits for a fresh neutral input, s; longer where the arm allows more than
`INPUT_BUDGET_S`. A new driver's first input never counts: they were sent no state yet that it could answer.
"""

NOTE_S: Final = 6.0  # how long a refusal is shown instead of the arm's state, s
_HELD_BACK: Final[dict[str, HeldBack]] = {
    "clearance": "clearance",
    "freshness": "freshness",
    "workspace": "workspace",
    "joint position": "joint_position",
    FORCE: "force",
}
"""Filters whose effect is shown to people; the others are always active."""

_ORDERS_PER_TICK: Final = 4
_LOOK_EVERY: Final = 10
_STATISTICS_EVERY: Final = 100
_SPARE_S: Final = 0.004  # deferrable work needs this much time before the next tick, s


@final
@dataclass(eq=False)
class Drive:
    """The work of the control loop's thread for one setup, apart from the loop itself.

    It takes a few hundred microseconds a tick. Stops are checked in every tick, however full the pipe of
    orders is.
    """

    _setup: DriveSetup
    _arm: Arm
    _channel: Channel
    _clock: Clock
    _writer: EpisodeWriter
    _orphaned: Callable[[], bool]  # whether the page's server is gone
    _steering: Steering  # state from the drive before
    note: Notice | None = None  # shown to the person first; None for nothing
    observers: Sequence[Callable[[StepRecord], None]] = ()  # also called after every command
    calls: CallLog | None = None  # records every call of the arm's `Step`; None for nowhere

    def __post_init__(self) -> None:
        setup, steering, clock = self._setup, self._steering, self._clock
        arm, channel = self._arm, self._channel
        self._to_pose = setup.to_pose()
        self._to_pose.calls = setup.help.calls = self.calls
        about = setup.with_things(arm)
        steering.things = follow(setup, steering.things, channel.sightings)
        self._things = ThingPoses(setup, about, steering.things, clock.now_s)
        self._step = setup.step(self._things.surroundings(setup, about), self._to_pose, self.calls)
        self._inputs = PageInputs(
            channel.given,
            clock,
            setup.controller.input_dim,
            self._step.dead_zone,
            arm.spec.input_budget_s,
            self._stop_if_enabled,
        )
        self._neutral = NeutralInterlock(self._inputs)
        straight = StraightWay(setup.task.robot, self._step.safety)
        self._way_back = PoseMotion(self._neutral, self._inputs, setup.start, straight)
        self._ended: Notice | None = None
        self._idle = IdleLimit(setup.spec.idle_s, self._stop)
        self._ordered = False
        self._loop = ControlLoop(self._step, arm, self._way_back, clock, [self._observe, *self.observers])
        self._stop_version = channel.stop.version
        self._reasons: dict[str, Notice] = {}
        self._enable_until_s = -math.inf
        self._enable_driver = -1
        self._readings = LatestReadings(setup.start, setup.task.robot.gripper)
        self._ghosts = GhostPaths(setup.task, setup.controller, setup.help, self._step.safety)
        self._late_share = 0.0
        self._episodes = Episodes(setup, self._writer, steering, self._inputs, self._things)
        self._disengaged = Disengaged(self._step, arm, self._episodes, self._say)
        self._run = steering.run or TaskRun(setup.todo, about, setup.task.robot.chain)
        steering.run = self._run
        things = () if setup.scene is None else setup.scene.names
        self._goals = StepGoals(setup.task.robot, setup.task.goals, setup.todo.steps, things)
        self._note_until_s = -math.inf if self.note is None else clock.now_s() + NOTE_S
        self.change: Change | None = None  # the order that ended the loop to restart it
        self._choose(steering.mode, steering.axes, steering.help)

    @property
    def device(self) -> str:
        """The deflected input device, such as ``keyboard`` or ``pointer mouse``; "" for none."""
        kind, _, name = self._inputs.held_by or ("", 0, "")
        return f"{kind} {name}".strip()

    def run(self, ticks: int | None = None) -> Change | None:
        """Drive until `change` is due or the process ends; ``ticks`` limits it."""
        # The loop begins anew, and would begin in the first mode.
        self._loop.run(ticks, self._mode_index)
        return self.change

    def _observe(self, record: StepRecord) -> None:
        self._steering.tick += 1
        self._readings.see(record)
        enabled, steered = self._step.stopped is None, not self._way_back.on
        gripper = self._readings.gripper
        closing_m = gripper.width_m if gripper is not None and gripper.closing else None
        self._run.see(record.time_s, self._readings.q, enabled=enabled, steered=steered, closing_m=closing_m)
        # Only a recording is worth the look: some 0.1 ms.
        kept = self._things.recorded(record) if self._writer.on else record
        self._episodes.follow(kept, at_rest=self._step.at_rest)
        self._obey(record)
        self._disengaged.follow(record.time_s)
        self._follow_way_back(record)
        self._mind_things(record)
        self._enable_if_asked(record.time_s)
        self._look_for_inputs(record.time_s)
        self._channel.report.write(self._report(record).model_dump_json().encode())
        if self._clock.now_s() + _SPARE_S < record.time_s + PERIOD_S:
            self._look(record)
        if self.calls is not None:
            self._record_calls(self.calls)

    def _look_for_inputs(self, now_s: float) -> None:
        used = (
            self._step.stopped is not None or self._way_back.on or self._inputs.take_used() or self._ordered
        )
        self._ordered = False
        self._idle.look(now_s, used=used)

    def _record_calls(self, calls: CallLog) -> None:
        calls.flush()
        idle = (
            self._step.stopped is not None and self._step.at_rest and not self._disengaged.guiding.under_way
        )
        if calls.large and idle and not self._writer.on and self.change is None:
            # A file has everything from the start of its loop: the same is driven on, in another file.
            self._change_to(orders.ChooseProfile(name=self._setup.spec.profile))

    def _obey(self, record: StepRecord) -> None:
        if self._channel.stop.version != self._stop_version:
            # Whatever the slot holds, even half-written: somebody asked for a stop.
            self._stop_version = self._channel.stop.version
            reason = self._channel.stop.read()
            self._stop((reason and Notice.parse(reason[1])) or Notice(code="stop_pressed"))
        if self._channel.ending.count or self._orphaned():
            self._loop.finish()
        try:
            for order in self._channel.read_orders(_ORDERS_PER_TICK):
                self._ordered = True
                self._carry_out(order, record)
        except EOFError:
            self._loop.finish()

    def _stop(self, reason: Notice) -> None:
        self._enable_until_s = self._note_until_s = -math.inf
        self._end_guiding(reason)
        if self._step.stopped is None:
            self._reasons[reason.unnamed] = reason
        self._loop.stop(reason.unnamed)

    def _end_guiding(self, reason: Notice) -> None:
        """End guiding by hand, if it is under way, and keep the arm stopped for this reason."""
        if self._disengaged.end_guiding():
            self._step.refuse(Stop(reason.unnamed))
            self._reasons[reason.unnamed] = reason

    def _stop_if_enabled(self, reason: Notice) -> None:
        if self._step.stopped is None:
            self._stop(reason)

    def _say(self, note: Notice) -> None:
        self.note = note
        self._note_until_s = self._clock.now_s() + NOTE_S

    def _carry_out(self, order: Order, record: StepRecord) -> None:
        spec = self._setup.spec
        match order:
            case orders.Enable(driver=driver, stops=stops):
                # An Enable from before the newest Stop is ignored, whichever arrives first.
                if stops == self._stop_version:
                    self._enable_driver = driver
                    more_s = self._arm.spec.input_budget_s - INPUT_BUDGET_S
                    self._enable_until_s = record.time_s + ENABLE_WAITS_S + more_s
            case orders.ChooseMode(mode=mode, axes=axes):
                if mode in self._setup.modes:
                    self._choose(mode, self._steering.axes if axes is None else axes, self._steering.help)
            case orders.Return(on=True, pose=pose):
                self._set_out(record, pose)
            case orders.Return():
                self._end_way_back()
            case orders.ChooseHelp(level=level):
                self._choose_help(level)
            case orders.Record(on=True):
                if self._disengaged.records(order):
                    self._episodes.begin(order)
            case orders.Record():
                # Once the arm is at rest: its last motion belongs to it.
                self._steering.ending_episode = True
            case orders.Guide(on=True, stops=stops):
                if stops == self._stop_version:
                    self._note_until_s = -math.inf
                    self._disengaged.begin_guiding(record.time_s)
            case orders.Guide():
                self._end_guiding(Notice(code="guiding_ended"))
            case orders.KeepGuiding(gripper=ask):
                self._disengaged.guiding.keep(record.time_s, ask)
            case orders.TouchThing(thing=thing, kind=kind):
                if not self._step.at_rest or not self._things.touch(thing, kind):
                    self._say(Notice(code="touch_refused"))
            case orders.Reconnect():
                if self._disengaged.connect_again():
                    self._change_to(order)
            case orders.ChooseProfile() if (order.name, spec.seated(order.seat)) == (spec.profile, spec.seat):
                pass
            case orders.BeginTask(choice=int(choice)) if not 0 <= choice < len(self._setup.todo.choices):
                pass
            case orders.ChooseProfile() | orders.ChooseRun() | orders.Reset() | orders.BeginTask():
                self._change_to(order)

    def _change_to(self, change: Change) -> None:
        """End the loop for this order, if the arm is disengaged."""
        if self._step.stopped is None or not self._step.at_rest or self._disengaged.guiding.under_way:
            self._say(Notice(code="stop_first"))
            return
        if not isinstance(change, orders.ChooseProfile):
            # An episode is one motion of one arm: it ends before the arm is put somewhere else.
            self._episodes.end()
        self.change = change
        self._loop.finish()

    def _choose(self, mode: ModeName, axes: int, level: HelpLevel) -> None:
        modes, pairs = self._setup.modes, len(self._setup.axes)
        if self._steering.choose(mode, axes, level, modes, pairs):
            # A stick that is held would go on, with another meaning.
            self._neutral.demand()
        self._way_back.end()
        self._setup.help.choose(self._steering.help_now)
        self._step.choose_mode(self._mode_index)

    def _choose_help(self, level: HelpLevel) -> None:
        """Set the level now if latent actions are driven, else for the next time that they are."""
        if "assisted" not in self._setup.modes:
            return
        if self._steering.mode == "end_effector":
            self._steering.help = level
        else:
            self._choose("latent" if level == "off" else "assisted", self._steering.axes, level)

    def _set_out(self, record: StepRecord, pose: PoseToGoTo | None) -> None:
        if self._setup.spec.shadow:
            self._say(Notice(code="shadow_stays"))
            return
        goal = self._setup.start if pose is None else np.array(pose.q)
        limits = self._setup.task.robot.limits
        if goal.shape != limits.lower.shape or limits.violation(goal).any():
            self._say(Notice(code="pose_unreachable", parameters={"pose": "" if pose is None else pose.name}))
            return
        if self._step.stopped is not None or not self._step.at_rest or self._inputs.deflected:
            self._say(Notice(code="return_not_now"))
            return
        # An episode is one motion of a person's.
        self._episodes.end()
        self._note_until_s = -math.inf
        self._setup.help.choose("off")
        self._to_pose.lead_to(goal)
        self._step.choose_mode(self._setup.way_back)
        name = None if pose is None else pose.name
        self._way_back.begin(record.time_s, self._readings.q, goal, self._things.held.now, name)

    def _end_way_back(self) -> None:
        self._choose(self._steering.mode, self._steering.axes, self._steering.help)

    def _follow_way_back(self, record: StepRecord) -> None:
        if not self._way_back.on:
            if record.input.any() and self.note is not None and self.note == self._ended:
                self._note_until_s = -math.inf
            return
        self._step.forget()
        if self._step.stopped is not None:
            self._end_way_back()
        elif (outcome := self._way_back.outcome(self._readings.q, record.time_s)) is not None:
            self._end_way_back()
            self._ended = self._way_back.ending(outcome)
            self._say(self._ended)

    def _mind_things(self, record: StepRecord) -> None:
        """Follow the things; leave learned motions that need one whose place is unknown.

        What a held stick does changes too where a thing is suddenly elsewhere: it must be let go first.
        """
        if self._things.update(record, self._readings.q):
            self._step.hold(*self._things.held.now)
        if self._steering.mode == "end_effector" or self._way_back.on:
            return
        if (unknown := self._things.unknown) is not None:
            self._choose("end_effector", self._steering.axes, self._steering.help)
            self._say(unknown)
        elif (moved := self._things.moved) is not None:
            self._neutral.demand()
            self._say(moved)

    def _enable_if_asked(self, now_s: float) -> None:
        """Enable once there is a fresh neutral input; the loop itself decides."""
        if now_s > self._enable_until_s:
            return
        if self._step.stopped is None:
            self._enable_until_s = -math.inf
        elif self._inputs.fresh and self._inputs.driver == self._enable_driver:
            if self._inputs.deflected:
                self._enable_until_s = -math.inf
                self._say(Notice(code="let_go_first"))
            else:
                self._disengaged.end_guiding()
                self._note_until_s = -math.inf
                self._reasons.clear()
                self._steering.enabled = True
                self._loop.enable()

    def _look(self, record: StepRecord) -> None:
        """Deferrable work: ghosts, one stretch of all directions a tick; goals; the loop's statistics."""
        steering = self._steering
        phase = steering.tick % _LOOK_EVERY
        if phase < STRETCHES:
            # Without a reading nobody knows the gripper, which the decoder may look at.
            if not math.isnan(record.state[0]):
                self._ghosts.look(self._step.context(self._readings.q), self._mode_index)
        elif phase == STRETCHES:
            self._move_goals()
        elif steering.tick % _STATISTICS_EVERY == _LOOK_EVERY - 1:
            self._late_share = 1.0 - self._loop.met_share

    def _move_goals(self) -> None:
        move = self._run.move_goals(self._goals, self._readings.q, self._things.believed())
        if move is not None:
            self._step.move_goals(move.goals)
            self._ghosts.goals = move.goals
            if move.anew:
                self._step.forget()

    @property
    def _mode_index(self) -> int:
        return self._setup.mode_index(self._steering.mode, self._steering.axes)

    def _phase(self) -> Phase:
        at_rest = self._step.at_rest
        if self._step.stopped is None:
            return "ready" if at_rest else "moving"
        if not at_rest:
            return "stopping"
        return "neutral_needed" if self._inputs.fresh and self._inputs.deflected else "disengaged"

    def _reason(self, stop: Stop | None) -> Notice | None:
        if stop is None:
            return None
        return self._reasons.get(stop.reason) or notice_of_stop(stop)

    def _report(self, record: StepRecord) -> Report:
        phase, spec = self._phase(), self._setup.spec
        q = self._readings.q
        tool = self._setup.task.robot.chain.forward(q).position.tolist()
        held_back: list[HeldBack] = []
        zone = None
        if phase == "moving":
            limited_by = record.command.limited_by
            held_back = [_HELD_BACK[name] for name in limited_by if name in _HELD_BACK]
            zone = next((name for one in limited_by if (name := zone_of_filter(one)) is not None), None)
        if zone is not None:
            held_back.append("zone")
        return Report(
            nonce=self._inputs.issue_nonce(),
            tick=self._steering.tick,
            time_s=record.time_s,
            driver=self._inputs.driver,
            phase=phase,
            note=self.note if record.time_s < self._note_until_s else None,
            reason=self._disengaged.lost or self._reason(self._step.stopped),
            held_back=held_back[0] if held_back else None,
            zone=zone,
            returning=self._way_back.on,
            bound_for=self._way_back.pose if self._way_back.on else None,
            at_start=self._way_back.away(q) <= AT_START_RAD,
            guiding=self._disengaged.guiding.state,
            lost=self._disengaged.lost is not None,
            let_go_first=self._neutral.waiting,
            idle_left_s=self._idle.left_s,
            mode=self._steering.mode,
            axes=self._steering.axes,
            help=self._steering.help if "assisted" in self._setup.modes else None,
            run=None if spec.run is None else str(spec.run),
            own_task=spec.own_task,
            seed=spec.seed,
            profile=spec.profile,
            loading=self.change is not None,
            q=tuple(q.tolist()),
            reading_age_s=self._readings.age_s(record.time_s),
            tool=(tool[0], tool[1], tool[2]),
            gripper=self._readings.gripper,
            held=tuple(box.name for box in self._things.held.now),
            task=self._run.state,
            things=self._things.look(self._steering.tick),
            ghosts=self._ghosts.newest(self._mode_index),
            belief=tuple(record.belief.tolist()),
            alpha=record.alpha,
            recording=self._writer.status,
            journal=self._writer.journal,
            late_share=self._late_share,
        )
