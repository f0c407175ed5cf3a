#!/usr/bin/env python3
"""Stops an arm behind ros2_control when the commands of latentarm end.

Run this node on the computer that runs the arm's controllers. It is one file and needs Python 3.10,
``rclpy``, ``controller_manager_msgs``, ``sensor_msgs``, ``std_msgs`` and ``trajectory_msgs``::

    python3 latentarm_watchdog.py --controller /velocity_controller --kind velocity \
        --joint joint_1 0.8 4.0 --joint joint_2 0.8 4.0 ...

Each ``--joint`` gives a name, the largest speed in rad/s, and the largest acceleration in rad/s², in the
order of the controller's ``joints`` parameter. `Watchdog` makes every decision and knows nothing of ROS;
`main` connects it to ROS.
"""

import argparse
import hashlib
import json
import math
import os
import select
import signal
import sys
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

VERSION = 1
"""Of the messages between the watchdog and its client."""

TICK_S = 0.01
"""How often it commands the controller, s."""

TOLD_S = 0.02
"""How often its client is told its state, s."""

GRACE_S = 0.07
"""A command counts for so much longer than its duration, reckoned from when its client sent it, s."""

STOPS_AFTER_S = GRACE_S + 2 * TICK_S
"""When a command's duration has passed, the arm begins to brake within this time, s.

It holds however slow the network is: what was sent too long ago is not carried out.
"""

RAMP_S = 0.08
"""Braking takes this long, s."""

SILENCE_S = 0.5
"""Without a word from its client for so long, an armed arm is latched, s."""

EXPIRY_S = 1.0
"""Without a word from its client for so long, the arm is free for another one, s."""

LONGEST_S = 0.5
"""Longest duration of a command, s."""

STATES_S = 0.1
"""Joint states older than this latch the arm, s."""

JUMP_S = 0.5
"""Stamps of joint states that run ahead of or behind the time that passes by this latch the arm, s."""

CONTROLLER_S = 1.0
"""What the controller manager said counts for so long, s."""

ZEROS_S = 0.5
"""For how long zeros are still sent to the controller after the arm has stopped, s."""

WINDOW_S = 0.3
"""Commanded and measured displacement are compared over this time, s."""

FOLLOWING_RAD = 0.05
"""They may differ by this, beyond what a lag of LAG_S explains, rad."""

LAG_S = 0.1
"""How far an arm may lag behind its commands, s."""

AHEAD_S = 0.03
"""The first point of a trajectory lies so far ahead, s."""

MOVING, RESTING = b"m", b"r"
"""What the second process is told at each tick."""

LONGEST_TEXT = 4096
"""Characters of a message."""


@dataclass(frozen=True)
class Joint:
    """A joint as the controller knows it: its name, largest speed, rad/s, and acceleration, rad/s²."""

    name: str
    speed: float
    acceleration: float


@dataclass(frozen=True)
class Arm:
    """What the watchdog guards.

    Attributes:
        controller: the name of the controller, such as ``/velocity_controller``.
        kind: ``velocity`` or ``trajectory``.
        joints: in the order of the controller.
        stop_topic: where the state of the emergency stop is told; "" where nowhere.
        publishers: how many publishers of the controller's topic belong to this watchdog.
    """

    controller: str
    kind: str
    joints: tuple[Joint, ...]
    stop_topic: str = ""
    publishers: int = 1

    def __post_init__(self) -> None:
        names = [joint.name for joint in self.joints]
        if self.kind not in ("velocity", "trajectory") or not names or len(set(names)) < len(names):
            raise ValueError("an arm needs a kind, velocity or trajectory, and joints of different names")
        for joint in self.joints:
            if not (0.0 < joint.speed < math.inf and 0.0 < joint.acceleration < math.inf):
                raise ValueError(f"{joint.name} needs a speed and an acceleration above zero")


