"""Between the control loop and the page: inputs in, orders carried out, reports out."""

import math
from collections.abc import Callable
from typing import Final, final

import numpy as np

from latentarm.arms.contract import Arm
from latentarm.control.clock import Clock
from latentarm.control.input_port import InputPort, InputSource
from latentarm.control.loop import ControlLoop
from latentarm.control.recorder import EpisodeHeader
from latentarm.control.step import Step
from latentarm.demonstrations.provenance import provenance_now
from latentarm.types import Context, Input, StepRecord
from latentarm.web.arm_process.drive_setup import INPUT_TIMEOUT_S, PERIOD_S, Setting
from latentarm.web.arm_process.ghosts import GhostPaths
from latentarm.web.arm_process.reasons import why
from latentarm.web.arm_process.recording import EpisodeWriter
from latentarm.web.protocol.channel import (
    Channel,
    ChooseMode,
    ChooseProfile,
    ChooseRun,
    Enable,
    Given,
    ModeName,
    Order,
    Phase,
    Record,
    Report,
    Reset,
    parse_given,
)

LATCH_MAX_S: Final = 10.0
"""For how long an input that nobody holds goes on, s."""

ENABLE_WAITS_S: Final = 0.3
"""For how long an order to enable waits for a fresh neutral input, s."""

NOTE_S: Final = 6.0
"""For how long a refusal is shown instead of what the arm does, s."""

Change = ChooseProfile | ChooseRun | Reset
"""What the loop is ended for, to go on otherwise."""

_ORDERS_PER_TICK: Final = 4
_LOOK_EVERY: Final = 10
_STATISTICS_EVERY: Final = 100
_SPARE_S: Final = 0.004
"""What can wait is done in a tick only where this much of it is left."""


