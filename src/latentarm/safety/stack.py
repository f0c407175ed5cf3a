"""The filters in order, and the final check after them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.types import FloatArray, Stop
from latentarm.robots.held import holding
from latentarm.robots.kinematics.obstacles import Box
from latentarm.robots.robot import Robot
from latentarm.safety.barriers import past_barriers
from latentarm.safety.body import Body
from latentarm.safety.brake import Brake
from latentarm.safety.config import SafetyConfig
from latentarm.safety.filter import (
    Finite,
    GuardedArm,
    JointVelocity,
    LinkSpeed,
    SafetyFilter,
    Situation,
)
from latentarm.safety.guard import Guard
from latentarm.safety.input_timeout import InputTimeout
from latentarm.safety.limits import Bounds
from latentarm.safety.ramp import Ramp
from latentarm.safety.small import any_nonzero, largest, smallest
from latentarm.safety.zone_speed import ZoneSpeed

_SAME_RAD_S = 1e-9  # velocities closer than this differ by rounding only


@final
@dataclass(frozen=True, slots=True)
class Passed:
    """The command that leaves the stack."""

    velocity: FloatArray  # (n,), rad/s
    limited_by: tuple[str, ...] = ()  # names of the filters that changed the request
    stop: Stop | None = None  # why the arm is being stopped, or None


@final
class SafetyStack:
    """Shapes and ramps the requested velocity, and sends it only with a proven stop.

    The output is the first of these that is proven safe: the shaped and ramped velocity; a small step to it;
    an ordinary deceleration; the stop that was proven with the previous command. See `Guard` for the proof.

    Raises UserError where the limits do not suit the robot or the loop's period ``dt_s``, see `Bounds`.
    """

    def __init__(self, config: SafetyConfig, robot: Robot, dt_s: float) -> None:
        self.bounds = bounds = Bounds(config, robot, dt_s)
        self._robot = robot
        self.body = Body(robot)
        self._surroundings = GuardedArm(bounds, self.body)
        self._first: tuple[SafetyFilter, ...] = (Finite(), InputTimeout(), JointVelocity())
        zones = [ZoneSpeed(bounds, index) for index in range(len(config.zones))]
        # Sliding along one thing can speed a joint up.
        self._last: tuple[SafetyFilter, ...] = (JointVelocity(), LinkSpeed(), *zones)
        self._ramp = Ramp(dt_s, bounds.acceleration, bounds.jerk)
        self._release = Ramp(dt_s, bounds.release_acceleration, bounds.release_jerk)
        self._guard = Guard()
        self._rest = np.zeros(robot.dof)
        # The next tick starts from this array, so it must be read-only.
        self._rest.flags.writeable = False
        self._velocity = self._rest
        self._acceleration = self._rest
        self._by_steps = False
        self._brake: Brake | None = None
        self._brake_ticks = 0
        self._brake_began_s = 0.0
        self._now_s = 0.0
        self._reshaping: Iterator[None] = iter(())

    @property
    def at_rest(self) -> bool:
        """Whether the last command was to stand still."""
        return not (any_nonzero(self._velocity) or any_nonzero(self._acceleration))

    @property
    def velocity(self) -> FloatArray:
        """(n,), the last command, rad/s."""
        return self._velocity

    def reset(self) -> None:
        """Start again from an arm at rest."""
        self._velocity = self._acceleration = self._rest
        self._by_steps = False
        self._brake = None

    def hold(self, things: Sequence[Box]) -> None:
        """From the fourth tick on the arm's shape includes these things, see `holding`, and no others.

        A motion that this makes too fast or too near goes on as the stop that was proven before.
        """
        self._reshaping = self._reshaped(things)

    def _reshaped(self, things: Sequence[Box]) -> Iterator[None]:
        """Take on another shape, a part of the work in each tick: 1 ms is too short for all of it."""
        robot = holding(self._robot, things)
        yield
        body = Body(robot)
        yield
        arm = GuardedArm(self.bounds, body)
        yield
        self._surroundings = arm  # which its first command measures

    def tick(self, time_s: float) -> None:
        """Take note of the loop's clock, for a stop that is under way when ticks come late."""
        self._now_s = time_s
        next(self._reshaping, None)

    def command(self, wanted: FloatArray, state: FloatArray, input_age_s: float, pace: float = 1.0) -> Passed:
        """The next command: a velocity that keeps all limits, or a stop that is under way.

        ``wanted`` is any (n,), rad/s; the state (n,), rad, is measured and finite; ``pace`` in [0, 1] is the
        share of the permitted velocity that the arm moves with.
        """
        situation = Situation(self._surroundings, state, self._velocity, self._acceleration, input_age_s)
        limited_by: list[str] = []
        shaped = self._shaped(wanted, situation, limited_by)
        if isinstance(shaped, Stop):
            return Passed(self.stop(), tuple(limited_by), shaped)
        shaped = pace * shaped
        if not any_nonzero(shaped) and self.at_rest:
            self._brake = None
            return Passed(self._rest, tuple(limited_by))
        first = self._ramp if any_nonzero(wanted) and pace > 0.0 else self._release
        more = shaped - self._velocity
        step = more * smallest(self.bounds.one_step / np.maximum(np.abs(more), self.bounds.one_step))
        # The guard foresees what a ramp still adds once it has begun, which may be too much in a slow zone or
        # beside a thing. Steps that are over by the next tick then move the arm until it is fast enough.
        self._by_steps &= any_nonzero(wanted) and largest(np.abs(step - more)) > 0.0
        targets = ((first, shaped), (first, self._velocity + step), (self._ramp, self._rest))
        for ramp, target in targets[self._by_steps :]:
            ramped = ramp.ramped(target, self._velocity, self._acceleration)
            if isinstance(ramped, Stop):
                if self._ramp.name not in limited_by:
                    limited_by.append(self._ramp.name)
                continue
            velocity, acceleration = ramped
            if not any_nonzero(target) and largest(np.abs(velocity)) <= _SAME_RAD_S:
                # Without this, rounding leaves ever smaller motion and the arm never quite rests.
                velocity, acceleration = np.zeros_like(velocity), np.zeros_like(acceleration)
            objection = self._guard.objection(velocity, self.bounds.brake(velocity, acceleration), situation)
            if objection is None:
                velocity.flags.writeable = False
                self._velocity, self._acceleration = velocity, acceleration
                self._brake = None
                if largest(np.abs(velocity - shaped)) > _SAME_RAD_S:
                    limited_by.append(self._ramp.name)
                return Passed(velocity, tuple(limited_by))
            self._by_steps = True
            if objection not in limited_by:
                limited_by.append(objection)
        return Passed(self.stop(), tuple(limited_by))

    def _shaped(self, wanted: FloatArray, situation: Situation, limited_by: list[str]) -> FloatArray | Stop:
        """Through all filters but the ramp; ``limited_by`` gets the names of those that changed something."""
        velocity = self._through(self._first, wanted, situation, limited_by)
        if isinstance(velocity, Stop):
            return velocity
        velocity = past_barriers(velocity, situation, limited_by)
        return self._through(self._last, velocity, situation, limited_by)

    @staticmethod
    def _through(
        filters: tuple[SafetyFilter, ...], velocity: FloatArray, situation: Situation, limited_by: list[str]
    ) -> FloatArray | Stop:
        for safety_filter in filters:
            result = safety_filter.apply(velocity, situation)
            if result is not velocity and safety_filter.name not in limited_by:
                limited_by.append(safety_filter.name)
            if isinstance(result, Stop):
                return result
            velocity = result
        return velocity

    def stop(self) -> FloatArray:
        """Start or continue the proven stop; the next velocity (n,), rad/s.

        It was proven to go on in real time, so a late tick takes up the ramp where it should be by now.
        """
        if self._brake is None:
            self._brake = self.bounds.brake(self._velocity, self._acceleration)
            self._brake_ticks, self._brake_began_s = 0, self._now_s
        self._brake_ticks += 1
        dt_s = self.bounds.dt_s
        braking_s = max(self._brake_ticks * dt_s, self._now_s - self._brake_began_s + dt_s)
        self._velocity, self._acceleration = self._brake.at(braking_s)
        self._velocity.flags.writeable = False
        return self._velocity
