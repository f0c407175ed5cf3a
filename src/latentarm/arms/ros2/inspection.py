"""Inspection of an arm behind ROS 2 before anything moves, and reasons to refuse it."""

import time
from collections.abc import Callable, Iterator, Mapping
from statistics import median
from typing import Any, Final

import numpy as np

from latentarm.arms.contract import STOPS_AFTER_S
from latentarm.arms.own_pose import compared, misfits
from latentarm.arms.real import Fact, Findings
from latentarm.arms.ros2.joint_states import JointFeed
from latentarm.arms.ros2.link import Link
from latentarm.arms.ros2.options import Ros2Options
from latentarm.arms.ros2.own_model import OwnModel
from latentarm.arms.ros2.session import VERSION, Session, WatchdogState
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.robot import Robot

ANSWER_S: Final = 1.0  # wait for the watchdog, the controller manager and the joint states
FREE_S: Final = 1.5  # wait for a client that has gone
LISTEN_S: Final = 0.3  # span in which joint states are counted
LOWEST_HZ: Final = 40.0  # slower joint states are refused
LONGEST_TRIP_S: Final = 0.08  # a longer round trip is refused: commands would arrive too old
_TRIPS: Final = 5
_CHANCES: Final = 3
_LIST: Final = "controller_manager_msgs/srv/ListControllers"


def inspect(link: Link, session: Session, feed: JointFeed, options: Ros2Options, robot: Robot) -> Findings:
    """Inspect everything needed for driving, and change nothing."""
    own, listens_until_s = OwnModel(link, options), time.monotonic() + ANSWER_S
    _wait(lambda: session.state is not None, ANSWER_S)
    _wait(lambda: feed.newest is not None, ANSWER_S)
    answer, trips = _controllers(link, options)
    rate_hz, repeats = _rate(feed)
    state = session.state
    if state is not None and state.version == VERSION and state.owner:
        _wait(lambda: session.state is not None and not session.state.owner, FREE_S)
        state = session.state
    trip_s = median(trips) if trips else None
    refusals = (
        *_watchdog_refusals(state, options),
        *_controller_refusals(answer, options),
        *_state_refusals(feed, rate_hz, repeats, options),
    )
    if trip_s is not None and trip_s > LONGEST_TRIP_S:
        refusals = (
            *refusals,
            f"The round trip to {options.where} takes {1e3 * trip_s:.0f} ms, more than"
            f" {1e3 * LONGEST_TRIP_S:.0f} ms: use a cable, and see `latentarm doctor`.",
        )
    _wait(lambda: own.complete, listens_until_s - time.monotonic())
    own.end()
    poses, limits = (), None
    if feed.newest is not None and np.abs(feed.newest[0].dq).max() > 5.0 * STILL_RAD_S:
        refusals = (*refusals, "The arm is moving: end the program that drives it, then try again.")
    elif feed.newest is not None:
        unlike, poses, limits = own.compare(feed.newest[0].q, robot)
        refusals = (*refusals, *unlike, *misfits(poses, robot))
    facts = (*_facts(options, state, answer, feed, rate_hz, trip_s), compared(poses, robot))
    return Findings(facts, refusals, limits)


def _controllers(link: Link, options: Ros2Options) -> tuple[dict[str, Mapping[str, Any]] | None, list[float]]:
    """The controllers by name, None where nobody answers; and the time of each answer, s."""
    found: dict[str, Mapping[str, Any]] | None = None
    trips: list[float] = []
    for _ in range(_TRIPS):
        began_s = time.perf_counter()
        answer = link.call(f"{options.manager}/list_controllers", _LIST, ANSWER_S)
        listed = None if answer is None else answer.get("controller")
        if not isinstance(listed, list):
            return found, trips
        trips.append(time.perf_counter() - began_s)
        found = {str(one.get("name")): one for one in listed if isinstance(one, Mapping)}
    return found, trips


def _rate(feed: JointFeed) -> tuple[float, int]:
    """Joint states per second, with chances for a busy computer, and how many repeated the one before."""
    rate_hz, before = 0.0, feed.repeats
    for _ in range(_CHANCES):
        count, began_s = feed.count, time.monotonic()
        time.sleep(LISTEN_S)
        rate_hz = max(rate_hz, (feed.count - count) / (time.monotonic() - began_s))
        if rate_hz >= LOWEST_HZ:
            break
    return rate_hz, feed.repeats - before