class Watchdog:
    """Lets one client drive, and stops the arm when that client's commands end.

    All times are of one clock that never goes back, which the client knows from `state` only: each of its
    messages says which state it had seen last, and how long ago. So the watchdog knows the earliest moment at
    which a message can have been sent, and what the network has held back does not count.

    Args:
        arm: what it guards.
    """

    def __init__(self, arm: Arm) -> None:
        self.arm = arm
        self._names = [joint.name for joint in arm.joints]
        self._rest = (0.0,) * len(arm.joints)
        self._session = ""
        self._sequence = -1
        self._heard_s = -math.inf
        self._phase = "free"
        self._reason = ""
        self._arming = -1
        self._refused = 0
        self._target = self._out = self._rest
        self._until_s = -math.inf
        self._braking: tuple[float, tuple[float, ...]] | None = (-math.inf, self._rest)
        self._ticked_s = -math.inf
        self._moved_s = -math.inf
        self._q: tuple[float, ...] | None = None
        self._stamp_s = -math.inf
        self._states_s = -math.inf
        self._states_reason = f"No joint states with {', '.join(self._names)} have come to the watchdog."
        self._controller_s = -math.inf
        self._controller_reason = "The controller manager does not answer the watchdog."
        self._publishers = arm.publishers
        self._guarded = True
        self._stop_pressed: bool | None = None if arm.stop_topic else False
        self._told = [0.0] * len(arm.joints)
        self._track: deque[tuple[float, tuple[float, ...], tuple[float, ...]]] = deque()

    @property
    def at_rest(self) -> bool:
        """Whether it commands no motion."""
        return not any(self._out)

    @property
    def measured(self) -> tuple[float, ...] | None:
        """The newest joint positions, rad; None before there are any."""
        return self._q

    # What the world says

    def controllers(self, found: Sequence[tuple[str, str, Sequence[str]]], now_s: float) -> None:
        """Take the controller manager's list: name, state and command interfaces of each controller."""
        self._controller_s = now_s
        wanted = self.arm.controller.strip("/").split("/")[-1]
        named = {name: (state, list(interfaces)) for name, state, interfaces in found}
        if wanted not in named:
            self._controller_reason = f"There is no controller {wanted}: load and activate it."
            return
        state, interfaces = named[wanted]
        joints = [interface.rsplit("/", 1)[0] for interface in interfaces]
        if state != "active":
            self._controller_reason = f"The controller {wanted} is {state[:20]}: activate it."
        elif self.arm.kind == "velocity" and interfaces != [f"{name}/velocity" for name in self._names]:
            self._controller_reason = (
                f"The controller {wanted} takes {', '.join(interfaces)[:200]}, not velocities of"
                f" {', '.join(self._names)} in this order: start the watchdog with the controller's joints."
            )
        elif self.arm.kind == "trajectory" and set(joints) != set(self._names):
            self._controller_reason = f"The controller {wanted} has other joints than the watchdog."
        else:
            self._controller_reason = ""

    def publishers(self, count: int) -> None:
        """Take how many publishers the controller's topic has."""
        self._publishers = count

    def unguarded(self) -> None:
        """The process that stops the arm when this one is killed has ended itself."""
        self._guarded = False

    def emergency_stop(self, pressed: bool) -> None:
        """Take the state of the emergency stop."""
        self._stop_pressed = pressed

    def joint_states(
        self, stamp_s: float, names: Sequence[str], positions: Sequence[float], now_s: float
    ) -> None:
        """Take joint states; those of other joints only, such as a gripper's, say nothing."""
        found = dict(zip(names, positions, strict=False))
        missing = [name for name in self._names if name not in found]
        if len(missing) == len(self._names):
            return
        if missing or len(names) != len(positions):
            self._states_reason = f"The joint states lack {', '.join(missing) or 'positions'}."
            return
        q = tuple(float(found[name]) for name in self._names)
        if not all(map(math.isfinite, (stamp_s, *q))):
            self._states_reason = "The joint states have figures that are not finite."
            return
        if stamp_s == self._stamp_s:
            return
        if self._q is not None and abs((stamp_s - self._stamp_s) - (now_s - self._states_s)) > JUMP_S:
            self._latch("The clock of the joint states has jumped.", now_s)
        self._stamp_s, self._states_s, self._q, self._states_reason = stamp_s, now_s, q, ""
        self._follow(q, now_s)

    # What the client says

    def heard(self, text: str, now_s: float) -> None:
        """Take a message of a client; what is wrong with it is counted, or latches the arm."""
        message = _parsed(text)
        if message is None:
            self._refused += 1
            return
        op, session = message["op"], message["session"]
        sent_s = min(message["seen"] + message["age"], now_s)
        fresh = now_s - sent_s <= SILENCE_S
        if op == "claim":
            self._claim(session, message["sequence"], sent_s if fresh else None)
            return
        if session != self._session or message["sequence"] <= self._sequence:
            self._refused += 1
            return
        self._sequence = message["sequence"]
        self._heard_s = max(self._heard_s, sent_s)
        if op in ("stop", "disable", "release"):
            self._brake(now_s)
            if op != "stop" and self._phase == "armed":
                self._phase, self._reason = "disabled", ""
            if op == "release":
                self._session, self._phase, self._reason = "", "free", ""
        elif not fresh:
            self._refused += 1
        elif op == "recover" and self._phase == "latched" and self.at_rest:
            self._phase, self._reason = "disabled", ""
        elif op == "enable" and self._phase == "disabled" and self.at_rest:
            self._enable(message.get("arming"), now_s)
        elif op == "command":
            self._command(message, sent_s, now_s)

    def _claim(self, session: str, sequence: int, sent_s: float | None) -> None:
        """Give a free arm to a client; nothing moves, and what stopped the arm before is forgotten."""
        if self._session or sent_s is None or not self.at_rest:
            self._refused += 1
            return
        self._session, self._sequence, self._heard_s = session, sequence, sent_s
        self._phase, self._reason, self._arming = "disabled", "", -1

    def _enable(self, arming: object, now_s: float) -> None:
        self._reason = self._obstacle(now_s)
        if isinstance(arming, int) and not self._reason:
            self._phase, self._arming = "armed", arming
            self._target, self._until_s, self._braking = self._rest, -math.inf, None
            self._track.clear()

    def _command(self, message: dict[str, Any], sent_s: float, now_s: float) -> None:
        if self._phase != "armed" or message.get("arming") != self._arming:
            self._refused += 1
            return
        velocity, duration_s = message.get("velocity"), message.get("duration")
        if not _figures(velocity, len(self._rest)) or not _figures([duration_s], 1):
            self._latch(f"A command was not {len(self._rest)} finite velocities and a duration.", now_s)
            return
        for joint, asked in zip(self.arm.joints, velocity, strict=True):
            if abs(asked) > joint.speed * (1.0 + 1e-6):
                self._latch(
                    f"{joint.name} was commanded {asked:.3g} rad/s, and the watchdog allows"
                    f" {joint.speed:.3g}: lower the speed, or start the watchdog with a higher one.",
                    now_s,
                )
                return
        until_s = sent_s + min(max(duration_s, 0.0), LONGEST_S) + GRACE_S
        if until_s <= now_s:
            self._refused += 1  # too late: the arm brakes, or has come to rest
            return
        self._target, self._until_s, self._braking = tuple(map(float, velocity)), until_s, None

    # What the arm is told

    def tick(self, now_s: float) -> tuple[float, ...] | None:
        """The velocities to command now, rad/s; None where nothing is to be sent."""
        span_s = now_s - self._ticked_s if math.isfinite(self._ticked_s) else 0.0
        self._ticked_s = now_s
        self._told = [told + speed * span_s for told, speed in zip(self._told, self._out, strict=True)]
        if self._phase == "armed":
            obstacle = self._obstacle(now_s)
            if self._stop_pressed:
                self._latch("The emergency stop on the arm was pressed.", now_s)
            elif obstacle:
                self._latch(obstacle, now_s)
            elif now_s - self._heard_s > SILENCE_S:
                self._latch("Nothing more has come from the computer that drives the arm.", now_s)
            elif now_s >= self._until_s:
                self._brake(now_s)
        if self._braking is None:
            self._out = self._towards_target(min(span_s, 2 * TICK_S))
        else:
            since_s, before = self._braking
            left = max(1.0 - (now_s - since_s) / RAMP_S, 0.0)
            self._out = tuple(speed * left for speed in before)
        if self._session and self.at_rest and now_s - self._heard_s > EXPIRY_S:
            self._session, self._phase, self._reason = "", "free", ""
        if self._phase == "armed" or not self.at_rest:
            self._moved_s = now_s
        return self._out if now_s - self._moved_s <= ZEROS_S else None

    def state(self, now_s: float) -> str:
        """What clients are told, as JSON. The session is told as a digest: who reads it cannot drive."""
        return json.dumps(
            {
                "latentarm_watchdog": VERSION,
                "time_s": now_s,
                "controller": self.arm.controller,
                "kind": self.arm.kind,
                "joints": self._names,
                "speed": [joint.speed for joint in self.arm.joints],
                "acceleration": [joint.acceleration for joint in self.arm.joints],
                "stops_after_s": STOPS_AFTER_S,
                "ramp_s": RAMP_S,
                "owner": digest(self._session) if self._session else "",
                "phase": self._phase,
                "reason": self._reason,
                "obstacle": self._obstacle(now_s),
                "arming": self._arming,
                "stop_topic": self.arm.stop_topic,
                "stop_pressed": bool(self._stop_pressed),
                "sequence": self._sequence,
                "refused": self._refused,
            }
        )

    def _towards_target(self, span_s: float) -> tuple[float, ...]:
        """Towards the target, straight and within every joint's acceleration."""
        share = 1.0
        for joint, now, aim in zip(self.arm.joints, self._out, self._target, strict=True):
            if aim != now:
                share = min(share, joint.acceleration * span_s / abs(aim - now))
        if share >= 1.0:
            return self._target
        return tuple(now + share * (aim - now) for now, aim in zip(self._out, self._target, strict=True))

    def _brake(self, now_s: float) -> None:
        if self._braking is None:
            self._braking = (now_s, self._out)
        self._until_s = -math.inf

    def _latch(self, reason: str, now_s: float) -> None:
        self._brake(now_s)
        if self._phase == "armed":
            self._phase, self._reason = "latched", reason

    def _obstacle(self, now_s: float) -> str:
        """Why the arm may not be driven now, as one sentence; "" where it may."""
        if self._stop_pressed is None:
            return f"Nothing has come on {self.arm.stop_topic}: it must say that no stop is pressed."
        if self._stop_pressed:
            return "The emergency stop on the arm is pressed."
        if now_s - self._controller_s > CONTROLLER_S:
            return "The controller manager does not answer the watchdog."
        if self._controller_reason:
            return self._controller_reason
        if not self._guarded:
            return "The watchdog's second process has ended: start the watchdog again."
        if self._publishers > self.arm.publishers:
            return f"Another node publishes to {self.arm.controller}: end it."
        if self._states_reason:
            return self._states_reason
        return "The joint states have ended." if now_s - self._states_s > STATES_S else ""

    def _follow(self, q: tuple[float, ...], now_s: float) -> None:
        """Latch where the arm does not do what it is told."""
        self._track.append((now_s, tuple(self._told), q))
        while now_s - self._track[0][0] > WINDOW_S:
            self._track.popleft()
        _, told, start = self._track[0]
        for index, name in enumerate(self._names):
            asked = self._told[index] - told[index]
            allowed = FOLLOWING_RAD + LAG_S * max(abs(self._out[index]), abs(asked) / WINDOW_S)
            if abs((q[index] - start[index]) - asked) > allowed:
                self._latch(f"{name} does not move as it is commanded.", now_s)


