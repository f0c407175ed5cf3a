"""The configured limits resolved for one robot and loop period, as the filters use them."""

import math
from typing import TYPE_CHECKING, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.safety.brake import Brake
from latentarm.safety.obstacles import is_number

if TYPE_CHECKING:
    from latentarm.robots.robot import Robot
    from latentarm.safety.config import SafetyConfig

STOPPED_WITHIN_S = 0.15  # from the last fresh input to a command of zero
LATE_PERIODS = 5  # readings may be late by this many periods of the loop
BUFFER_M = 1e-3  # margin that shaping adds to every distance, so that the guard after it rarely has to act
BUFFER_RAD = 2e-3  # the same for joint positions
MAY_BEND_M = 1e-6  # a command that keeps a distance which is too small already may bend towards it by this, m


def largest_speeds(robot: "Robot", config: "SafetyConfig") -> FloatArray:
    """(n,), rad/s; where a joint slides the speed of links, m/s, or its own if that is less."""
    slower = np.minimum(config.link_speed, robot.limits.velocity)
    return np.where(robot.chain.slide, slower, config.joint_speed)


def margins(robot: "Robot", config: "SafetyConfig") -> FloatArray:
    """(n,), distance that each joint keeps from its limits, rad; m where it slides."""
    margin = np.where(robot.chain.slide, config.slide_margin, config.joint_margin)
    stated = {} if robot.stated_limits is None else robot.stated_limits.joints
    for joint, name in enumerate(robot.joint_names):
        if name in stated and (own := stated[name].margin) is not None:
            margin[joint] = own
    return margin