def _watchdog_refusals(state: WatchdogState | None, options: Ros2Options) -> Iterator[str]:
    if state is None:
        yield (
            f"No watchdog answers on {options.watchdog}/state: check the cable to the arm's computer, and"
            " start latentarm_watchdog.py there (`latentarm guide latentarm_watchdog.py` prints it);"
            " without it nothing would stop the arm when this computer fails."
        )
        return
    if state.version != VERSION:
        yield (
            f"The watchdog has version {state.version}, and this latentarm needs {VERSION}: start the"
            " one that `latentarm guide latentarm_watchdog.py` prints."
        )
        return
    if set(state.joints) != set(options.joints) or len(state.joints) != len(options.joints):
        yield (
            f"The watchdog has the joints {', '.join(state.joints)}, and the robot has"
            f" {', '.join(options.joints)}: choose the robot that the arm is, or give joints=... in --arm."
        )
    if state.controller.strip("/") != options.controller.strip("/") or state.kind != options.kind:
        yield (
            f"The watchdog commands {state.controller} ({state.kind}), and --arm names"
            f" {options.controller} ({options.kind}): use the same for both."
        )
    if not 0.0 <= state.stops_after_s <= STOPS_AFTER_S:
        yield (
            f"The watchdog takes {1e3 * state.stops_after_s:.0f} ms to notice that commands have ended: it"
            f" must be {1e3 * STOPS_AFTER_S:.0f} ms or less."
        )
    if state.owner:
        yield "Another client drives the arm: end it there first."


def _controller_refusals(
    answer: Mapping[str, Mapping[str, Any]] | None, options: Ros2Options
) -> Iterator[str]:
    if answer is None:
        yield f"{options.manager}/list_controllers does not answer: start ros2_control for the arm."
        return
    name = options.controller.rsplit("/", 1)[-1]
    if name not in answer:
        there = ", ".join(sorted(answer)) or "none"
        yield f"There is no controller {name}; there are {there}: name one of these in --arm, or load it."
        return
    found = answer[name]
    if found.get("state") != "active":
        yield (
            f"The controller {name} is {found.get('state')}: activate it"
            f" (ros2 control switch_controllers --activate {name})."
        )
    needed = found.get("required_command_interfaces") or found.get("claimed_interfaces") or []
    joints = {str(one).rsplit("/", 1)[0] for one in needed}
    if joints != set(options.joints):
        yield (
            f"The controller {name} has the joints {', '.join(sorted(joints))}, and the robot has"
            f" {', '.join(options.joints)}: choose the robot that the arm is, or give joints=... in --arm."
        )
    elif options.kind == "velocity" and not all(str(one).endswith("/velocity") for one in needed):
        yield f"The controller {name} takes no velocities: use kind=trajectory, or a velocity controller."


def _state_refusals(feed: JointFeed, rate_hz: float, repeats: int, options: Ros2Options) -> Iterator[str]:
    if feed.trouble:
        yield feed.trouble
    elif feed.newest is None:
        yield (
            f"No joint states with {', '.join(options.joints)} come on {options.states}: start the"
            " joint_state_broadcaster."
        )
    elif rate_hz < LOWEST_HZ and repeats:
        yield "The joint states repeat one moment: the arm's driver has stopped; start it again."
    elif rate_hz < LOWEST_HZ:
        yield (
            f"Joint states come {rate_hz:.0f} times per second, and {LOWEST_HZ:.0f} are needed: raise the"
            " update rate of the controller manager."
        )
    elif options.gripper_joint and feed.gripper is None:
        yield f"The joint states lack {options.gripper_joint}: check gripper_joint in --arm."


def _facts(
    options: Ros2Options,
    state: WatchdogState | None,
    answer: Mapping[str, Mapping[str, Any]] | None,
    feed: JointFeed,
    rate_hz: float,
    trip_s: float | None,
) -> Iterator[Fact]:
    yield Fact("rosbridge", options.where)
    if answer is not None:
        for name in sorted(answer):
            yield Fact(f"controller {name}", f"{answer[name].get('state')} ({answer[name].get('type')})")
    if state is not None:
        yield Fact("watchdog", f"version {state.version}, {state.controller or 'controller unknown'}")
    if state is not None and state.version == VERSION:
        speeds = (f"{joint} {speed:g}" for joint, speed in zip(state.joints, state.speed, strict=True))
        yield Fact("watchdog's speed limits", ", ".join(speeds) + " rad/s")
        stops = f"brakes {1e3 * state.stops_after_s:.0f} ms after a command has run out"
        yield Fact("stop time", f"{stops}, within {1e3 * state.ramp_s:.0f} ms")
        yield Fact("emergency stop", state.stop_topic or "not told: start the watchdog with --stop-topic")
        yield Fact("ready", state.obstacle or "yes")
    yield Fact("joint states", f"{rate_hz:.0f} per second")
    if trip_s is not None:
        yield Fact("round trip", f"{1e3 * trip_s:.1f} ms (median of {_TRIPS} service calls)")
    if feed.newest is not None:
        yield Fact("clock", f"{feed.ahead_s:+.3f} s against this computer's time of day")


def _wait(what: Callable[[], bool], at_most_s: float) -> None:
    until_s = time.monotonic() + at_most_s
    while not what() and time.monotonic() < until_s:
        time.sleep(0.01)
