"""A connection to a Franka: opened, inspected, set up. Nothing here moves it."""

import statistics
import threading
import time
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, final

import numpy as np

from latentarm.arms.franka.limits import SHARE, FrankaLimits, limits_of
from latentarm.arms.franka.options import FrankaOptions
from latentarm.arms.franka.pace import measured_rate, strange
from latentarm.arms.franka.words import plain
from latentarm.arms.own_limits import beyond
from latentarm.arms.own_pose import OwnPose, compared, kind_misfit, misfits
from latentarm.arms.real import Fact, Findings
from latentarm.core.errors import UserError
from latentarm.robots.robot import Robot

if TYPE_CHECKING:
    import franky

_CONNECT_S: Final = 8.0  # an arm that has not answered by then is absent
_AXIS_RAD: Final = 0.01
_AXIS_M: Final = 0.003  # tolerance of a joint's axis in the robot's model
_REALTIME_FILE: Final = Path("/sys/kernel/realtime")
_ROUND_TRIPS: Final = 9


@final
class Link:
    """An open connection until `close`; ``hand`` may be None, and ``limits`` is None for an unknown arm."""

    def __init__(
        self, arm: "franky.Robot", hand: "franky.Gripper | None", limits: FrankaLimits | None
    ) -> None:
        self._arm: franky.Robot | None = arm
        self.hand = hand  # do not keep it longer than this link
        self.limits = limits

    @property
    def arm(self) -> "franky.Robot":
        """Franky's robot; do not keep a reference."""
        if self._arm is None:
            raise RuntimeError("the connection to the arm has ended")
        return self._arm

    def close(self) -> None:
        """End the connection; the arm then stops by itself."""
        self._arm = self.hand = None


def library() -> Any:
    """The module ``franky``."""
    try:
        import franky
    except ImportError as error:
        raise UserError(
            f"--arm franka needs franky-control, which cannot be imported here ({plain(error)}):"
            " pip install 'latentarm[franka]', on Linux."
        ) from error
    return franky


def open_link(host: str, options: FrankaOptions, robot: Robot) -> Link:
    """Connect. This sets the arm's collision thresholds; nothing moves."""
    franky = library()
    found: list[Link] = []
    failed: list[Exception] = []

    def connect() -> None:
        # libfranka raises its own exceptions; which one decides what is said.
        try:
            arm = franky.Robot(host, realtime_config=_realtime(franky, options))
            hand = None if robot.gripper is None else franky.Gripper(host)
            found.append(Link(arm, hand, limits_of(arm.model_urdf)))
        except Exception as error:  # noqa: BLE001
            failed.append(error)

    thread = threading.Thread(target=connect, name="franka-connect", daemon=True)
    thread.start()
    thread.join(_CONNECT_S)
    if found:
        return found[0]
    if not failed:
        raise UserError(
            f"{host} has not answered for {_CONNECT_S:g} s: check the arm's power, cable and address."
        )
    error = failed[0]
    if isinstance(error, franky.IncompatibleVersionException):
        raise UserError(
            f"The arm at {host} speaks another version than this franky-control ({plain(error)}): install the"
            " one that its README names for the arm's system version; a Panda needs libfranka 0.9."
        ) from error
    raise UserError(
        f"There is no Franka at {host} that can be driven ({plain(error)}): check its power, its cable and"
        " the address, open its brakes and activate FCI in Desk, and end any other program that is connected."
    ) from error


def set_up(link: Link, options: FrankaOptions, robot: Robot) -> None:
    """Set the arm's thresholds, payload and attachment, and the limits of franky's motions."""
    limits = link.limits
    if limits is None:
        raise ValueError("an arm that is not known is refused before it is set up")
    inertia = np.diag(options.payload_inertia_kg_m2).ravel().tolist()
    try:
        _set_thresholds(link, options)
        link.arm.set_load(options.payload_kg, options.payload_centre_m, inertia)
        if options.attachment_tip_m is not None:
            tip = np.eye(4)
            tip[:3, 3] = options.attachment_tip_m
            link.arm.set_ee(tip.ravel(order="F").tolist())
        for name, arms, theirs in (
            ("velocity", limits.velocity, robot.limits.velocity),
            ("acceleration", limits.acceleration, robot.limits.acceleration),
            ("jerk", limits.jerk, robot.limits.jerk),
        ):
            mine = getattr(link.arm, f"joint_{name}_limit")
            mine.set(np.minimum(SHARE * np.minimum(arms, theirs), mine.max))
    except Exception as error:
        raise UserError(
            f"The arm does not take its settings ({plain(error)}): check payload_kg and the thresholds of the"
            " address, and that it is not moving."
        ) from error


