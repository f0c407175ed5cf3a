"""Facts about an arm before it is driven, and reasons to refuse it."""

import math
import time
from typing import Final

import numpy as np

from latentarm.arms.own_limits import beyond
from latentarm.arms.own_pose import OwnPose, compared, kind_misfit, misfits
from latentarm.arms.real import Fact, Findings
from latentarm.arms.xarm.controller import ANSWER_S
from latentarm.arms.xarm.identity import BOUNDED_COMMANDS, GRIPPER_PORT, Identity
from latentarm.arms.xarm.model import own_limits, own_poses
from latentarm.arms.xarm.sdk import Sdk
from latentarm.arms.xarm.session import Session
from latentarm.arms.xarm.words import EMERGENCY_STOPS, controller_error, emergency_stop
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.robot import Robot

_SLOW_S: Final = 0.02  # an arm with a longer median answer cannot be driven at 50 Hz
_OUTSIDE_RAD: Final = 0.1
_APART_RAD: Final = 0.02
_RATE_OVER_S: Final = 0.1
_LOOKS: Final = 5  # for reports, as a busy computer may be late itself
_SINGLE: Final = 1e-3  # rounding of the controller's figures, in single precision, mm or rad


def basic_facts(identity: Identity) -> tuple[Fact, ...]:
    """Known facts of an arm that is `too_different`."""
    return (Fact("arm", identity.name), Fact("firmware", identity.version))


def too_different(identity: Identity, robot: Robot) -> tuple[str, ...]:
    """Reasons to refuse an arm in any state."""
    refusals: list[str] = []
    if identity.firmware < BOUNDED_COMMANDS:
        refusals.append(
            f"The controller's firmware {identity.version} drops the duration of a command, so the arm"
            " would not stop by itself: update it in UFACTORY Studio to 1.8.0 or newer, best 2.1 or newer."
        )
    if identity.axes is not None and identity.axes != robot.dof:
        refusals.append(
            f"The arm is an {identity.name} with {identity.axes} joints, and {robot.name} has {robot.dof}:"
            " choose the robot that the arm is."
        )
    if identity.axes == robot.dof:
        refusals += kind_misfit(identity.name, robot)
    if robot.gripper is not None and BOUNDED_COMMANDS <= identity.firmware < GRIPPER_PORT:
        refusals.append(
            f"With firmware {identity.version} the gripper would hold up the arm's commands: update it in"
            " UFACTORY Studio to 1.11.0 or newer."
        )
    return tuple(refusals)


def find_out(sdk: Sdk, session: Session, robot: Robot, *, bare: bool) -> Findings:
    """Inspect a connected arm that is not `too_different`; ``bare`` states that it carries nothing.

    Raises LinkLostError if the connection is lost meanwhile.
    """
    median_s, worst_s = session.controller.round_trips()
    number, begun_s, rate_hz, looks = session.report.number, time.monotonic(), 0.0, 0
    while not rate_hz > 0.0 and looks < _LOOKS:
        time.sleep(_RATE_OVER_S)
        rate_hz = (session.report.number - number) / (time.monotonic() - begun_s)
        looks += 1
    now = unfit(sdk, session, robot)
    if now and session.status.error:
        now = now.removesuffix(".") + "; an error that stays is cleared in UFACTORY Studio."
    limits = own_limits(sdk, session, robot)
    settings = (*_setting_refusals(session, robot, bare=bare), *beyond(limits, robot))
    refusals = (*((now,) if now else ()), *settings)
    if median_s > _SLOW_S:
        refusals = (
            *refusals,
            f"The controller takes {1000 * median_s:.0f} ms to answer, and may take {1000 * _SLOW_S:.0f} ms:"
            " connect it by cable, and see `latentarm doctor` if this computer is busy.",
        )
    if not rate_hz > 0.0:
        refusals = (*refusals, "The controller's joint angles do not change their time: restart it.")
    # An arm that moves is elsewhere in every report.
    poses = own_poses(session, robot) if _rests(session) else ()
    refusals = (*refusals, *misfits(poses, robot))
    facts = (*_facts(sdk, session, robot), *_tool_facts(session, robot, poses))
    facts = (*facts, *_timing(session, median_s, worst_s, rate_hz))
    return Findings(facts, refusals, limits, _notices(session, robot))


def unfit(sdk: Sdk, session: Session, robot: Robot) -> str:
    """Why a connected arm cannot be enabled now, one sentence, or ""."""
    report = session.report
    error, _ = session.controller.errors()
    if error in EMERGENCY_STOPS:
        return emergency_stop(error)
    if error:
        return controller_error(sdk, error)
    if session.fault:
        return session.fault
    if not np.isfinite(report.q).all() or not np.isfinite(report.dq).all():
        return "The arm reports joint angles that are no numbers: restart its controller."
    if not _rests(session):
        return "The arm is moving: end the program that drives it, then try again."
    outside = robot.limits.violation(report.q)
    joint = int(np.argmax(outside))
    if outside[joint] > _OUTSIDE_RAD:
        at, low, high = (
            f"{math.degrees(one[joint]):.1f}°" for one in (report.q, robot.limits.lower, robot.limits.upper)
        )
        return (
            f"Joint {robot.joint_names[joint]!r} is at {at}, outside {low} to {high}: choose the model that"
            " the arm is, or move the joint back in UFACTORY Studio."
        )
    apart = float(np.abs(session.controller.joints(robot.dof) - report.q).max())
    if not apart <= _APART_RAD:
        return (
            f"The joint angles that the arm reports differ by {apart:.2g} rad from those that its controller"
            " answers: restart the controller."
        )
    return ""