class Targets:
    """Velocities as trajectories for a joint trajectory controller.

    Each trajectory ends at rest, so the arm also stops when this node is killed.
    """

    def __init__(self) -> None:
        self._q: list[float] = []
        self._since_s = -math.inf

    def points(
        self, velocity: Sequence[float], measured: Sequence[float], now_s: float
    ) -> list[tuple[list[float], list[float], float]]:
        """Positions, rad, velocities, rad/s, and the time from now, s, of each point.

        It goes on from the trajectory before; from where the arm is, after a pause.
        """
        span_s = now_s - self._since_s
        if span_s > ZEROS_S / 2 or not self._q:
            self._q, span_s = list(measured), 0.0
        self._since_s = now_s
        self._q = [q + speed * span_s for q, speed in zip(self._q, velocity, strict=True)]
        ahead = [q + speed * AHEAD_S for q, speed in zip(self._q, velocity, strict=True)]
        end = [q + speed * RAMP_S / 2 for q, speed in zip(ahead, velocity, strict=True)]
        return [(ahead, list(velocity), AHEAD_S), (end, [0.0] * len(end), AHEAD_S + RAMP_S)]


def digest(session: str) -> str:
    """What others may know of a session."""
    return hashlib.sha256(session.encode()).hexdigest()[:16]


