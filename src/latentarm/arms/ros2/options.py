"""Options in the address of an arm behind ROS 2: ``ros2://HOST[:PORT]?controller=NAME&...``."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Final, Literal, cast, final, get_args

from latentarm.arms.address import ArmAddress
from latentarm.core.errors import UserError
from latentarm.robots.robot import Robot

PORT: Final = 9090  # the usual port of rosbridge
Kind = Literal["velocity", "trajectory"]
_NAME: Final = re.compile(r"/?[A-Za-z_][A-Za-z0-9_]{0,99}(/[A-Za-z_][A-Za-z0-9_]{0,99}){0,9}")
_JOINT: Final = re.compile(r"[A-Za-z0-9_./-]{1,100}")


@final
@dataclass(frozen=True)
class Ros2Options:
    """A checked address. Names of topics, services and actions begin with a slash."""

    host: str  # of rosbridge
    port: int  # of rosbridge
    controller: str
    kind: Kind  # of the controller's commands
    states: str  # topic of the joint states
    watchdog: str  # prefix of the watchdog's topics
    manager: str  # prefix of the controller manager's services
    joints: tuple[str, ...]  # n names in ROS, in the order of the robot's joints
    gripper: str  # its action
    gripper_joint: str  # in the joint states; "" without a gripper
    gripper_open: float  # position of that joint, and of the action, with the gripper fully open
    gripper_closed: float  # the same with the gripper closed
    tool_frame: str  # frame of ``/tf`` and ``/robot_description`` that is the robot's end-effector
    base_frame: str  # that is the robot's base; "" for the first one

    @property
    def where(self) -> str:
        """Host and port, for messages."""
        return f"{self.host}:{self.port}"


def read_options(address: ArmAddress, robot: Robot) -> Ros2Options:
    """Check an address for a robot."""
    names = [field.name for field in fields(Ros2Options) if field.name not in ("host", "port")]
    given = address.only(*names)
    if "controller" not in given:
        raise UserError(
            "--arm ros2 needs the name of the arm's controller: ros2://HOST:PORT?controller=NAME."
        )
    kind = given.get("kind", "velocity")
    if kind not in get_args(Kind):
        raise UserError(f"The option kind of --arm ros2 is velocity or trajectory, not {kind}.")
    joints = tuple(given["joints"].split(",")) if "joints" in given else robot.joint_names
    if len(joints) != robot.dof or len(set(joints)) < len(joints) or not all(map(_JOINT.fullmatch, joints)):
        raise UserError(
            f"The option joints of --arm ros2 must be {robot.dof} different names with commas between them,"
            f" one for each joint of {robot.name}."
        )
    finger = given.get("gripper_joint", "")
    if robot.gripper is None and any(name.startswith("gripper") for name in given):
        raise UserError(f"--arm ros2 names a gripper, and {robot.name} has none.")
    if robot.gripper is not None and not _JOINT.fullmatch(finger):
        raise UserError(
            f"{robot.name} has a gripper: name its joint with gripper_joint=NAME, as `ros2 topic echo --once"
            " /joint_states` shows it on the arm's computer."
        )
    opened = _figure("gripper_open", given, 0.0 if robot.gripper is None else robot.gripper.width_m)
    closed = _figure("gripper_closed", given, 0.0)
    if robot.gripper is not None and opened == closed:
        raise UserError("The options gripper_open and gripper_closed of --arm ros2 must be different.")
    return Ros2Options(
        address.host,
        address.port or PORT,
        _graph_name("controller", given["controller"]),
        cast(Kind, kind),
        _graph_name("states", given.get("states", "/joint_states")),
        _graph_name("watchdog", given.get("watchdog", "/latentarm_watchdog")),
        _graph_name("manager", given.get("manager", "/controller_manager")),
        joints,
        _graph_name("gripper", given.get("gripper", "/gripper_controller/gripper_cmd")),
        finger,
        opened,
        closed,
        given.get("tool_frame", robot.chain.tools[0].name).strip("/"),
        given.get("base_frame", "").strip("/"),
    )


def _graph_name(option: str, text: str) -> str:
    if not _NAME.fullmatch(text):
        raise UserError(f"The option {option} of --arm ros2 must be a name of ROS, such as /{option}.")
    return "/" + text.lstrip("/")


def _figure(option: str, given: Mapping[str, str], default: float) -> float:
    text = given.get(option)
    if text is None:
        return default
    try:
        figure = float(text)
    except ValueError:
        figure = math.nan
    if not math.isfinite(figure):
        raise UserError(f"The option {option} of --arm ros2 must be a number, not {text}.")
    return figure