def _rests(session: Session) -> bool:
    report = session.report
    return bool(np.isfinite(report.q).all() and np.abs(report.dq).max() <= 5.0 * STILL_RAD_S)


def _setting_refusals(session: Session, robot: Robot, *, bare: bool) -> tuple[str, ...]:
    status = session.status
    refusals: list[str] = []
    load = (status.load_kg, *status.load_centre_mm)
    if not all(map(math.isfinite, load)) or status.load_kg < 0.0:
        refusals.append("The controller's payload is no number: set it in UFACTORY Studio under TCP Payload.")
    elif status.load_kg == 0.0 and (robot.gripper is not None or not bare):
        refusals.append(
            "The controller does not know what the arm carries (payload 0 kg): set it in UFACTORY Studio"
            " under TCP Payload, or add ?load=none to the address where nothing is mounted."
        )
    if any(abs(figure) > _SINGLE for figure in status.base_offset):
        refusals.append(
            "The controller reckons poses from a frame other than the arm's base: set the base coordinate"
            " offset to zero in UFACTORY Studio."
        )
    if status.collision_sensitivity == 0:
        refusals.append(
            "The arm's collision detection is off: set a sensitivity of 1 or more in UFACTORY Studio."
        )
    return tuple(refusals)


def _facts(sdk: Sdk, session: Session, robot: Robot) -> tuple[Fact, ...]:
    identity, status = session.identity, session.status
    centre = ", ".join(f"{figure:.0f}" for figure in status.load_centre_mm)
    down = np.array(status.gravity)
    tilt = math.degrees(math.acos(float(np.clip(-down[2] / max(np.linalg.norm(down), 1e-9), -1.0, 1.0))))
    named = ", ".join(robot.joint_names)
    facts = [
        Fact("arm", f"{identity.name}, {status.axes} joints (type {status.kind})"),
        Fact("firmware", identity.version),
        Fact("serial number", identity.arm_serial or "not told"),
        Fact("control box", identity.box_serial or "not told"),
        Fact("library", f"xarm-python-sdk {sdk.version}"),
        Fact("joints", f"{robot.name} by order: {named} are taken for J1 to J{robot.dof}"),
        Fact("payload", f"{status.load_kg:.2f} kg, centre ({centre}) mm"),
        Fact("mounting", "upright" if tilt < 1.0 else f"tilted by {tilt:.0f}°"),
        Fact("safety boundary", "on" if status.fenced else "off"),
        Fact("collision sensitivity", f"{status.collision_sensitivity} of 5"),
        Fact("warning", "none" if not status.warning else f"{status.warning}"),
        Fact("state", f"mode {status.mode}, state {status.state}"),
    ]
    if status.simulated:
        facts.append(Fact("simulation", "the controller simulates its arm: nothing real moves"))
    if session.gripper is not None and robot.gripper is not None:
        width_mm, most_mm = 1000 * session.gripper.reading.width_m, 1000 * robot.gripper.width_m
        opened = f"{width_mm:.0f} of {most_mm:.0f} mm open"
        facts.append(Fact("gripper", f"{opened}; how hard it presses cannot be set"))
    return tuple(facts)


def _notices(session: Session, robot: Robot) -> tuple[str, ...]:
    status, jerk = session.status, float(robot.limits.jerk.max())
    found: list[str] = []
    if status.reduced:
        found.append(
            "The arm's reduced mode is on and lowers its limits: end it in UFACTORY Studio if not meant."
        )
    if jerk > status.jerk_rad_s3:
        found.append(
            f"The limits state a jerk of up to {jerk:g} rad/s³, and the arm's own motions of its joints have"
            f" {status.jerk_rad_s3:g} rad/s³: it may follow more softly than it is commanded."
        )
    return tuple(found)


def _tool_facts(session: Session, robot: Robot, poses: tuple[OwnPose, ...]) -> tuple[Fact, ...]:
    *place, roll, pitch, yaw = session.status.tool_offset
    turned = ", ".join(f"{math.degrees(one):.1f}" for one in (roll, pitch, yaw))
    tool = f"({', '.join(f'{one:.0f}' for one in place)}) mm, roll, pitch, yaw ({turned})° from its flange"
    return (Fact("tool set on the arm", tool), compared(poses, robot))


def _timing(session: Session, median_s: float, worst_s: float, rate_hz: float) -> tuple[Fact, ...]:
    timed = session.report.controller_s is not None
    limit = session.status.acceleration_rad_s2
    from_half = f", plus {1000 * 0.5 / limit:.0f} ms to rest from 0.5 rad/s" if limit > 0.0 else ""
    clock = "the controller's, in every report" if timed else "not told: reports count from arrival"
    return (
        Fact("clock", clock),
        Fact("reports", f"{rate_hz:.0f} per second"),
        Fact("round trip", f"{1000 * median_s:.1f} ms at the median, {1000 * worst_s:.1f} ms at most"),
        Fact("stop time", f"begins within {1000 * ANSWER_S + 20:.0f} ms of the end of a command{from_half}"),
    )