def _parsed(text: str) -> dict[str, Any] | None:
    """A message with the entries that each must have, or None."""
    if len(text) > LONGEST_TEXT:
        return None
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(message, dict):
        return None
    session, sequence = message.get("session"), message.get("sequence")
    known = isinstance(message.get("op"), str) and isinstance(session, str) and 16 <= len(session) <= 64
    counted = isinstance(sequence, int) and not isinstance(sequence, bool) and 0 <= sequence < 1 << 53
    timed = _figures([message.get("seen"), message.get("age")], 2) and message["age"] >= 0.0
    return message if known and counted and timed else None


def _figures(found: object, count: int) -> bool:
    """Whether this is a list of so many finite numbers."""
    return (
        isinstance(found, list)
        and len(found) == count
        and all(isinstance(x, int | float) and not isinstance(x, bool) and abs(x) < 1e12 for x in found)
    )


def arm_of(arguments: Sequence[str]) -> tuple[Arm, argparse.Namespace]:
    """Read the command line.

    Raises:
        SystemExit: it cannot be used.
    """
    parser = argparse.ArgumentParser(description="Stops the arm when the commands of latentarm end.")
    parser.add_argument("--controller", required=True, help="such as /velocity_controller")
    parser.add_argument("--kind", required=True, choices=("velocity", "trajectory"))
    parser.add_argument(
        "--joint",
        required=True,
        nargs=3,
        action="append",
        metavar=("NAME", "SPEED", "ACCELERATION"),
        help="in the controller's order; rad/s and rad/s²",
    )
    parser.add_argument("--states", default="/joint_states", help="topic of the joint states")
    parser.add_argument("--manager", default="/controller_manager", help="the controller manager")
    parser.add_argument("--stop-topic", default="", help="std_msgs/Bool with the state of the emergency stop")
    parser.add_argument("--stop-when", default="true", choices=("true", "false"), help="what it says then")
    parser.add_argument("--name", default="/latentarm_watchdog", help="where its own topics are")
    options = parser.parse_args(arguments)
    try:
        joints = tuple(Joint(name, float(speed), float(rise)) for name, speed, rise in options.joint)
        own = 2 if options.kind == "velocity" else 1
        arm = Arm(options.controller.rstrip("/"), options.kind, joints, options.stop_topic, own)
    except ValueError as error:
        parser.error(str(error))
    return arm, options


