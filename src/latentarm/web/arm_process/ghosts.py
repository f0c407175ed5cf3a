"""What each direction of the stick would do now: the tool's path over the next second."""

from dataclasses import replace
from typing import Final, final

import numpy as np

from latentarm.assistance.blending import assistive_action, blend
from latentarm.control.controller import Controller
from latentarm.control.safety.config import SafetyConfig
from latentarm.kinematics.obstacles import HalfSpace
from latentarm.tasks.place import Place
from latentarm.types import Context, FloatArray
from latentarm.web.arm_process.help import Help
from latentarm.web.protocol.report import Ghosts, Point

AHEAD_S: Final = 1.0
POINTS: Final = 6

_DIRECTIONS: Final = {"up": (1, 1.0), "down": (1, -1.0), "left": (0, -1.0), "right": (0, 1.0)}
"""Axis and sign of the input."""

_SAME_M: Final = 1e-9


@final
class GhostPaths:
    """Looks ahead along the four full deflections, one direction at a time.

    The look ahead holds the deflection and the belief, integrates what the controller and the robot's help
    want in as many steps as there are points, and keeps the limits of joints, speed and of the planes
    (table, walls) that the arm must not pass. It leaves out ramps, zones, and obstacles that are not planes.
    It is for display only; the safety filters decide.

    Args:
        task: the robot and its goals.
        controller: what a deflection asks for.
        help_: how much the robot helps.
        limits: of the drive, and what it must keep clear of.
    """

    def __init__(self, task: Place, controller: Controller, help_: Help, limits: SafetyConfig) -> None:
        self._controller = controller
        self._help = help_
        robot = task.robot
        self._chain = robot.chain
        self._capsules = robot.capsules
        self._lower = robot.limits.lower + limits.joint_margin
        self._upper = robot.limits.upper - limits.joint_margin
        self._joint_speed = np.where(robot.chain.slide, limits.link_speed, limits.joint_speed)
        self._tool_speed = limits.link_speed
        self._clearance = limits.clearance
        planes = [one for one in limits.obstacles if isinstance(one, HalfSpace)]
        self._normals = np.array([plane.normal for plane in planes]).reshape(-1, 3)
        self._offsets = np.array([plane.normal @ plane.point for plane in planes])
        self._no_heights = np.zeros((0, 0))
        self._goals = np.array([goal.configuration for goal in task.goals])
        self._found: dict[str, tuple[Point, ...]] = {}
        self._whole: Ghosts | None = None

    @property
    def newest(self) -> Ghosts | None:
        """All four directions, or None until each has been computed once."""
        return self._whole

    def look(self, direction: int, context: Context, mode: int) -> None:
        """Look along one direction; with the last of the four, `newest` is renewed.

        Args:
            direction: 0 to 3.
            context: of this moment.
            mode: index of the controller's mode.
        """
        name, (axis, sign) = list(_DIRECTIONS.items())[direction]
        u = np.zeros(self._controller.input_dim)
        u[axis] = sign
        self._found[name] = self._path(u, context, mode)
        if direction == len(_DIRECTIONS) - 1 and len(self._found) == len(_DIRECTIONS):
            self._whole = Ghosts(**self._found)
            self._found = {}

    def _path(self, u: FloatArray, context: Context, mode: int) -> tuple[Point, ...]:
        dt_s = AHEAD_S / POINTS
        q = context.state
        transforms = self._chain.link_transforms(q)
        at, heights = self._chain.tool_pose(transforms).position, self._heights(transforms)
        points: list[Point] = []
        for _ in range(POINTS):
            wanted = self._wanted(u, replace(context, state=q), mode)
            reached, transforms = self._moved(q, at, wanted, dt_s)
            heights_there = self._heights(transforms)
            if not ((heights_there < self._clearance) & (heights_there < heights - _SAME_M)).any():
                q, at, heights = reached, self._chain.tool_pose(transforms).position, heights_there
            points.append((round(float(at[0]), 4), round(float(at[1]), 4), round(float(at[2]), 4)))
        return tuple(points)

    def _wanted(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        controller, help_ = self._controller, self._help
        action = controller.action(controller.latent(u, context, mode), context, mode)
        if not help_.on:
            return action
        alpha = float(help_.alpha(u, context.belief))
        return blend(action, assistive_action(context.state, context.belief, self._goals), alpha)

    def _moved(
        self, q: FloatArray, at: FloatArray, wanted: FloatArray, dt_s: float
    ) -> tuple[FloatArray, FloatArray]:
        """Joints, (n,), and links, (n, 4, 4), after one step from ``q``, where the tool is ``at``."""
        velocity = wanted / max(1.0, float((np.abs(wanted) / self._joint_speed).max()))
        reached = np.clip(q + velocity * dt_s, self._lower, self._upper)
        transforms = self._chain.link_transforms(reached)
        way = float(np.linalg.norm(self._chain.tool_pose(transforms).position - at))
        share = self._tool_speed * dt_s / max(way, _SAME_M)
        if share >= 1.0:
            return reached, transforms
        reached = q + share * (reached - q)
        return reached, self._chain.link_transforms(reached)

    def _heights(self, transforms: FloatArray) -> FloatArray:
        """(capsules, planes), how far each part of the arm is above each plane, m."""
        if not len(self._normals):
            return self._no_heights
        starts, ends = self._capsules.placed(self._chain, transforms)
        lower = np.minimum(starts @ self._normals.T, ends @ self._normals.T)
        return lower - self._offsets - self._capsules.radius[:, None]