@final
class Bounds:
    """Limits in joint space of one robot, and the times that follow from them and the loop's period, s.

    Raises UserError where a figure is above what the hardware can do, or stopping takes too long.
    """

    def __init__(self, config: "SafetyConfig", robot: "Robot", dt_s: float) -> None:
        if not is_number(dt_s):
            raise UserError(f"The loop's period must be a number of seconds, not {dt_s!r}.")
        if not (math.isfinite(dt_s) and 0.001 <= dt_s <= 0.05):
            raise UserError(
                f"The loop's period is {dt_s} s: it must be from 0.001 to 0.05 s (1000 to 20 Hz)."
            )
        hardware = robot.limits
        names = robot.joint_names
        slide = robot.chain.slide
        speed = largest_speeds(robot, config)
        for joint in np.flatnonzero(speed > hardware.velocity):
            raise UserError(
                f"The safety limit joint_speed is {speed[joint]:g} rad/s, above the"
                f" {hardware.velocity[joint]:g} rad/s that joint {names[joint]!r} of {robot.name} can do:"
                " set it lower (teleop: --joint-speed)."
            )
        if config.link_speed > robot.tool_speed_limit:
            raise UserError(
                f"The safety limit link_speed is {config.link_speed:g} m/s, above the"
                f" {robot.tool_speed_limit:g} m/s that {robot.name} can do: set it lower (teleop:"
                " --link-speed)."
            )
        for zone in config.zones:
            if zone.speed > config.link_speed:
                raise UserError(
                    f"The zone {zone.name!r} allows {zone.speed:g} m/s, above the {config.link_speed:g} m/s"
                    " that the arm may do anywhere (the safety limit link_speed): set it lower."
                )
        self.config = config
        self.dt_s = dt_s
        self.dof = robot.dof  # n
        self.speed = speed  # (n,), `largest_speeds`
        self.slowest = float(speed.min())  # the smallest of these
        # (n,), lowest joint position, margin taken off, rad
        margin = margins(robot, config)
        self.lower = hardware.lower + margin
        # (n,), highest joint position, margin taken off, rad
        self.upper = hardware.upper - margin
        for joint in np.flatnonzero(self.lower + 2 * BUFFER_RAD >= self.upper):
            unit = "m" if slide[joint] else "rad"
            raise UserError(
                f"The arm keeps {margin[joint]:g} {unit} from its joints' limits, which leaves joint"
                f" {names[joint]!r} of {robot.name} no room between them: state a smaller margin_{unit} of it"
                " in a limits file (--limits)."
            )
        self.positions = np.stack([self.lower, self.upper])  # (2, n), `lower` and `upper` together
        # (n,), for ordinary motion, rad/s²
        self.acceleration = config.acceleration_fraction * hardware.acceleration
        # (n,), the most that ordinary motion may speed up in one period, rad/s
        self.quickening = self.acceleration * dt_s
        self.jerk = config.jerk_fraction * hardware.jerk  # (n,), for ordinary motion, rad/s³
        # (n,), by how much ordinary motion can change a speed and be steady after one period, rad/s
        self.one_step = np.minimum(0.25 * self.jerk * dt_s**2, 0.5 * self.quickening)
        # (n,), once the person has let go, rad/s²
        self.release_acceleration = config.release_fraction * hardware.acceleration
        # (n,), once the person has let go, rad/s³
        self.release_jerk = config.release_fraction * hardware.jerk
        self.stop_acceleration = config.stop_fraction * hardware.acceleration  # (n,), for stops, rad/s²
        self.stop_jerk = config.stop_fraction * hardware.jerk  # (n,), for stops, rad/s³
        self.hold_s = config.command_periods * dt_s  # how long one command lasts, s
        # How far readings may lag behind commands, s
        self.lag_s = config.following_lag_s + LATE_PERIODS * dt_s
        if config.following_window_s < 2.0 * self.lag_s:
            raise UserError(
                f"The safety limit following_window_s is {config.following_window_s:g} s: it must be at least"
                f" {2.0 * self.lag_s:g} s, twice following_lag_s and {LATE_PERIODS} periods of the loop."
            )
        self.stop_s = self._longest_stop_s()  # the longest stop, s
        needed = config.input_timeout_s + dt_s + self.stop_s
        if needed > STOPPED_WITHIN_S:
            raise UserError(
                f"From the last fresh input the command would take {1000 * needed:.0f} ms to reach zero"
                f" (input_timeout_s {1000 * config.input_timeout_s:.0f} ms, one period {1000 * dt_s:.0f} ms,"
                f" stopping {1000 * self.stop_s:.0f} ms), but only {1000 * STOPPED_WITHIN_S:.0f} ms are safe:"
                " lower joint_speed (teleop: --joint-speed; where joints slide, link_speed) or"
                " input_timeout_s, or raise stop_fraction or the rate."
            )
        # How old the newest reading may be, s
        self.reading_timeout_s = min(config.reading_periods * dt_s, STOPPED_WITHIN_S - dt_s - self.stop_s)
        if config.input_timeout_s + config.input_grace_s > STOPPED_WITHIN_S:
            raise UserError(
                f"The safety limits input_timeout_s and input_grace_s are"
                f" {1000 * (config.input_timeout_s + config.input_grace_s):.0f} ms together, but an arm that"
                f" had no fresh input for {1000 * STOPPED_WITHIN_S:.0f} ms must be enabled again: lower one."
            )
        # An upper bound of the distance that a command and its brake cover, over its speed, s
        self.reach_s = self.hold_s + self.stop_s
        # Approach speed per remaining distance; ordinary motion can always slow down this fast
        self.damping_per_s = min(float((self.acceleration / self.speed).min()), 1.0 / self.reach_s)
        # Distance that shaping keeps from obstacles and from the arm itself, m
        self.nearest_m = config.clearance + BUFFER_M
        # A distance that lasts longer than this at the current speed does not limit it, s
        self.horizon_s = 1.0 / self.damping_per_s

    def brake(self, velocity: np.ndarray, acceleration: np.ndarray) -> Brake:
        """The stop from a velocity (n,), rad/s, and an acceleration (n,), rad/s²."""
        return Brake(velocity, acceleration, self.stop_acceleration, self.stop_jerk)

    def _longest_stop_s(self) -> float:
        """Phase two is longest with all joints at full speed, phase one at full deceleration."""
        settle = float((self.stop_acceleration / self.stop_jerk).max())
        return settle + self.brake(self.speed, np.zeros(self.dof)).ramp_s
