"""The force at the tool, by the arm's own estimate of what acts on its joints."""

import math
from typing import TYPE_CHECKING, Final, final

import numpy as np

from latentarm.core.types import FloatArray, Stop
from latentarm.safety.small import any_nonzero, largest

if TYPE_CHECKING:
    from latentarm.robots.robot import Robot

DAMPING_M: Final = 0.05
"""Near a singular configuration a small torque would count as a large force without it."""


@final
class ToolForce:
    """Refuses motions against a force that is above ``most_n``, N.

    The force F is estimated by damped least squares from ``J^T F = torque``, J (3, n) of the tool's position:
    all that acts counts as a force at the tool. Contact of a link nearer to the base counts as less. A motion
    that the force does not oppose leads away, and may go on.
    """

    def __init__(self, robot: "Robot", most_n: float) -> None:
        self._chain, self._most_n = robot.chain, most_n
        # By the damping no torque below this makes a force above the limit.
        self._least = 2.0 * DAMPING_M * most_n
        self._torque: FloatArray | None = None
        self._rest = np.zeros(robot.dof)
        self._going = self._rest

    def reset(self) -> None:
        """Begin anew, with an arm that has not moved yet."""
        self._going = self._rest

    def saw(self, torque: FloatArray | None) -> Stop | None:
        """Take the external torque of a reading, (n,), N m; why it cannot be used, or None.

        Raises where it is not an array of numbers.
        """
        self._torque = None if torque is None else np.array(torque, dtype=np.float64)
        if self._torque is None or (
            self._torque.shape == self._rest.shape and all(map(math.isfinite, self._torque.tolist()))
        ):
            return None
        return Stop(
            "The arm's external torques are not a number for each joint: check its driver.",
            untrusted=True,
            code="reading_invalid",
        )

    def refusal(self, q: FloatArray, velocity: FloatArray) -> Stop | None:
        """Why the arm at (n,), rad, may not go on with a motion (n,), rad/s, or None.

        An arm that stands still counts as moving as it did last.
        """
        if any_nonzero(velocity):
            self._going = velocity
        torque = self._torque
        if torque is None or torque @ torque <= self._least**2 or torque @ self._going >= 0.0:
            return None
        force_n = largest(self.forces(q, torque))
        if force_n <= self._most_n:
            return None
        return Stop(
            f"The arm pressed on something with about {force_n:.0f} N: check what it touches.",
            code="force_high",
            parameters={"force_n": round(force_n)},
        )

    def forces(self, q: FloatArray, torque: FloatArray) -> FloatArray:
        """(K,), estimated force at each tool, N, of an external torque (n,), N m, at q (n,), rad."""
        transforms = self._chain.link_transforms(q)
        forces = np.zeros(len(self._chain.tools))
        for tool in range(len(forces)):
            pose = self._chain.tool_pose(transforms, tool)
            jacobian = self._chain.jacobian_at(transforms, pose, tool)[:3]
            damped = jacobian @ jacobian.T + DAMPING_M**2 * np.eye(3)
            forces[tool] = np.linalg.norm(np.linalg.solve(damped, jacobian @ torque))
        return forces
