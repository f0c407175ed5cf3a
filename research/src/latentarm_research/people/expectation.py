"""A simulated person who expects each axis of the stick to move the tool in one fixed direction."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self, final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.assistance.controllers.contract import Controller
from latentarm.core.errors import UserError
from latentarm.core.types import Context, FloatArray, Pose
from latentarm.robots.kinematics.chain import Chain


@final
@dataclass(frozen=True, eq=False)
class Expectation:
    """A simulated person who expects a push along axis i of the stick to move the tool along direction i.

    They answer questions by it (`inputs`), and they steer by it (a
    `latentarm_research.people.contract.Foresight`): they see where the tool is, and know nothing of decoder,
    alignment and arm. They ignore how the tool turns and any motion outside their directions.
    """

    chain: Chain  # the arm; only its first tool counts
    directions: FloatArray  # (d, 3), unit vectors of the base frame at right angles to each other
    speed_m_s: float  # of the tool at a full push along one axis, m/s

    def __post_init__(self) -> None:
        products = self.directions @ self.directions.T
        if self.directions.shape[1] != 3 or not np.allclose(products, np.eye(len(products)), atol=1e-6):
            raise UserError(
                "A simulated person's directions must be unit vectors in space at right angles to each other."
            )
        if not (math.isfinite(self.speed_m_s) and self.speed_m_s > 0):
            raise UserError(f"The simulated person's speed must be positive, not {self.speed_m_s:g} m/s.")

    def turned_and_mirrored(self, angle_rad: float) -> Self:
        """The same directions on a stick of two axes that is turned and mirrored.

        The first axis is where ``(cos, sin)`` of the angle was; the second, a quarter turn clockwise of it,
        is mirrored.
        """
        if len(self.directions) != 2:
            raise UserError(f"A stick is turned in its two axes, and this one has {len(self.directions)}.")
        cos, sin = math.cos(angle_rad), math.sin(angle_rad)
        directions = np.array([[cos, sin], [sin, -cos]]) @ self.directions
        return type(self)(self.chain, directions, self.speed_m_s)

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, d) by which they would ask for N motions."""
        moved = displacements(motions, self.chain)
        return np.clip(moved @ self.directions.T / (self.speed_m_s * motions.duration_s), -1.0, 1.0)

    def __call__(
        self,
        inputs: FloatArray,
        context: Context,
        controller: Controller,
        modes: Sequence[int],
        horizon_s: float,
    ) -> Pose:
        """Where they expect inputs (K, d) to lead: straight on from here, in every mode alike."""
        now = self.chain.forward(context.state)
        ahead = now.position + horizon_s * self.speed_m_s * (inputs @ self.directions)
        shape = (len(modes), len(inputs))
        return Pose(
            position=np.broadcast_to(ahead, (*shape, 3)),
            rotation=np.broadcast_to(now.rotation, (*shape, 3, 3)),
        )


def displacements(motions: Motions, chain: Chain) -> FloatArray:
    """How N motions move the first tool, (N, 3), m."""
    return chain.forward(motions.end).position - chain.forward(motions.start).position


def main_directions(
    motions: Motions,
    chain: Chain,
    count: int,  # 1 to 3
) -> FloatArray:
    """The directions along which the first tool moves most: (count, 3), the first most of all.

    Principal directions of the displacements about rest, not about their mean. Each has the sign that makes
    its largest entry positive.
    """
    directions = np.linalg.svd(displacements(motions, chain), full_matrices=False)[2][:count]
    largest = np.abs(directions).argmax(axis=1)
    return directions * np.sign(directions[np.arange(count), largest])[:, None]
