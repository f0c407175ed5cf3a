"""The arm as ROS describes it: ``/robot_description``, ``/tf`` and ``/tf_static``."""

import math
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final, final
from xml.etree import ElementTree as Xml

import mujoco
import numpy as np

from latentarm.arms.own_pose import OwnPose, kind_misfit, poses_about
from latentarm.arms.real import FoundLimits
from latentarm.arms.ros2.link import Link
from latentarm.arms.ros2.options import Ros2Options
from latentarm.arms.ros2.transforms import MOST_FRAMES, TOPICS, placed, transforms_in
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.core.untrusted.memory import bounded_memory
from latentarm.robots.model_xml import MOST_XML_BYTES, parse_xml
from latentarm.robots.robot import Robot

DESCRIPTION: Final = "/robot_description"
_TOPICS: Final = {DESCRIPTION: "std_msgs/msg/String", **TOPICS}
_UNNEEDED: Final = ("visual", "collision")
_MOST_NAMED: Final = 12


@final
class OwnModel:
    """The newest of these topics, from when it is made until `end`; roslibpy's thread writes."""

    def __init__(self, link: Link, options: Ros2Options) -> None:
        self._link, self._options = link, options
        self._lock = threading.Lock()
        self._urdf = ""
        self._frames: dict[str, tuple[str, FloatArray]] = {}  # parent, and pose (4, 4) in it, m, by child
        for topic, kind in _TOPICS.items():
            link.subscribe(topic, kind, self._heard_urdf if topic == DESCRIPTION else self._heard_frames)

    @property
    def complete(self) -> bool:
        """True once the description and a pose of the tool have come."""
        with self._lock:
            return bool(self._urdf) and self._options.tool_frame in self._frames

    def end(self) -> None:
        """Listen no more."""
        for topic in _TOPICS:
            self._link.unsubscribe(topic)

    def compare(
        self, q: FloatArray, robot: Robot
    ) -> tuple[tuple[str, ...], tuple[OwnPose, ...], FoundLimits | None]:
        """Refusals, poses of the tool, and limits, with the joints at ``q``, (n,), rad."""
        with self._lock:
            urdf, frames = self._urdf, dict(self._frames)
        poses: list[OwnPose] = []
        limits = None
        refusals: tuple[str, ...] = ()
        if urdf:
            try:
                described = Description(urdf, self._options)
                refusals = (*kind_misfit(described.name, robot), *described.misfits(robot))
                if not refusals:
                    limits = described.limits()
                    poses = [OwnPose(one, described.tool(one)) for one in (q, *poses_about(q, robot))]
            except UserError as error:
                refusals = (str(error),)
        if frames and not refusals:
            tool = placed(self._options.tool_frame, self._options.base_frame, frames)
            if tool is not None:
                poses.append(OwnPose(q, tool))
            elif not poses:
                refusals = (_no_frame(self._options.tool_frame, frames),)
        return refusals, tuple(poses), limits

    def _heard_urdf(self, message: Mapping[str, Any]) -> None:
        text = message.get("data")
        if isinstance(text, str) and len(text) <= MOST_XML_BYTES:
            with self._lock:
                self._urdf = text

    def _heard_frames(self, message: Mapping[str, Any]) -> None:
        try:
            heard = transforms_in(message)
        except (KeyError, TypeError, ValueError):
            return
        with self._lock:
            if len(self._frames) + len(heard) <= MOST_FRAMES:
                self._frames |= heard


