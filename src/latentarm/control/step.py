"""Algorithm 1, lines 6 to 10, as one step that every loop, simulation and page goes through."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import final

import numpy as np

from latentarm.assistance.assistance import Assistance
from latentarm.assistance.belief import Belief
from latentarm.assistance.controllers.contract import Controller
from latentarm.control.engagement import Engagement
from latentarm.control.shared_autonomy import SharedAutonomy
from latentarm.core.call_log import CallLog, logged
from latentarm.core.errors import UserError
from latentarm.core.types import (
    NO_GRIPPER,
    NO_OBJECTS,
    Command,
    Context,
    FloatArray,
    Goal,
    GripperAsk,
    Input,
    Reading,
    StepRecord,
    Stop,
)
from latentarm.robots.kinematics.obstacles import Box
from latentarm.robots.robot import Robot
from latentarm.safety.config import SafetyConfig
from latentarm.safety.gripper import GripperFilter
from latentarm.safety.input_timeout import InputTimeout
from latentarm.safety.newest_reading import NewestReading
from latentarm.safety.plausibility import FOLLOWING_ERRORS, Plausibility
from latentarm.safety.stack import Passed, SafetyStack
from latentarm.safety.timekeeping import Timekeeping
from latentarm.safety.tool_force import FORCE, ToolForce
from latentarm.safety.yielding import YIELDING, Yielding

_ABSURD = 2.0
"""Inputs slightly above 1 come from a stick's corners and are clipped; above this the interface is broken."""

_ASTRAY = 2.0 * math.pi  # a reading this far outside the limits is wrong, rad
STEADY_S = 1.0  # after a jump, readings must be steady for this long before the arm can be enabled, s

_MISSHAPEN = Stop(
    "The controller gave a latent action or an action of the wrong size.", code="controller_invalid"
)

_FALTERING = (InputTimeout.name,)  # the limit of an arm whose inputs are missing for a moment


