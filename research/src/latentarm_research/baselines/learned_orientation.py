"""Position by the stick, orientation learned: the split of HITL-D.

The person moves the tool's position, as in mode switching, and its orientation follows from where it and the
things are, as in the demonstrations. Modes that only turn the tool are not needed. After "HITL-D"
(arXiv 2605.21460), whose orientation comes from a diffusion policy that sees what was before; here it is a
function of the moment.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.assistance.controllers.axis_modes import AxisController, AxisModes
from latentarm.core.errors import UserError
from latentarm.core.types import Context, FloatArray
from latentarm.models.numpy_networks import Layer
from latentarm.robots.kinematics.resolved_rates import Damping, joint_velocities
from latentarm.robots.kinematics.rotations import rotation_vector
from latentarm.robots.robot import Robot

POSITION: Final = AxisModes(("x-y", "z"), ((0, 1), (2, 3)))
"""The second axis of the mode z would turn the tool, and does nothing here."""

GAIN_PER_S: Final = 4.0  # how fast an error in orientation shrinks while the stick is pushed fully, 1/s
LINEAR_M_S: Final = 0.15  # of a full input along an axis
TURN_RAD_S: Final = 0.5  # fastest turn at a full input along an axis


def features(
    position: FloatArray,  # (..., 3), of the tool, m
    objects: FloatArray,  # (..., K, 9), see `Context.objects`; orientations are left out
    gripper: FloatArray,  # (..., g), see `Context.gripper`
) -> FloatArray:
    """Inputs of the orientation network, (..., 3 + 3 K + g)."""
    near = objects[..., :3] - position[..., None, :]  # What is held stays where it is in these.
    lead, width = near.shape[:-2], 3 * near.shape[-2]
    parts = (position, near.reshape(*lead, width), gripper)
    return np.concatenate([np.broadcast_to(one, (*lead, one.shape[-1])) for one in parts], axis=-1)


@final
@dataclass(frozen=True, eq=False)
class OrientationMap:
    """The orientation of the tool that the demonstrations had in a place: a small network in NumPy."""

    objects: tuple[str, ...]  # names of the K things that it looks at
    sees_gripper: bool  # whether it looks at the gripper's opening
    # weights (in, out) and biases (out,), with hyperbolic tangents in between. The last gives the first two
    # columns of a rotation, row by row
    layers: Sequence[Layer]

    def __call__(self, position: FloatArray, context: Context) -> FloatArray:
        """Rotations (..., 3, 3) in the base frame for positions of the tool (..., 3), m."""
        gripper = context.gripper if self.sees_gripper else np.zeros(0)
        values = features(position, context.objects, gripper)
        if values.shape[-1] != len(self.layers[0][0]):
            raise UserError(
                f"The orientation was learned with the things {', '.join(self.objects)}"
                f"{' and a gripper' if self.sees_gripper else ''}, and others are here."
            )
        for weight, bias in self.layers[:-1]:
            values = np.tanh(values @ weight + bias)
        weight, bias = self.layers[-1]
        columns = (values @ weight + bias).reshape(*values.shape[:-1], 3, 2)
        first = _unit(columns[..., 0])
        second = columns[..., 1] - np.vecdot(first, columns[..., 1])[..., None] * first
        second = _unit(second)
        return np.stack([first, second, np.cross(first, second)], axis=-1)


@final
class LearnedOrientationController(AxisController):
    """The person moves the tool along the axes of the base frame, and its orientation follows.

    The tool turns in proportion to the push, in either direction of it: at rest nothing moves.
    """

    def __init__(
        self,
        robot: Robot,  # the arm; its first tool is driven
        orientation: OrientationMap,
    ) -> None:
        super().__init__(robot, LINEAR_M_S, TURN_RAD_S, POSITION)
        self._orientation = orientation
        self._damping = Damping()

    @property
    def objects(self) -> tuple[str, ...]:
        """The things that the orientation depends on."""
        return self._orientation.objects

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """Joint velocities (..., n), rad/s, that move the tool along the axes and turn it as learned."""
        transforms = self._chain.link_transforms(context.state)
        pose = self._chain.tool_pose(transforms)
        asked = np.vecmat(z, self._modes.twists(mode, self._scale, pose.rotation))[..., :3]
        turn = rotation_vector(self._orientation(pose.position, context) @ pose.rotation.mT)
        angle = np.sqrt(np.vecdot(turn, turn))[..., None]
        rate = turn * np.minimum(GAIN_PER_S, TURN_RAD_S / np.maximum(angle, 1e-9))
        push = np.sqrt(np.vecdot(asked, asked))[..., None] / LINEAR_M_S
        twist = np.concatenate(np.broadcast_arrays(asked, push * rate), axis=-1)
        jacobian = self._chain.jacobian_at(transforms, pose)
        return np.vecmat(twist, joint_velocities(np.eye(6), jacobian, self._damping))


def _unit(vector: FloatArray) -> FloatArray:
    return vector / np.sqrt(np.maximum(np.vecdot(vector, vector), 1e-12))[..., None]