@final
class Cockpit(InputSource):
    """What the control loop's own thread does besides driving; a few hundred microseconds a tick.

    Stops are looked at in every tick, however full the pipe of orders is.

    Args:
        setting: what is driven.
        channel: to the page's server.
        clock: the loop's.
        writer: records.
        orphaned: whether the page's server is gone.
    """

    def __init__(
        self,
        setting: Setting,
        channel: Channel,
        clock: Clock,
        writer: EpisodeWriter,
        orphaned: Callable[[], bool],
    ) -> None:
        self._setting = setting
        self._channel = channel
        self._clock = clock
        self._writer = writer
        self._orphaned = orphaned
        self._ghosts = GhostPaths(setting)
        self._port = InputPort(setting.controller.input_dim, clock)
        self._driver = -1
        self._given_version = channel.given.version
        self._stop_version = channel.stop.version
        self._latched_since_s = math.inf
        self._deflected = self._fresh = False
        self._enable_until_s = -math.inf
        self._enable_driver = -1
        self._mode: ModeName = setting.modes[0]
        self._axes = 0
        self._tick = 0
        self._seen = setting.start
        self._late_share = self._late_p99_ms = 0.0
        self._ending_episode = False
        self._devices: set[str] = set()
        self._note = ""
        self._note_until_s = -math.inf
        self._change: Change | None = None

    @property
    def change(self) -> Change | None:
        """What the loop was ended for, to go on otherwise; None where it was ended for good."""
        return self._change

    def take_seat(self, loop: ControlLoop, step: Step, arm: Arm, setting: Setting, note: str) -> None:
        """Begin with a new loop.

        Args:
            loop: that calls this.
            step: of the loop.
            arm: of the loop.
            setting: what is driven now.
            note: what the person is told first; "" for nothing.
        """
        self._loop, self._step, self._arm = loop, step, arm
        if setting.spec.run != self._setting.spec.run:
            self._mode, self._axes = setting.modes[0], 0
            self._port = InputPort(setting.controller.input_dim, self._clock)
        self._seen = setting.start
        if setting is not self._setting:
            self._setting, self._ghosts = setting, GhostPaths(setting)
        self._change = None
        self._enable_until_s = self._note_until_s = -math.inf
        if note:
            self._say(note)
        self._choose(self._mode, self._axes)

    def latest(self, now_s: float) -> tuple[Input, float]:
        """See the base class."""
        if self._channel.given.version != self._given_version:
            self._take_input()
        given, age_s = self._port.latest(now_s)
        self._fresh = age_s <= INPUT_TIMEOUT_S
        if now_s - self._latched_since_s > LATCH_MAX_S:
            self._latched_since_s = math.inf
            self._stop(f"Latched motion ends after {LATCH_MAX_S:.0f} s.")
        return given, age_s

    def observe(self, record: StepRecord) -> None:
        """Called by the loop after every command."""
        self._tick += 1
        if not math.isnan(record.state[0]):
            self._seen = record.state
        self._writer.add(record)
        if self._ending_episode and self._step.at_rest:
            self._end_episode()
        self._obey(record)
        self._enable_if_asked(record.time_s)
        self._channel.report.write(self._report(record).model_dump_json().encode())
        if self._clock.now_s() + _SPARE_S < record.time_s + PERIOD_S:
            self._look(record)

    def _take_input(self) -> None:
        found = self._channel.given.read()
        if found is None:
            return
        self._given_version, message = found
        given = parse_given(message)
        if given is None or len(given.u) != self._setting.controller.input_dim:
            return
        if given.driver != self._driver:
            self._change_driver(given.driver)
        if self._port.offer(Input(np.array(given.u)), given.nonce, given.seq):
            self._watch_latch(given)

    def _change_driver(self, driver: int) -> None:
        self._driver = driver
        self._port = InputPort(self._setting.controller.input_dim, self._clock)
        self._latched_since_s = math.inf
        if self._step.stopped is None:
            self._stop("Somebody else drives now.")

    def _watch_latch(self, given: Given) -> None:
        self._deflected = math.hypot(*given.u) > self._step.dead_zone
        if self._deflected and given.source:
            self._devices.add(given.source)
        if not (given.latched and self._deflected):
            self._latched_since_s = math.inf
        elif self._latched_since_s == math.inf:
            self._latched_since_s = self._clock.now_s()

    def _obey(self, record: StepRecord) -> None:
        if self._channel.stop.version != self._stop_version:
            # Whatever it says, and also while it is half-written: something was said.
            self._stop_version = self._channel.stop.version
            reason = self._channel.stop.read()
            self._stop("Stop was pressed." if reason is None else reason[1].decode(errors="replace"))
        if self._channel.ending.count or self._orphaned():
            self._loop.finish()
        try:
            for order in self._channel.read_orders(_ORDERS_PER_TICK):
                self._carry_out(order, record)
        except EOFError:
            self._loop.finish()

    def _stop(self, reason: str) -> None:
        self._enable_until_s = self._note_until_s = -math.inf
        self._loop.stop(reason)

    def _say(self, note: str) -> None:
        self._note = note
        self._note_until_s = self._clock.now_s() + NOTE_S

    def _carry_out(self, order: Order, record: StepRecord) -> None:
        match order:
            case Enable(driver=driver, stops=stops):
                # One that was pressed before the newest Stop counts for nothing, whichever arrives first.
                if stops == self._stop_version:
                    self._enable_driver = driver
                    self._enable_until_s = record.time_s + ENABLE_WAITS_S
            case ChooseMode(mode=mode, axes=axes):
                if mode in self._setting.modes:
                    self._choose(mode, self._axes if axes is None else axes)
            case Record(on=True, task=task, person=person):
                self._begin_episode(task, person)
            case Record():
                # An episode ends with the arm at rest: its last motion belongs to it.
                self._ending_episode = True
            case ChooseProfile(name=name) if name == self._setting.spec.profile:
                pass
            case ChooseProfile() | ChooseRun() | Reset():
                self._change_to(order)

    def _change_to(self, change: Change) -> None:
        """End the loop for it, where the arm stands disengaged."""
        if self._step.stopped is None or not self._step.at_rest:
            self._say("Stop the arm first.")
            return
        if not isinstance(change, ChooseProfile):
            # An episode is one motion of one arm: it ends before the arm is put somewhere else.
            self._end_episode()
        self._change = change
        self._loop.finish()

    def _choose(self, mode: ModeName, axes: int) -> None:
        self._mode = mode
        self._axes = min(max(axes, 0), len(self._setting.axes) - 1)
        self._setting.help.on = mode == "assisted"
        self._step.choose_mode(self._setting.mode_index(mode, self._axes))

    def _begin_episode(self, task: str, person: str) -> None:
        self._ending_episode = False
        if not self._writer.on:
            self._devices.clear()
        robot, spec = self._setting.task.robot, self._setting.spec
        self._writer.begin(
            EpisodeHeader(
                robot=robot.name,
                joint_names=robot.joint_names,
                joint_limits=robot.limits,
                rate_hz=1.0 / PERIOD_S,
                task=task,
                goals=self._setting.task.goals,
                modes=self._setting.controller.modes,
                provenance=provenance_now(
                    person=person,
                    run="" if spec.run is None else spec.run.name,
                    run_fingerprint=self._setting.run_fingerprint,
                    profile=spec.profile or "",
                    controller=self._mode,
                ),
                end_effector=robot.end_effector,
                limits=robot.stated_limits,
            )
        )

    def _end_episode(self) -> None:
        self._writer.end(", ".join(sorted(self._devices)))
        self._ending_episode = False

    def _enable_if_asked(self, now_s: float) -> None:
        """Once a fresh neutral input is there; the loop itself has the last word."""
        if now_s > self._enable_until_s:
            return
        if self._step.stopped is None:
            self._enable_until_s = -math.inf
        elif self._fresh and self._driver == self._enable_driver:
            if self._deflected:
                self._enable_until_s = -math.inf
                self._say("Let go of the stick first, then press Enable.")
            else:
                self._note_until_s = -math.inf
                self._loop.enable()

    def _look(self, record: StepRecord) -> None:
        """What can wait: ghosts, one direction a tick, and the loop's own figures."""
        phase = self._tick % _LOOK_EVERY
        if phase < 4:
            self._ghosts.look(phase, Context(self._seen, record.belief), record.mode)
        elif self._tick % _STATISTICS_EVERY == _LOOK_EVERY - 1:
            statistics = self._loop.statistics()
            self._late_share = 1.0 - statistics.met_share
            self._late_p99_ms = 1000.0 * statistics.p99_s

    def _phase(self) -> Phase:
        at_rest = self._step.at_rest
        if self._step.stopped is None:
            return "ready" if at_rest else "moving"
        if not at_rest:
            return "stopping"
        return "neutral_needed" if self._fresh and self._deflected else "disengaged"

    def _why(self, phase: Phase, record: StepRecord) -> str:
        if record.time_s < self._note_until_s:
            return self._note
        return why(phase, self._step.stopped, record.command.limited_by)

    def _report(self, record: StepRecord) -> Report:
        phase = self._phase()
        tool = self._setting.task.robot.chain.forward(self._seen).position.tolist()
        return Report(
            nonce=self._port.issue_nonce(),
            tick=self._tick,
            time_s=record.time_s,
            driver=self._driver,
            phase=phase,
            why=self._why(phase, record),
            mode=self._mode,
            axes=self._axes,
            run=None if self._setting.spec.run is None else str(self._setting.spec.run),
            profile=self._setting.spec.profile,
            loading=self._change is not None,
            q=tuple(self._seen.tolist()),
            speed=float(np.abs(self._arm.velocity()).max()),
            tool=(tool[0], tool[1], tool[2]),
            ghosts=self._ghosts.newest,
            belief=tuple(record.belief.tolist()),
            alpha=record.alpha,
            bound_rad=None if math.isnan(record.bound_rad) else record.bound_rad,
            recording=self._writer.status,
            late_share=self._late_share,
            late_p99_ms=self._late_p99_ms,
        )
