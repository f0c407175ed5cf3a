"""Today's way: two axes of the end-effector at a time, and a button that switches which."""

from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.control.controller import Controller
from latentarm.errors import UserError
from latentarm.models.enclosure import linear_enclosure
from latentarm.robots.robot import Robot
from latentarm.types import Context, FloatArray

_MODES = ("x-y", "z-yaw", "roll-pitch")
# Rows of the twist (x, y, z, roll, pitch, yaw) that the two input axes of each mode drive.
_AXES = ((0, 1), (2, 5), (3, 4))


@final
@dataclass(frozen=True)
class Damping:
    """How resolved rates give way near singular configurations.

    A singular value σ of the Jacobian is inverted as ``σ / (σ² + λ²)`` with
    ``λ² = (1 - (σ / threshold)²) factor²`` below ``threshold`` and 0 above: Nakamura and Hanafusa's
    variable damping, for each singular direction by itself as Chiaverini proposed, so that motions
    which stay possible stay exact. Metres and radians count alike.

    Attributes:
        threshold: singular value below which damping sets in, m or rad per rad.
        factor: damping at a singular configuration, same unit.
    """

    threshold: float = 0.1
    factor: float = 0.1

    def __post_init__(self) -> None:
        for name, value in (("threshold", self.threshold), ("factor", self.factor)):
            if not 0 < value < np.inf:
                raise UserError(f"The damping's {name} must be positive and finite, not {value}.")

    def inverse(self, singular: FloatArray) -> FloatArray:
        """Damped reciprocals of singular values (..., k)."""
        share = np.minimum(singular / self.threshold, 1.0)
        squared = singular * singular + (1.0 - share * share) * self.factor**2
        return singular / squared


@final
class EndEffectorController(Controller):
    """Mode-switched control of the tool: x-y, z-yaw, roll-pitch.

    Translations are along the axes of the base frame. Turns are about the axes of the tool frame
    through the tool point: roll about its x, pitch about its y, yaw about its z, the way it points.
    Joint velocities follow by resolved rates: of all that give the wanted twist, the smallest.

    Args:
        robot: the arm; its first tool is driven.
        linear_speed: of a full input along an axis, m/s.
        angular_speed: of a full input about an axis, rad/s.
        damping: behaviour near singular configurations.

    Raises:
        UserError: a speed is not positive and finite.
    """

    def __init__(
        self,
        robot: Robot,
        linear_speed: float = 0.15,
        angular_speed: float = 0.5,
        damping: Damping | None = None,
    ) -> None:
        for name, value in (("linear_speed", linear_speed), ("angular_speed", angular_speed)):
            if not 0 < value < np.inf:
                raise UserError(f"The end-effector's {name} must be positive and finite, not {value}.")
        self._chain = robot.chain
        self._damping = damping or Damping()
        self._scale = np.array([linear_speed] * 3 + [angular_speed] * 3)

    @property
    def modes(self) -> tuple[str, ...]:
        """The three pairs of axes."""
        return _MODES

    @property
    def input_dim(self) -> int:
        """Two axes."""
        return 2

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        """The input as it is: there is nothing to align."""
        return u

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """Joint velocities that move the tool along the mode's two axes, (..., n), rad/s."""
        transforms = self._chain.link_transforms(context.state)
        pose = self._chain.tool_pose(transforms)
        jacobian = self._chain.jacobian_at(transforms, pose)
        left, singular, right = np.linalg.svd(jacobian, full_matrices=False)
        first, second = _AXES[mode]
        directions = np.zeros((2, 6))
        directions[0, first], directions[1, second] = self._scale[first], self._scale[second]
        # Turns are asked for in the tool's frame.
        turns = directions[:, 3:] @ pose.rotation.mT
        shifts = np.broadcast_to(directions[:, :3], turns.shape)
        twists = np.concatenate([shifts, turns], axis=-1)
        inverse = self._damping.inverse(singular)[..., None, :]
        return np.vecmat(z, twists @ (left * inverse) @ right)

    def speed_bound(self, context: Context, mode: int) -> float:
        """Exact: the action is linear in the input."""
        columns = self.action(np.eye(self.input_dim), context, mode)
        return float(linear_enclosure(columns, np.zeros(columns.shape[-1])).largest())