def guard(told: int, send_zeros: Callable[[], None]) -> None:
    """Send zeros while the watchdog's own process hangs in motion, and once more when it was killed.

    Args:
        told: a file descriptor that gets a byte at each tick of the watchdog, MOVING or RESTING.
        send_zeros: sends velocities of zero to the controller.
    """
    newest = RESTING
    while True:
        ready, _, _ = select.select([told], [], [], STOPS_AFTER_S)
        found = os.read(told, 4096) if ready else newest
        if not found:
            break
        newest = found[-1:]
        if not ready and newest == MOVING:
            send_zeros()
    if newest == MOVING:
        for _ in range(round(ZEROS_S / TICK_S)):
            send_zeros()
            time.sleep(TICK_S)


def second_process(arm: Arm, ros_arguments: Sequence[str]) -> int:
    """Start the process of `guard`: a velocity controller goes on with its last command for ever.

    Returns:
        The file descriptor that is to get a byte at each tick.
    """
    told, writing = os.pipe()
    if os.fork():
        os.close(told)
        os.set_blocking(writing, False)
        return writing
    os.close(writing)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it ends when the watchdog has ended
    import rclpy
    from std_msgs.msg import Float64MultiArray

    rclpy.init(args=list(ros_arguments))
    node = rclpy.create_node("latentarm_watchdog_guard")
    publisher = node.create_publisher(Float64MultiArray, f"{arm.controller}/commands", 1)
    guard(told, lambda: publisher.publish(Float64MultiArray(data=[0.0] * len(arm.joints))))
    os._exit(0)