@final
class Description:
    """A URDF as its own kinematics, read without shapes. Raises UserError where it cannot be used."""

    def __init__(self, text: str, options: Ros2Options) -> None:
        where = Path(DESCRIPTION)
        root = parse_xml(where, text.encode())
        self.name = root.get("name", "")
        for link in root.findall("link"):
            for element in [one for one in link if one.tag in _UNNEEDED]:
                link.remove(element)
        for element in [one for one in root if one.tag not in ("link", "joint")]:
            root.remove(element)
        self._joints = {str(joint.get("name")): joint for joint in root.findall("joint")}
        try:
            with bounded_memory(DESCRIPTION, len(text)):
                spec = mujoco.MjSpec.from_string(Xml.tostring(root, encoding="unicode"))
                spec.compiler.fusestatic = False
                spec.compiler.boundmass, spec.compiler.boundinertia = 1e-6, 1e-9
                spec.compiler.balanceinertia = True
                self._model = spec.compile()
        except (ValueError, RuntimeError) as error:
            raise UserError(f"{DESCRIPTION} cannot be read ({' '.join(str(error).split())}).") from error
        self._options = options
        self._data = mujoco.MjData(self._model)

    def misfits(self, robot: Robot) -> Iterator[str]:
        """Why its joints and frames are not those of the robot."""
        model, options = self._model, self._options
        if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, options.tool_frame) < 0:
            names = [model.body(body).name for body in range(1, model.nbody)]
            yield _no_frame(options.tool_frame, names)
            return
        movers = self._movers(options.tool_frame)
        if movers != set(options.joints):
            yield (
                f"In {DESCRIPTION} the joints {', '.join(sorted(movers))} move {options.tool_frame}, and"
                f" {robot.name} has {', '.join(options.joints)}: choose the model that the arm is, or name"
                " joints=... and tool_frame=... in --arm."
            )

    def tool(self, q: FloatArray) -> FloatArray:
        """The tool's pose (4, 4), m, in the base frame at joint positions (n,), rad."""
        for name, position in zip(self._options.joints, q, strict=True):
            self._data.qpos[int(self._model.joint(name).qposadr[0])] = position
        mujoco.mj_kinematics(self._model, self._data)
        tool = self._pose(self._options.tool_frame)
        base = self._options.base_frame
        return np.linalg.inv(self._pose(base)) @ tool if base else tool

    def limits(self) -> FoundLimits:
        """Limits of the joints, in the robot's order; infinite where it states none."""
        found = [self._limit(name) for name in self._options.joints]
        figures = np.array(found).T
        return FoundLimits(figures[0], figures[1], figures[2], figures[3], figures[4])

    def _limit(self, name: str) -> tuple[float, ...]:
        joint = self._joints[name]
        limit = joint.find("limit")
        figures = {} if limit is None else {key: _number(value) for key, value in limit.items()}
        ends = joint.get("type") != "continuous" and {"lower", "upper"} <= set(figures)
        lower, upper = (figures["lower"], figures["upper"]) if ends else (-math.inf, math.inf)
        # Exporters write zero where they do not know the speed.
        return lower, upper, *(figures.get(one) or math.inf for one in ("velocity", "acceleration", "jerk"))

    def _movers(self, frame: str) -> set[str]:
        model = self._model
        body, found = int(model.body(frame).id), set[str]()
        while body > 0:
            first = int(model.body_jntadr[body])
            found |= {model.joint(first + one).name for one in range(int(model.body_jntnum[body]))}
            body = int(model.body_parentid[body])
        return found

    def _pose(self, frame: str) -> FloatArray:
        try:
            body = self._data.body(frame)
        except KeyError as error:
            raise UserError(f"{DESCRIPTION} has no frame {frame}: check base_frame in --arm.") from error
        placed = np.eye(4)
        placed[:3, :3], placed[:3, 3] = body.xmat.reshape(3, 3), body.xpos
        return placed


def _no_frame(tool: str, names: Mapping[str, object] | list[str]) -> str:
    known = sorted(names)
    shown = ", ".join([*known[:_MOST_NAMED], *(["..."] if len(known) > _MOST_NAMED else [])])
    return (
        f"ROS has no frame {tool}, so where the tool is cannot be compared: name the tool's frame in --arm"
        f" with tool_frame=NAME, one of {shown}."
    )


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise UserError(f"{DESCRIPTION} has a limit {text!r}, which is no number.") from error
