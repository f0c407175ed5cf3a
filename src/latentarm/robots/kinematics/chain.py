"""A kinematic tree in NumPy, batched: forward kinematics, geometric Jacobians, and capsules on its links."""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray, IntArray, Pose

# Row (i, j, k) -> -epsilon_ijk, so that v @ SKEW is [v]x row by row: ([v]x)_jk = -epsilon_ijk v_i.
SKEW: FloatArray = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    ]
)


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame that rides on a link, such as a tool."""

    name: str  # of the site or body in the robot's model
    link: int  # index of its link, -1 for the base
    transform: FloatArray  # (4, 4), link frame -> this frame, m


@final
@dataclass(frozen=True, eq=False)
class Coupling:
    """The linear map from n joints to L links, where some links follow a joint (``<mimic>``)."""

    ratio: FloatArray  # (L, n), displacement of each link per displacement of each joint
    slide: BoolArray  # (L,), True where the link slides


@final
@dataclass(frozen=True, eq=False)
class Chain:
    """A kinematic tree of L moving links; fixed bodies are merged into their parents.

    Link i moves with joint i, so L = n, unless a ``coupling`` says otherwise. At ``q = 0`` its frame is
    ``offset[i]`` in its parent link's frame.
    The base frame is the world frame of the model that the chain was read from.
    """

    joint_names: tuple[str, ...]
    parent: IntArray  # (L,), index of the parent link, -1 for the base; parents come before children
    offset: FloatArray  # (L, 4, 4), parent link -> the link's frame at q = 0, m
    axis: FloatArray  # (L, 3), unit axis in the link's frame
    anchor: FloatArray  # (L, 3), the point that the link turns about, in its frame, m
    slide: BoolArray  # (n,), True where the joint is prismatic (its q is in m)
    tools: tuple[Frame, ...]  # the end-effectors; the first is "the" tool
    coupling: Coupling | None = None

    @property
    def dof(self) -> int:
        """Number of joints n."""
        return len(self.joint_names)

    @property
    def links(self) -> int:
        """Number of moving links L."""
        return len(self.parent)

    @property
    def link_slide(self) -> BoolArray:
        """(L,), True where the link slides."""
        return self.slide if self.coupling is None else self.coupling.slide

    @cached_property
    def ratio(self) -> FloatArray:
        """(L, n), displacement of each link per displacement of each joint."""
        return np.eye(self.dof) if self.coupling is None else self.coupling.ratio

    def of_joints(self, of_links: FloatArray) -> FloatArray:
        """Derivatives (..., n) by the joints, from those (..., L) by the displacements of the links."""
        return of_links if self.coupling is None else of_links @ self.coupling.ratio

    @cached_property
    def moves(self) -> BoolArray:
        """(L, L), whether the displacement of link j (column) moves link i (row)."""
        moves = np.eye(self.links, dtype=np.bool_)
        for link, parent in enumerate(self.parent):
            if parent >= 0:
                moves[link] |= moves[parent]
        return moves

    def link_transforms(self, q: FloatArray) -> FloatArray:
        """Base-frame poses (..., L, 4, 4) of all links at positions (..., n), rad (m where prismatic)."""
        at = q if self.coupling is None else q @ self.coupling.ratio.T
        flat = at.reshape(-1, self.links).T
        constants = self.motion_constants
        features = np.empty((*flat.shape, constants.shape[1]))
        features[..., 0] = 1.0
        np.sin(flat, out=features[..., 1])
        np.cos(flat, out=features[..., 2])
        if self._slides:
            features[..., 3] = flat
        transforms = (features @ constants).reshape(*flat.shape, 4, 4)
        if q.ndim == 1:
            single = transforms[:, 0]
            for link, parent in self._children:
                single[link] = single[parent].dot(single[link])  # a third of the time of `@`
            return single
        for link, parent in self._children:
            transforms[link] = transforms[parent] @ transforms[link]
        return transforms.swapaxes(0, 1).reshape(*at.shape, 4, 4)

    def forward(self, q: FloatArray, tool: int = 0) -> Pose:
        """Forward kinematics ``x = Psi(s)`` of a tool, in the base frame, at positions (..., n), rad."""
        return self.tool_pose(self.link_transforms(q), tool)

    def tool_pose(self, transforms: FloatArray, tool: int = 0) -> Pose:
        """Pose of a tool in the base frame, from the links' transforms (..., L, 4, 4)."""
        frame = self.tools[tool]
        if frame.link < 0:
            pose = np.broadcast_to(frame.transform, (*transforms.shape[:-3], 4, 4))
        else:
            pose = transforms[..., frame.link, :, :] @ frame.transform
        return Pose(position=pose[..., :3, 3], rotation=pose[..., :3, :3])

    def jacobian(self, q: FloatArray, tool: int = 0) -> FloatArray:
        """Geometric Jacobian (..., 6, n) of a tool in the base frame, at positions (..., n), rad.

        Rows 0-2 give the tool point's velocity in m/s, rows 3-5 its angular velocity in rad/s, per rad/s of
        each joint (per m/s where prismatic).
        """
        transforms = self.link_transforms(q)
        return self.jacobian_at(transforms, self.tool_pose(transforms, tool), tool)

    def jacobian_at(self, transforms: FloatArray, pose: Pose, tool: int = 0) -> FloatArray:
        """`jacobian` from the links' transforms (..., L, 4, 4) and the tool's pose."""
        axes, origins = self.joint_axes(transforms)
        mask = self._tool_moves[tool]
        jacobian = np.empty((*transforms.shape[:-3], 6, self.links))
        jacobian[..., :3, :] = (_column_velocity(axes, pose.position[..., None, :] - origins)).mT
        jacobian[..., 3:, :] = axes.mT
        if self._slides:
            jacobian[..., :3, :] = np.where(self.link_slide, axes.mT, jacobian[..., :3, :])
            jacobian[..., 3:, :] *= ~self.link_slide
        if mask is not None:
            jacobian *= mask
        return self.of_joints(jacobian)

    def joint_axes(self, transforms: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Unit axes and anchors, each (..., L, 3), about or along which the links move, in the base frame."""
        both = transforms[..., :3, :] @ self.axis_and_anchor
        return both[..., 0], both[..., 1]

    def points(self, transforms: FloatArray, link: IntArray, local: FloatArray) -> FloatArray:
        """Base-frame positions (..., K, 3), m, of points (K, 3) fixed to links (K,), -1 for the base."""
        carried = transforms.take(link, axis=-3, mode="wrap")
        moved = (carried[..., :3, :3] @ local[:, :, None])[..., 0] + carried[..., :3, 3]
        base = link < 0
        if base.any():
            moved[..., base, :] = local[base]
        return moved

    @cached_property
    def motion_constants(self) -> FloatArray:
        """(L, 3 or 4, 16), each link's transform as a linear map of [1, sin q, cos q, q].

        A turn by q about a unit axis is K² + I + sin(q) K - cos(q) K² with K = [axis]x (Rodrigues); about an
        anchor c it also shifts by c - R c. A slide by q shifts by q axis. The column for q exists only where
        some link slides.
        """
        constants = np.zeros((self.links, 4, 4, 4))
        for link in range(self.links):
            skew = (self.axis[link] @ SKEW).reshape(3, 3)
            if self.link_slide[link]:
                constants[link, 0] = np.eye(4)
                constants[link, 3, :3, 3] = self.axis[link]
            else:
                for power, turn in enumerate((skew @ skew + np.eye(3), skew, -skew @ skew)):
                    constants[link, power, :3, :3] = turn
                    constants[link, power, :3, 3] = -turn @ self.anchor[link]
                constants[link, 0, :3, 3] += self.anchor[link]
                constants[link, 0, 3, 3] = 1.0
        features = 4 if self._slides else 3
        return (self.offset[:, None] @ constants)[:, :features].reshape(self.links, features, 16)

    @cached_property
    def _children(self) -> tuple[tuple[int, int], ...]:
        return tuple((link, int(parent)) for link, parent in enumerate(self.parent) if parent >= 0)

    @cached_property
    def _slides(self) -> bool:
        return bool(self.link_slide.any())

    @cached_property
    def _moves_or_base(self) -> FloatArray:
        """(L + 1, L), `moves` as factors, with a last row of zeros for link -1."""
        return np.vstack([self.moves, np.zeros((1, self.links))]).astype(np.float64)

    @cached_property
    def _tool_moves(self) -> tuple[FloatArray | None, ...]:
        """(L,) for each tool, whether each link's displacement moves it, as factors; None where all do."""
        moves = (self._moves_or_base[tool.link] for tool in self.tools)
        return tuple(None if row.all() else row for row in moves)

    @cached_property
    def axis_and_anchor(self) -> FloatArray:
        """(L, 4, 2), homogeneous axis (a direction) and anchor (a point) of each link."""
        both = np.zeros((self.links, 4, 2))
        both[:, :3, 0] = self.axis
        both[:, :3, 1] = self.anchor
        both[:, 3, 1] = 1.0
        return both


def _column_velocity(axes: FloatArray, arms: FloatArray) -> FloatArray:
    """Cross product, several times faster than ``np.cross`` on small batches."""
    skew = (axes @ SKEW).reshape(*axes.shape[:-1], 3, 3)
    return (skew @ arms[..., None])[..., 0]


@final
@dataclass(frozen=True, eq=False)
class Capsules:
    """The shape of a robot for distances: K segments with a radius, each fixed to a link."""

    name: tuple[str, ...]  # as a person would say it ("link 5", "hand")
    link: IntArray  # (K,), -1 for the base
    start: FloatArray  # (K, 3), one end of the segment in its link's frame, m
    end: FloatArray  # (K, 3), the other end, m; equal to ``start`` for a sphere
    radius: FloatArray  # (K,), m

    def __len__(self) -> int:
        return len(self.name)

    def placed(self, chain: Chain, transforms: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Starts and ends of all segments in the base frame, each (..., K, 3), m."""
        both = chain.points(transforms, self._links_twice, self._starts_and_ends)
        return both[..., : len(self), :], both[..., len(self) :, :]

    @cached_property
    def _links_twice(self) -> IntArray:
        return np.concatenate([self.link, self.link])

    @cached_property
    def _starts_and_ends(self) -> FloatArray:
        return np.concatenate([self.start, self.end])