def main(arguments: Sequence[str]) -> None:
    """Connect the watchdog to ROS, and run until it is ended."""
    import rclpy
    from controller_manager_msgs.srv import ListControllers
    from rclpy.duration import Duration
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from rclpy.utilities import remove_ros_args
    from sensor_msgs.msg import JointState
    from std_msgs.msg import Bool, Float64MultiArray, String
    from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

    arm, options = arm_of(remove_ros_args(args=list(arguments))[1:])
    alive = second_process(arm, arguments) if arm.kind == "velocity" else None
    rclpy.init(args=list(arguments))
    node = rclpy.create_node("latentarm_watchdog")
    watchdog, targets, now_s = Watchdog(arm), Targets(), time.monotonic
    trajectories = arm.kind == "trajectory"
    topic = f"{arm.controller}/{'joint_trajectory' if trajectories else 'commands'}"
    commands = node.create_publisher(JointTrajectory if trajectories else Float64MultiArray, topic, 1)
    states = node.create_publisher(String, f"{options.name}/state", 1)
    manager = node.create_client(ListControllers, f"{options.manager}/list_controllers")
    asked: list[Any] = []

    def joint_states(message: Any) -> None:
        stamp = message.header.stamp
        watchdog.joint_states(
            stamp.sec + 1e-9 * stamp.nanosec, list(message.name), list(message.position), now_s()
        )

    def listed(future: Any) -> None:
        asked.clear()
        found = future.result()
        if found is not None:
            watchdog.controllers(
                [(one.name, one.state, one.required_command_interfaces) for one in found.controller], now_s()
            )

    def ask() -> None:
        watchdog.publishers(node.count_publishers(topic))
        if manager.service_is_ready() and not asked:
            asked.append(manager.call_async(ListControllers.Request()))
            asked[0].add_done_callback(listed)

    def tick() -> None:
        velocity = watchdog.tick(now_s())
        measured = watchdog.measured
        if velocity is not None and not trajectories:
            commands.publish(Float64MultiArray(data=list(velocity)))
        elif velocity is not None and measured is not None:
            message = JointTrajectory(joint_names=[joint.name for joint in arm.joints])
            for positions, speeds, after_s in targets.points(velocity, measured, now_s()):
                after = Duration(seconds=after_s).to_msg()
                message.points.append(
                    JointTrajectoryPoint(positions=positions, velocities=speeds, time_from_start=after)
                )
            commands.publish(message)
        if alive is not None:
            try:
                os.write(alive, RESTING if watchdog.at_rest else MOVING)
            except BlockingIOError:
                pass  # it has not read yet what it was told before
            except BrokenPipeError:
                watchdog.unguarded()

    node.create_subscription(JointState, options.states, joint_states, 10)
    node.create_subscription(
        String, f"{options.name}/command", lambda message: watchdog.heard(message.data, now_s()), 50
    )
    if arm.stop_topic:
        pressed = options.stop_when == "true"
        for durability in (DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL):
            node.create_subscription(
                Bool,
                arm.stop_topic,
                lambda message: watchdog.emergency_stop(message.data == pressed),
                QoSProfile(depth=1, durability=durability),
            )
    node.create_timer(TICK_S, tick)
    node.create_timer(TOLD_S, lambda: states.publish(String(data=watchdog.state(now_s()))))
    node.create_timer(0.1, ask)
    rclpy.spin(node)


if __name__ == "__main__":
    main(sys.argv)
