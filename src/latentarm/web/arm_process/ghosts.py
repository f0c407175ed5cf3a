"""Predicts the tool's path over the next second for each direction of the stick."""

from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from latentarm.assistance.blending import assistive_action, blend
from latentarm.assistance.controllers.contract import Controller
from latentarm.control.stick_ring import AHEAD_S, DIRECTIONS, STRETCHES, full_pushes
from latentarm.core.types import BoolArray, Context, FloatArray
from latentarm.robots.kinematics.obstacles import HalfSpace
from latentarm.robots.kinematics.pose_rows import stored_rows
from latentarm.safety.config import SafetyConfig
from latentarm.safety.limits import largest_speeds, margins
from latentarm.tasks.place import Place
from latentarm.web.arm_process.help import Help
from latentarm.web.protocol.orders import HelpLevel
from latentarm.web.protocol.report import NO_GHOSTS, Ghosts

_MAIN: Final = {name: DIRECTIONS * turn // 4 for turn, name in enumerate(("right", "up", "left", "down"))}
"""Index of the four directions whose whole paths are shown."""

_SAME_M: Final = 1e-9
_STRETCH_S: Final = AHEAD_S / STRETCHES
_Meaning = tuple[int, HelpLevel]
"""Decides what a push does: the index of the controller's mode, and the level of help."""


@final
@dataclass(eq=False)
class _Way:
    """The prediction so far, along every direction."""

    meaning: _Meaning
    context: Context  # of the moment at which it began
    q: FloatArray  # (K, n), joint positions, rad
    transforms: FloatArray  # (K, n, 4, 4), of the links
    heights: FloatArray  # (K, capsules, planes), see `GhostPaths._heights`, m
    points: list[FloatArray]  # where the tool was after each stretch so far, (K, 3), m


@final
class GhostPaths:
    """Predicts full deflections in every direction at once, one stretch of the way at a time.

    The prediction holds the deflection and the belief, integrates the velocities of the controller and of the
    robot's help in as many steps as there are stretches, and keeps the limits of joints, speed and planes
    (table, walls). It leaves out ramps, zones, and obstacles that are not planes. It is for display only; the
    safety filters decide.
    """

    def __init__(self, task: Place, controller: Controller, help_: Help, limits: SafetyConfig) -> None:
        self._controller = controller
        self._help = help_
        robot = task.robot
        self._chain = robot.chain
        self._capsules = robot.capsules
        margin = margins(robot, limits)
        self._lower, self._upper = robot.limits.lower + margin, robot.limits.upper - margin
        self._joint_speed = largest_speeds(robot, limits)
        self._tool_speed = limits.link_speed
        self._clearance = limits.clearance
        planes = [one for one in limits.obstacles if isinstance(one, HalfSpace)]
        self._normals = np.array([plane.normal for plane in planes]).reshape(-1, 3)
        self._offsets = np.array([plane.normal @ plane.point for plane in planes])
        # (G, n), the goals to which the help leads from the next stretch on, rad
        self.goals = np.array([goal.configuration for goal in task.goals])
        self._pushes = full_pushes(controller.input_dim)[:DIRECTIONS]
        self._way: _Way | None = None
        self._whole: tuple[_Meaning, Ghosts] | None = None

    def newest(self, mode: int) -> Ghosts:
        """Every direction in this mode, or `NO_GHOSTS` until all have been computed."""
        if self._whole is None or self._whole[0] != (mode, self._help.level):
            return NO_GHOSTS
        return self._whole[1]

    def look(self, context: Context, mode: int) -> None:
        """Predict the next stretch; the last one renews `newest`. The first stretch's ``context`` is kept."""
        meaning = (mode, self._help.level)
        way = self._way
        if way is None or way.meaning != meaning:
            way = self._way = self._begun(meaning, context)
        tool = self._chain.tool_pose(way.transforms).position
        here = replace(way.context, state=way.q)
        reached, transforms = self._moved(way.q, tool, self._wanted(here, mode))
        heights = self._heights(transforms)
        lower: BoolArray = (heights < self._clearance) & (heights < way.heights - _SAME_M)
        free: BoolArray = ~np.logical_or.reduce(lower, axis=(1, 2))
        way.q = np.where(free[:, None], reached, way.q)
        way.transforms = np.where(free[:, None, None, None], transforms, way.transforms)
        way.heights = np.where(free[:, None, None], heights, way.heights)
        pose = self._chain.tool_pose(way.transforms)
        way.points.append(pose.position)
        if len(way.points) == STRETCHES:
            paths = np.stack(way.points, axis=1)
            rows = {"ring": stored_rows(pose)} | {name: paths[index] for name, index in _MAIN.items()}
            found = {name: values.round(4).tolist() for name, values in rows.items()}
            self._whole = meaning, Ghosts.model_validate(found, strict=False)
            self._way = None

    def _begun(self, meaning: _Meaning, context: Context) -> _Way:
        q = np.tile(context.state, (len(self._pushes), 1))
        transforms = self._chain.link_transforms(q)
        return _Way(meaning, context, q, transforms, self._heights(transforms), [])

    def _wanted(self, context: Context, mode: int) -> FloatArray:
        """Joint velocities, (K, n), rad/s."""
        controller, help_ = self._controller, self._help
        action = controller.action(controller.latent(self._pushes, context, mode), context, mode)
        if not help_.on:
            return action
        alpha = help_.alpha(self._pushes, context.belief)
        return blend(action, assistive_action(context.state, context.belief, self.goals), alpha)

    def _moved(self, q: FloatArray, at: FloatArray, wanted: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Joints, (K, n), and links, (K, n, 4, 4), after one stretch from ``q``, where the tool is ``at``."""
        excess = (np.abs(wanted) / self._joint_speed).max(axis=1, keepdims=True)
        reached = np.clip(q + wanted / np.maximum(excess, 1.0) * _STRETCH_S, self._lower, self._upper)
        transforms = self._chain.link_transforms(reached)
        way = np.linalg.norm(self._chain.tool_pose(transforms).position - at, axis=1, keepdims=True)
        share = np.minimum(self._tool_speed * _STRETCH_S / np.maximum(way, _SAME_M), 1.0)
        if (share == 1.0).all():
            return reached, transforms
        reached = q + share * (reached - q)
        return reached, self._chain.link_transforms(reached)

    def _heights(self, transforms: FloatArray) -> FloatArray:
        """(K, capsules, planes), how far each part of the arm is above each plane, m."""
        starts, ends = self._capsules.placed(self._chain, transforms)
        lower = np.minimum(starts @ self._normals.T, ends @ self._normals.T)
        return lower - self._offsets - self._capsules.radius[:, None]