def refusals(link: Link, options: FrankaOptions, robot: Robot, rate: float) -> tuple[str, ...]:
    """Reasons not to drive this arm as this robot; ``rate`` is its `measured_rate`."""
    found: list[str] = []
    if link.limits is None:
        found.append("The arm says it is neither an FR3 nor a Panda: no other can be driven.")
    else:
        # Limits of another kind of arm differ, and lower ones would not make it this one.
        found += kind_misfit(link.limits.kind, robot) or beyond(link.limits.found, robot)
    if distance := _axes_apart(link, robot):
        found.append(
            f"The joints of {robot.name} are not where the arm's are ({distance}): choose the robot that the"
            " arm is, in the arm's own base frame."
        )
    else:
        found += misfits((_own_pose(link, options),), robot)
    if options.realtime == "enforce" and not has_realtime():
        found.append(
            "This computer has no realtime kernel: install one, or add ?realtime=ignore to the address and"
            " expect the arm to stop when the computer is busy."
        )
    if late := strange(rate):
        found.append(late)
    widest_m = 0.0 if robot.gripper is None else robot.gripper.width_m
    if link.hand is not None and link.hand.state.max_width < 0.5 * widest_m:
        found.append(
            f"The hand says it opens to {1000 * link.hand.state.max_width:.0f} mm at most: home it in Desk."
        )
    return tuple(found)


def findings(link: Link, options: FrankaOptions, robot: Robot) -> Findings:
    """The arm's facts, and reasons not to drive it."""
    state, limits, rate = link.arm.state, link.limits, measured_rate(link.arm)
    facts = [
        Fact("arm", "not known" if limits is None else limits.kind),
        Fact("mode", str(state.robot_mode.name)),
        Fact("control library", f"franky-control {version('franky-control')}"),
        Fact("joint positions", ", ".join(f"{q:.3f}" for q in state.q) + " rad"),
        Fact("end-effector", f"{state.m_ee:.2f} kg (set in Desk)"),
        Fact("payload", f"{state.m_load:.2f} kg now, {options.payload_kg:g} kg when connected"),
        Fact("collision thresholds", _thresholds(options)),
    ]
    if link.hand is not None:
        hand = link.hand.state
        opened = f"{1000 * hand.width:.0f} of {1000 * hand.max_width:.0f} mm open"
        facts.append(Fact("hand", f"version {link.hand.server_version}, {opened}, {hand.temperature} °C"))
    facts.append(compared((_own_pose(link, options),), robot))
    clock = f"{rate:.3f} s of the arm in one of this computer"
    facts += [Fact("clock", clock), Fact("round trip", _round_trip(link, options))]
    own = None if limits is None or kind_misfit(limits.kind, robot) else limits.found
    return Findings(tuple(facts), refusals(link, options, robot, rate), own)


def _set_thresholds(link: Link, options: FrankaOptions) -> None:
    torque = list(options.collision_torque_nm)
    force = [*options.collision_force_n, *options.collision_moment_nm]
    link.arm.set_collision_behavior(torque, torque, force, force)


def _axes_apart(link: Link, robot: Robot) -> str:
    """Distance between the joint axes of the arm and of the model, in words, or ""."""
    franky = library()
    state = link.arm.state
    jacobian = np.asarray(link.arm.model.zero_jacobian(franky.Frame.Flange, state))
    flange = np.asarray(link.arm.model.pose(franky.Frame.Flange, state).translation).ravel()
    theirs = jacobian[3:].T
    moments = jacobian[:3].T - np.cross(theirs, flange)
    transforms = robot.chain.link_transforms(np.asarray(state.q, dtype=np.float64))
    axes, anchors = robot.chain.joint_axes(transforms)
    for joint in range(robot.dof):
        turned = float(np.arccos(np.clip(theirs[joint] @ axes[joint], -1.0, 1.0)))
        moved = float(np.linalg.norm(moments[joint] - np.cross(anchors[joint], axes[joint])))
        if turned > _AXIS_RAD or moved > _AXIS_M:
            name = robot.joint_names[joint]
            return f"{name} is off by {np.degrees(turned):.1f}° and {1000 * moved:.0f} mm"
    return ""


def _own_pose(link: Link, options: FrankaOptions) -> OwnPose:
    """Where the arm says that its end-effector is, or will be once the tip of the address is set."""
    state = link.arm.state
    offset = np.asarray(state.F_T_EE.matrix)
    flange = np.asarray(state.O_T_EE.matrix) @ np.linalg.inv(offset)
    if options.attachment_tip_m is not None:
        tip = np.eye(4)
        tip[:3, 3] = options.attachment_tip_m
        offset = np.asarray(state.F_T_NE.matrix) @ tip
    return OwnPose(np.asarray(state.q, dtype=np.float64), flange @ offset, offset)


def _round_trip(link: Link, options: FrankaOptions) -> str:
    took: list[float] = []
    for _ in range(_ROUND_TRIPS):
        began_s = time.perf_counter()
        _set_thresholds(link, options)
        took.append(1000.0 * (time.perf_counter() - began_s))
    return f"{statistics.median(took):.1f} ms, at most {max(took):.1f} ms"


def _thresholds(options: FrankaOptions) -> str:
    figures = (options.collision_torque_nm, options.collision_force_n, options.collision_moment_nm)
    torque, force, moment = (", ".join(f"{value:g}" for value in one) for one in figures)
    return f"{torque} N m; {force} N; {moment} N m"


def _realtime(franky: Any, options: FrankaOptions) -> Any:
    """Insist on real time only where libfranka will get it; else `refusals` says so."""
    insist = options.realtime == "enforce" and has_realtime()
    return franky.RealtimeConfig.Enforce if insist else franky.RealtimeConfig.Ignore


def has_realtime() -> bool:
    """Whether this computer runs a realtime kernel, by libfranka's test."""
    try:
        return _REALTIME_FILE.read_text(encoding="ascii").strip() == "1"
    except OSError:
        return False
