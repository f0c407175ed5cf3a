"""The arm as the safety filters see it: points fixed to links, and how far joints can move them."""

from functools import cached_property
from typing import TYPE_CHECKING, final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray, IntArray
from latentarm.robots.kinematics.chain import SKEW

if TYPE_CHECKING:
    from latentarm.robots.robot import Robot


@final
class Body:
    """Constants of one arm: its points, and proven bounds on how they move.

    The P points are the ends of all moving capsules (all starts, then all ends) and the tools.

    ``lever[p, j]`` bounds the speed of point p per unit speed of joint j in *every* configuration:
    the point lies in a ball about the nearest point of the joint's axis, whose radius grows from link
    to link by what lies between their axes. With it the second derivative of p(q + t d) over t is
    at most ``Σ_jk |d_j| |d_k| R[p, j, k]`` with ``R[p, j, k] = lever[p, the outer of j and k]``,
    because ``∂²p/∂q_j∂q_k = w_j × (w_k × (p - o_k))`` for a joint k further out than j.
    """

    def __init__(self, robot: "Robot") -> None:
        self.robot = robot
        capsules, chain = robot.capsules, robot.chain
        # (K,), index into the robot's capsules of each moving capsule
        self.capsule: IntArray = np.flatnonzero(capsules.link >= 0)
        # (K,), whether a moving capsule stands for what the gripper holds
        self.held: BoolArray = self.capsule >= len(capsules) - robot.held
        tools = [tool for tool in chain.tools if tool.link >= 0]
        links = capsules.link[self.capsule]
        # (P,), the link that carries each point
        self.link: IntArray = np.concatenate(
            [links, links, np.array([t.link for t in tools], dtype=np.int64)]
        )
        tips = np.array([t.transform[:3, 3] for t in tools]).reshape(-1, 3)
        ends = capsules.start[self.capsule], capsules.end[self.capsule]
        self.local: FloatArray = np.concatenate([*ends, tips])
        radius = capsules.radius[self.capsule]
        # (P,), m; zero for tools
        self.radius: FloatArray = np.concatenate([radius, radius, np.zeros(len(tools))])
        # (L, P), whether the displacement of link l moves point p
        self.moves = np.ascontiguousarray(chain.moves[self.link].T)
        # (P, L), `lever` by links
        self.link_lever: FloatArray = self._levers()
        # (P, n), m (1 where the joint is prismatic)
        self.lever: FloatArray = self.by_joints(self.link_lever)

    @property
    def count(self) -> int:
        """Number of moving capsules K."""
        return len(self.capsule)

    def by_joints(self, by_links: FloatArray) -> FloatArray:
        """Bounds (..., n) per unit of each joint, from those (..., L) per unit of each link."""
        return by_links if self.robot.chain.coupling is None else by_links @ np.abs(self.robot.chain.ratio)

    def curvature(self, lever: FloatArray) -> FloatArray:
        """R of the class's docstring, (..., n, n), from levers by links (..., L)."""
        links = np.arange(lever.shape[-1])
        outer = np.maximum(links[:, None], links)
        inner = np.minimum(links[:, None], links)
        both = (lever[..., :, None] > 0.0) & (lever[..., None, :] > 0.0)
        by_links = np.where(both & ~self.robot.chain.link_slide[inner], lever[..., outer], 0.0)
        return self.by_joints(self.by_joints(by_links).mT).mT

    @cached_property
    def point_curvature(self) -> FloatArray:
        """(P, n, n), R for each point."""
        return self.curvature(self.link_lever)

    @cached_property
    def surface_lever(self) -> FloatArray:
        """(P, n), `lever` for the worst point on the capsule's surface about each point."""
        return self.by_joints(self._surface_link_lever)

    @cached_property
    def _surface_link_lever(self) -> FloatArray:
        turns = self.moves.T & ~self.robot.chain.link_slide
        return self.link_lever + turns * self.radius[:, None]

    @cached_property
    def surface_curvature(self) -> FloatArray:
        """(P, n, n), R for the worst point on the capsule's surface about each point."""
        return self.curvature(self._surface_link_lever)

    def bent(self, joints: FloatArray) -> FloatArray:
        """`surface_curvature` times joint figures (n,), (P, n)."""
        return (self._flat_curvature @ joints).reshape(-1, len(joints))

    @cached_property
    def _flat_curvature(self) -> FloatArray:
        return np.ascontiguousarray(self.surface_curvature.reshape(-1, self.robot.dof))

    @cached_property
    def moves_factor(self) -> FloatArray:
        """(L, 1, P), `moves` as factors."""
        return self.moves[:, None, :].astype(np.float64)

    @cached_property
    def turns(self) -> FloatArray:
        """(L, 1), one where a link turns, zero where it slides."""
        return (~self.robot.chain.link_slide).astype(np.float64)[:, None]

    @cached_property
    def _ends(self) -> tuple[FloatArray, FloatArray]:
        """The least and the greatest displacement, each (L,), of the links within the joints' limits."""
        ratio, limits = self.robot.chain.ratio, self.robot.limits
        ends = np.stack([ratio * limits.lower, ratio * limits.upper]).sum(axis=-1)
        return ends.min(axis=0), ends.max(axis=0)

    def _levers(self) -> FloatArray:
        """Levers by links (P, L): from the outermost link to the base, with a ball that holds each point."""
        chain, (lower, upper) = self.robot.chain, self._ends
        centre, radius = self.local.copy(), np.zeros(len(self.link))
        lever = np.zeros((len(self.link), chain.links))
        for link in reversed(range(chain.links)):
            on = chain.moves[self.link, link]
            axis, offset, at = chain.axis[link], chain.offset[link], centre[on]
            if chain.link_slide[link]:
                lever[on, link] = 1.0
                at = at + axis * 0.5 * (lower[link] + upper[link])
                radius[on] += 0.5 * (upper[link] - lower[link])
            else:
                on_axis = chain.anchor[link] + np.outer((at - chain.anchor[link]) @ axis, axis)
                radius[on] += np.linalg.norm(at - on_axis, axis=1)
                lever[on, link] = radius[on]
                at = on_axis
            centre[on] = at @ offset[:3, :3].T + offset[:3, 3]
        return lever