@final
class Step:
    """From the person's input to a safe command, once per period.

    Lines of Algorithm 1: ``z = f(u, c)``, ``a_h = phi(z, c)``, ``a_r`` and how it joins ``a_h`` by the
    `Assistance` (in the paper ``a_r = Σ b(g) (g - s)`` and ``a = (1 - alpha) a_h + alpha a_r``), and the
    belief's update for the next step. The action then passes the `SafetyStack`; nothing else moves the arm.

    The arm starts disengaged. After a neutral input, `enable` engages it. Every stop (by the operator, an
    input that is too old, a number that is not one, a reading of the joints that is too old or
    cannot be true, a force at the tool, a controller that fails) disengages it again: a ramped stop, then
    neutral, then `enable`::

        step.reset(arm.read().q)
        step(neutral, 0.0, arm.read(), now)
        step.enable()

    After a stop by a force, or by a following error that looks like contact, the arm draws back a little
    before it rests: the one motion without a fresh input, see `ToolForce` and `Yielding`. `stop`, `enable`
    and any other reason to stop end it.

    Requests to the gripper pass a filter of their own (see `GripperFilter`), whether they come from the
    person who drives, one who guides the arm by hand, or one who holds down the opening button. An arm that
    stops drops nothing, and requests and beliefs from before a stop count for nothing after it.

    A second person's pace scales the permitted motion of the arm and the gripper alike; a stop is as fast as
    ever.

    An input within the dead zone means no motion, whatever the decoder returns for zero, and no help, unless
    the assistance acts at rest. An enabled arm then moves by itself while inputs are fresh.
    No input of any kind and no failing controller raises an exception here. Controllers and observers get
    read-only arrays, because the safety filters use the same ones.

    Controllers see the joints as they were measured, and so does the record: NaN where a reading could not be
    used. The safety filters see the same, except that a joint whose reading repeats counts as moved as
    commanded since (see `Plausibility.estimate`).

    A clock that stands still, goes back, or jumps farther than a command lasts stops the arm without a ramp:
    nobody can know how long the last command was in force.

    Args:
        robot: the arm.
        controller: turns inputs into actions.
        safety: the limits.
        goals: the discrete goals ``G``, for assistance.
        belief: how inputs change the belief over goals; None keeps the belief uniform.
        assistance: how the robot helps; None never helps.
        dt_s: the loop's period, s.
        surroundings: gives the poses (K, 9) of the controller's `objects` at this moment, see
            `Context.objects`; for controllers that look at any.
        calls: where every call that changes anything is recorded; None for nowhere.
        follows: whether the arm carries out the commands. If not, its readings say nothing of them, and are
            not compared with them.

    Raises:
        UserError: the limits do not suit the robot or the period, assistance lacks goals, or the controller
            looks at things and nothing tells where they are.
    """

    def __init__(
        self,
        robot: Robot,
        controller: Controller,
        safety: SafetyConfig,
        goals: Sequence[Goal] = (),
        belief: Belief | None = None,
        assistance: Assistance | None = None,
        dt_s: float = 0.01,
        surroundings: Callable[[], FloatArray] | None = None,
        calls: CallLog | None = None,
        follows: bool = True,
    ) -> None:
        if controller.objects and surroundings is None:
            raise UserError(
                f"The controller looks at the poses of {', '.join(controller.objects)}, and nothing tells"
                " where these are: drive it at a task that has them."
            )
        self.calls = calls
        self._surroundings = surroundings if calls is None else calls.watched(surroundings)
        self._shared = SharedAutonomy(robot.dof, controller, goals, belief, assistance, dt_s)
        self._robot = robot
        self._dof = robot.dof
        self._follows = follows
        self._lowest = (robot.limits.lower - _ASTRAY).tolist()
        self._highest = (robot.limits.upper + _ASTRAY).tolist()
        self._controller = controller
        self._stack = SafetyStack(safety, robot, dt_s)
        self._config = safety
        self._plausibility = Plausibility(self._stack.bounds, robot)
        self._yielding = Yielding(self._stack.bounds, self._stack.body)
        self._force = ToolForce(robot, safety.tool_force)
        self._hold_s = self._stack.bounds.hold_s
        self._timekeeping = Timekeeping(self._hold_s)
        self._newest_reading = NewestReading(self._stack.bounds.reading_timeout_s, self._hold_s)
        self._time_s = self._steady_s = -math.inf
        self._unreadable = _sealed(np.full(robot.dof, math.nan))
        self._no_motion = _sealed(np.zeros(robot.dof))
        self._no_input = _sealed(np.zeros(controller.input_dim))
        self._engagement = Engagement()
        self._gripper = GripperFilter(robot.gripper, safety)
        self._faltering = False
        self._opens: bool | None = None
        self._pace = 1.0
        self._mode = 0
        self._switch_held = False

    @property
    def robot(self) -> Robot:
        """The arm that the step commands."""
        return self._robot

    @property
    def follows(self) -> bool:
        """True for an arm that carries out the commands."""
        return self._follows

    @property
    def dt_s(self) -> float:
        """The loop's period, s."""
        return self._stack.bounds.dt_s

    @property
    def hold_s(self) -> float:
        """How long each command lasts, s; without a new one the arm stops by itself."""
        return self._hold_s

    @property
    def at_rest(self) -> bool:
        """Whether the last command was to stand still, and the arm is not about to draw back."""
        return self._stack.at_rest and not self.yielding

    @property
    def yielding(self) -> bool:
        """Whether the arm draws back from an obstacle, or is watched to decide whether it should."""
        return self._yielding.on

    @property
    def dead_zone(self) -> float:
        """Length of an input up to which it is neutral."""
        return self._config.dead_zone

    @property
    def joint_speed(self) -> FloatArray:
        """(n,), how fast each joint may move at most, rad/s."""
        return self._stack.bounds.speed

    @property
    def safety(self) -> SafetyConfig:
        """The limits."""
        return self._config

    @property
    def mode(self) -> int:
        """Index of the controller's mode."""
        return self._mode

    @property
    def belief(self) -> FloatArray:
        """(G,), the belief that the next step will use."""
        return self._shared.belief

    @property
    def stopped(self) -> Stop | None:
        """Why the arm may not move, or None where it may."""
        return self._engagement.stopped

    def context(self, state: FloatArray) -> Context:
        """The controllers' context in a state (n,), rad, with the belief that the next step will use."""
        measured, target_m = self._gripper.reading, self._gripper.target_m
        gripper = NO_GRIPPER if measured is None else np.array([measured.width_m])
        target = NO_GRIPPER if target_m is None else np.array([target_m])
        objects = NO_OBJECTS if self._surroundings is None else self._surroundings()
        return Context(state, self._shared.belief, gripper, objects, target)

    @logged
    def reset(self, state: FloatArray) -> None:
        """Begin a new episode from an arm that stands still: disengaged, first mode, first belief.

        Args:
            state: (n,), measured joint positions, rad.

        Raises:
            UserError: the state is not n numbers near the joints' limits.
        """
        if self._joint_positions(state) is None:
            raise UserError(f"A state of this arm is {self._dof} joint positions near their limits.")
        self._stack.reset()
        self._plausibility.reset()
        self._yielding.end()
        self._force.reset()
        self._timekeeping.reset()
        self._newest_reading.reset()
        self._gripper.reset()
        self._time_s = self._steady_s = -math.inf
        self._engagement = Engagement()
        self._mode = 0
        self._switch_held = False
        self._shared.reset()

    @logged
    def enable(self) -> Stop | None:
        """Let the arm move, if the newest input was neutral and the readings are steady; why not, or None."""
        if self._time_s < self._steady_s:
            return Stop(
                "The joint readings jumped a moment ago: check the arm, then enable it.",
                code="readings_unsteady",
            )
        refused = self._engagement.enable()
        if refused is None:
            self._yielding.end()
            self._force.reset()
        return refused

    @logged
    def sent(self, time_s: float) -> None:
        """Set when the last command was sent, by the loop's clock, s; later than its tick began."""
        self._timekeeping.sent(time_s)

    @logged
    def choose_mode(self, mode: int) -> None:
        """Switch to the mode of this index from the next step on; the current motion is ramped over to it.

        Raises:
            UserError: the controller has no such mode.
        """
        if not 0 <= mode < len(self._controller.modes):
            raise UserError(f"The controller has modes 0 to {len(self._controller.modes) - 1}, not {mode}.")
        self._mode = mode

    @logged
    def stop(self, reason: str) -> None:
        """Stop the arm from the next step on; ``reason`` is one short sentence for the person."""
        self._engagement.stop(Stop(reason))
        self._yielding.end()

    @logged
    def refuse(self, stop: Stop) -> None:
        """Keep the arm disengaged for this reason, in place of any earlier one."""
        self._engagement.replace(stop)
        self._yielding.end()

    @logged
    def halted(self, stop: Stop) -> None:
        """Record that a command ran out and the arm stopped by itself; stay stopped."""
        self._engagement.stop(stop)
        self._stack.reset()
        self._yielding.end()

    @logged
    def forget(self) -> None:
        """Return to the first belief: a motion that nobody steered, or a step that is done, says nothing."""
        self._shared.reset()

    @logged
    def move_goals(self, goals: FloatArray) -> None:
        """From the next step on, the goals' configurations are these, (G, n), rad.

        Things move, and so does what a person wants with them. The belief in each goal stays, see `forget`.

        Raises:
            UserError: these are not as many configurations as there are goals, or they are not finite.
        """
        if goals.shape != (len(self._shared.belief), self._dof) or not np.isfinite(goals).all():
            raise UserError(f"Goals that moved must be {len(self._shared.belief)} finite configurations.")
        self._shared.move_goals(goals)

    @logged
    def hold(self, *things: Box) -> None:
        """From the fourth step on these are parts of the arm; boxes in the frame of its first tool.

        They may be put down on what is level. What is too near or too fast already may leave, see `Guard`.
        """
        self._stack.hold(things)

    @logged
    def guided(self, ask: GripperAsk | None) -> None:
        """In the next step the gripper follows a person who guides the disengaged arm; None asks nothing new.

        Call this before each step as long as the arm is guided; moving fingers stop when it no longer is.
        """
        self._gripper.guided(ask)

    @logged
    def __call__(self, given: Input, input_age_s: float, reading: Reading, time_s: float) -> StepRecord:
        """One pass through Algorithm 1.

        Args:
            given: the person's newest input.
            input_age_s: for how long it has been the newest, by the loop's own clock, s.
            reading: the arm's newest.
            time_s: the loop's clock, s.

        Returns:
            The readings and decisions; its command is for the arm.
        """
        if (lost := self._timekeeping.refusal(time_s)) is not None:
            self._plausibility.reset()
            self.halted(lost)
        self._time_s = time_s
        self._faltering, self._opens, self._pace, self._delay_s = False, None, 1.0, math.nan
        self._stack.tick(time_s)
        self._gripper.tick()
        q = self._positions_now(reading, time_s)
        if isinstance(q, Stop):
            self._engagement.stop(q)
            self._yielding.end()
            return self._record(time_s, self._unreadable, Passed(self._stack.stop()))
        self._yielding.saw(q, self._stack.velocity, pressing=self._force.pressing)
        if self._doubts(q, time_s, new=self._newest_reading.new):
            return self._record(time_s, q, Passed(self._stack.stop()))
        if self._follows and self._engagement.stopped is None:
            pressed = self._force.refusal(q, self._stack.velocity)
            if pressed is not None:
                self._yielding.felt()
                return self._record(time_s, q, self._refused(pressed))
        if self._falters(input_age_s):
            self._faltering = True
            return self._record(time_s, q, Passed(self._stack.stop(), _FALTERING))
        u = self._usable(given, input_age_s)
        if isinstance(u, Stop):
            self._engagement.stop(u)
            return self._record(time_s, q, self._stopping(q))
        self._pace, self._delay_s = float(given.pace), given.delay_s
        # After a jump of the clock nobody knows for how long it has been held.
        self._opens = bool(given.opens) and lost is None
        neutral = u is self._no_input
        self._engagement.saw(neutral)
        self._switch(bool(given.switch_mode))
        self._gripper.ask(given.gripper, engaged=self._engagement.stopped is None)
        if self._engagement.stopped is not None:
            return self._record(time_s, q, self._stopping(q))
        if neutral and not self._shared.acts_at_rest:
            return self._record(time_s, q, self._passed(self._no_motion, q, input_age_s))
        return self._driven(u, input_age_s, q, time_s)

    def _doubts(self, q: FloatArray, time_s: float, *, new: bool) -> bool:
        """Whether a reading cannot be true; the arm is disengaged for it."""
        jumped = self._plausibility.jump(q, time_s)
        driven = self._follows and jumped is None and self._engagement.stopped is None
        astray = self._plausibility.follow(q, self._stack.velocity, time_s, new=new, driven=driven)
        if jumped is not None:
            # Reported even if the arm is already disengaged: nobody may enable it without knowing.
            self._steady_s = time_s + STEADY_S
            self._engagement.replace(jumped)
            self._yielding.end()
        elif astray is not None:
            self._engagement.stop(astray)
            if astray.code in FOLLOWING_ERRORS:
                self._yielding.begin()
        return jumped is not None or astray is not None

    def _falters(self, age_s: float) -> bool:
        """Whether fresh inputs are missing, but not for long enough to disengage the arm."""
        timeout_s = self._config.input_timeout_s
        try:
            late = timeout_s < age_s <= timeout_s + self._config.input_grace_s
            return bool(late) and self._engagement.stopped is None
        except Exception:  # noqa: BLE001 - an age that is no number is refused further on
            return False

    def _driven(self, u: FloatArray, input_age_s: float, q: FloatArray, time_s: float) -> StepRecord:
        """Lines 6 to 10 for an input that asks for motion, or at rest if the robot helps there too."""
        shared = self._shared
        try:
            context = self.context(q)
            # What overflows here is caught as not finite below.
            with np.errstate(all="ignore"):
                choices = shared.update(u, context, self._mode)
                # A person who lets go commands no motion, whatever the decoder makes of zero.
                z, a_h = (u, self._no_motion) if u is self._no_input else choices.chosen(u)
                if z.shape != u.shape or a_h.shape != q.shape:
                    return self._record(time_s, q, self._refused(_MISSHAPEN), u)
                help_ = shared.help(u, a_h, context)
                bound_rad = shared.bound(help_, context, self._mode)
                wanted = help_.with_person(a_h)
                eased = self._force.eased(q, wanted)
        except Exception as error:  # noqa: BLE001 - whatever a controller does wrong, the arm stops
            text = _message_of(error)
            stop = Stop(
                f"The controller failed ({text}).", code="controller_failed", parameters={"text": text}
            )
            return self._record(time_s, q, self._refused(stop), u)
        passed = self._passed(eased, q, input_age_s)
        if eased is not wanted:
            passed = replace(passed, limited_by=(FORCE, *passed.limited_by))
        command = self._command(passed)
        return StepRecord(
            time_s=time_s,
            state=q,
            input=u,
            latent=z,
            action_human=a_h,
            action_assist=help_.action,
            alpha=help_.alpha,
            belief=context.belief,
            mode=self._mode,
            command=command,
            bound_rad=bound_rad,
            gripper=self._gripper.reading,
            pace=self._pace,
            delay_s=self._delay_s,
            added=help_.added,
        )

    def _passed(self, wanted: FloatArray, q: FloatArray, input_age_s: float) -> Passed:
        """Through the safety stack; a refusal disengages."""
        passed = self._stack.command(wanted, self._plausibility.estimate(q), input_age_s, self._pace)
        if passed.stop is not None:
            self._engagement.stop(passed.stop)
        return passed

    def _stopping(self, q: FloatArray) -> Passed:
        """The stop that is under way; after a following error or a force the arm then yields."""
        back = self._yielding.wanted(q)
        if back is None:
            return Passed(self._stack.stop())
        if self._force.refusal(q, back) is not None:
            self._yielding.end()
            return Passed(self._stack.stop())
        passed = self._stack.command(back, self._plausibility.estimate(q), 0.0)
        if passed.stop is not None:
            self._yielding.end()
        return Passed(passed.velocity, (*passed.limited_by, YIELDING))

    def _refused(self, stop: Stop) -> Passed:
        self._engagement.stop(stop)
        return Passed(self._stack.stop())

    def _usable(self, given: Input, input_age_s: float) -> FloatArray | Stop:
        """The input as (d,) floats in [-1, 1], zero within the dead zone, or why it cannot be used."""
        try:
            stale = InputTimeout.refusal(input_age_s, self._config.input_timeout_s)
            if stale is not None:
                return stale
            u = np.asarray(given.u)
            bool(given.switch_mode)
            bool(given.opens)
            if not 0.0 <= float(given.pace) <= 1.0:
                return _invalid("The input's pace is outside [0, 1].")
            if not self._gripper.known(given.gripper):
                return _invalid("The input asks the gripper for something that it cannot do.")
        except Exception as error:  # noqa: BLE001 - a ragged list, None, whatever an interface gives
            return _invalid(f"The input cannot be read ({_message_of(error)}).")
        if u.shape != self._no_input.shape or u.dtype.kind not in "iuf":
            return _invalid(f"The input must be {len(self._no_input)} numbers.")
        values = [float(value) for value in u.tolist()]
        # Written so that a value that is not a number fails too.
        if not all(abs(value) <= _ABSURD for value in values):
            return _invalid("The input is outside [-1, 1].")
        if math.hypot(*values) <= self._config.dead_zone:
            return self._no_input
        return _sealed(np.array([min(max(value, -1.0), 1.0) for value in values]))

    def _positions_now(self, reading: Reading, time_s: float) -> FloatArray | Stop:
        """The joint positions of a reading that is new enough, or why they cannot be used."""
        try:
            refused = (
                self._newest_reading.refusal(reading, time_s)
                or self._gripper.saw(reading.gripper)
                or self._force.saw(reading.external_torque)
            )
        except Exception as error:  # noqa: BLE001 - whatever a driver gives
            reason = f"The arm's reading cannot be used ({_message_of(error)})."
            refused = Stop(reason, untrusted=True, code="reading_invalid")
        if refused is not None:
            return refused
        q = self._joint_positions(reading.q)
        if q is None:
            return Stop(
                "The arm's joint positions are not numbers near its limits.",
                untrusted=True,
                code="joints_invalid",
            )
        return q

    def _joint_positions(self, state: FloatArray) -> FloatArray | None:
        """The state as a private copy of (n,) floats, or None where it is not that."""
        try:
            q = np.asarray(state)
        except Exception:  # noqa: BLE001 - a ragged list, whatever a driver gives
            return None
        if q.shape != (self._dof,) or q.dtype.kind not in "iuf":
            return None
        # Written so that a value that is not a number fails too.
        for low, value, high in zip(self._lowest, q.tolist(), self._highest, strict=True):
            if not low <= value <= high:
                return None
        return _sealed(q.astype(np.float64))

    def _switch(self, wanted: bool) -> None:
        """Advance the mode when the switch is pressed; holding it has no further effect."""
        if wanted and not self._switch_held:
            self._mode = (self._mode + 1) % len(self._controller.modes)
        self._switch_held = wanted

    def _command(self, passed: Passed) -> Command:
        stopped = self._engagement.stopped
        pace = 0.0 if self._faltering else self._pace
        gripper = self._gripper.command(self._time_s, pace, engaged=stopped is None, opens=self._opens)
        return Command(passed.velocity, self._hold_s, stopped, passed.limited_by, gripper)

    def _record(
        self, time_s: float, q: FloatArray, passed: Passed, u: FloatArray | None = None
    ) -> StepRecord:
        """A step without motion wanted."""
        self._shared.rest()
        if self._engagement.stopped is not None:
            # What somebody wanted before a stop says nothing of the first push after it.
            self._shared.reset()
        return StepRecord(
            time_s=time_s,
            state=q,
            input=self._no_input if u is None else u,
            latent=self._no_input,
            action_human=self._no_motion,
            action_assist=self._no_motion,
            alpha=0.0,
            belief=self._shared.belief,
            mode=self._mode,
            command=self._command(passed),
            gripper=self._gripper.reading,
            pace=self._pace,
            delay_s=self._delay_s,
        )


def _sealed(array: FloatArray) -> FloatArray:
    """The array itself, closed to writing."""
    array.flags.writeable = False
    return array


def _invalid(reason: str) -> Stop:
    """An input that cannot be used, for this reason."""
    return Stop(reason, code="input_invalid")


def _message_of(error: Exception) -> str:
    """The message of an error, if it has one."""
    try:
        return f"{type(error).__name__}: {error}"
    except Exception:  # noqa: BLE001 - an error that cannot even be printed
        return type(error).__name__
