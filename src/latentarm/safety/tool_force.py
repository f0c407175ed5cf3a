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

FORCE: Final = "force"  # in `limited_by` of each command that was eased
EASED: Final = (0.5, 0.8)
"""Shares of the largest force: motion against the force slows from the first, and ends at the second."""


@final
class ToolForce:
    """Eases motions against a force, and refuses them where it is above ``most_n``, N.

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
        # True while the estimated force is large enough to slow motions against it.
        self.pressing = False

    def reset(self) -> None:
        """Begin anew, with an arm that has not moved yet."""
        self._going, self.pressing = self._rest, False

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
        force_n = largest(np.linalg.norm(self.forces(q, torque)[0], axis=1))
        if force_n <= self._most_n:
            return None
        return Stop(
            f"The arm pressed on something with about {force_n:.0f} N: check what it touches.",
            code="force_high",
            parameters={"force_n": round(force_n)},
        )

    def eased(self, q: FloatArray, velocity: FloatArray) -> FloatArray:
        """A velocity (n,), rad/s, at q (n,), rad, with less motion of the tools against the force.

        Their rotation, and translation across the force, stay the same as far as damping allows. Where there
        is nothing to ease this is ``velocity`` itself.
        """
        torque, begins = self._torque, EASED[0]
        self.pressing = False
        if torque is None or torque @ torque <= (begins * self._least) ** 2:
            return velocity
        for force, jacobian in zip(*self.forces(q, torque), strict=True):
            size_n = float(np.linalg.norm(force))
            share = min((size_n / self._most_n - begins) / (EASED[1] - begins), 1.0)
            if share <= 0.0:
                continue
            self.pressing = True
            back = np.concatenate([force / size_n, np.zeros(3)])
            against_m_s = -float(back @ (jacobian @ velocity))
            if against_m_s > 0.0:
                way = jacobian.T @ _damped(jacobian, back)
                # Undo the damping: the rest of the push would slowly build up force.
                velocity = velocity + share * against_m_s / max(back @ jacobian @ way, 0.5) * way
        return velocity

    def forces(self, q: FloatArray, torque: FloatArray) -> tuple[FloatArray, list[FloatArray]]:
        """(K, 3), estimated force at each tool, N, of an external torque (n,), N m, at q (n,), rad.

        And the tools' Jacobians (6, n).
        """
        transforms = self._chain.link_transforms(q)
        forces, jacobians = np.zeros((len(self._chain.tools), 3)), list[FloatArray]()
        for tool in range(len(forces)):
            pose = self._chain.tool_pose(transforms, tool)
            jacobian = self._chain.jacobian_at(transforms, pose, tool)
            jacobians.append(jacobian)
            forces[tool] = _damped(jacobian[:3], jacobian[:3] @ torque)
        return forces, jacobians


def _damped(jacobian: FloatArray, x: FloatArray) -> FloatArray:
    """``(J J^T + DAMPING_M^2 I)^-1 x``."""
    damped = jacobian @ jacobian.T + DAMPING_M**2 * np.eye(len(jacobian))
    return np.linalg.solve(damped, x).astype(np.float64, copy=False)