@final
class Placement:
    """The arm in one configuration (n,), rad: where its points are and how joint velocities move them."""

    __slots__ = ("_flat", "body", "jacobian", "link_jacobian", "points", "q")

    def __init__(self, body: Body, q: FloatArray) -> None:
        chain = body.robot.chain
        self.body = body
        self.q = q
        transforms = chain.link_transforms(q)
        self.points = chain.points(transforms, body.link, body.local)  # (P, 3), m, base frame
        axes, origins = chain.joint_axes(transforms)
        turn = axes * body.turns
        skew = (turn @ SKEW).reshape(-1, 3, 3)
        shift = axes - turn - (skew @ origins[:, :, None])[:, :, 0]
        jacobian = np.empty((len(axes), 6, len(self.points)))
        jacobian[:, :3] = skew @ self.points.T
        jacobian[:, :3] += shift[:, :, None]
        jacobian[:, 3:] = turn[:, :, None]
        jacobian *= body.moves_factor
        # (L, 6, P), what a unit speed of link l against its parent does at point p: rows 0-2 its velocity,
        # m/s, rows 3-5 the angular velocity of the link that carries it, rad/s
        self.link_jacobian = jacobian
        flat = jacobian.reshape(len(axes), -1)
        self._flat = flat if chain.coupling is None else chain.coupling.ratio.T @ flat
        self.jacobian = self._flat.reshape(-1, 6, len(self.points))  # (n, 6, P), the same of each joint

    def speeds(self, velocity: FloatArray) -> FloatArray:
        """Largest speed (P,), m/s, of any point on the surface about each point, at joint velocities (n,).

        The speed within a rigid capsule is largest at an end of its segment; its surface adds at most
        radius times angular speed.
        """
        moved = (velocity @ self._flat).reshape(2, 3, -1)
        linear, angular = np.sqrt(np.add.reduce(moved * moved, axis=1))
        return linear + self.body.radius * angular
