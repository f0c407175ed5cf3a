"""Distances of an arm's own geoms as MuJoCo measures them: no capsule and no distance code of ours."""

from typing import Any, Final, final

import mujoco
import numpy as np

from latentarm.core.types import BoolArray, FloatArray
from latentarm.robots.kinematics.distances import segment_distance
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Obstacle, Sphere
from latentarm.robots.kinematics.reader import read
from latentarm.robots.robot import Robot

NEAR_M: Final = 0.06  # distances beyond this are not worked out


@final
class Judge:
    """Distances of a robot's solid geoms by `mujoco.mj_geomDistance`.

    Two geoms of the robot are measured against each other where the product watches the capsules
    that stand for them. Pairs that no joint moves are left out.
    """

    def __init__(self, robot: Robot, obstacles: tuple[Obstacle, ...] = ()) -> None:
        spec = mujoco.MjSpec.from_string(robot.mjcf)
        for obstacle in obstacles:
            _add(spec, obstacle)
        # Some models choose libccd instead of MuJoCo's own collision code. libccd gets distances between
        # meshes wrong by centimetres, and its result depends on the distance limit of the query.
        spec.option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_NATIVECCD)
        self._model = model = spec.compile()
        self._data = mujoco.MjData(model)
        reading = read(model, [tool.name for tool in robot.chain.tools])
        self._address = model.jnt_qposadr[reading.joints]
        # Whatever obstacles were added carry a name that no geom of a robot has.
        things = [g for g in range(model.ngeom) if model.geom(g).name.startswith(_MARK)]
        capsule = {g: standing_for(robot, model, reading, g) for g in solid_geoms(model) if g not in things}
        capsule = {g: k for g, k in capsule.items() if k is not None}
        watched = {frozenset(pair) for pair in robot.self_pairs.tolist()}
        own = list(capsule)
        pairs = [(g, thing) for g in own if robot.capsules.link[capsule[g]] >= 0 for thing in things]
        pairs += [
            (g, h)
            for i, g in enumerate(own)
            for h in own[i + 1 :]
            if frozenset((capsule[g], capsule[h])) in watched
        ]
        self._pairs = pairs
        limits = robot.limits
        sampled = np.random.default_rng(0).uniform(limits.lower, limits.upper, (12, robot.dof))
        moved = np.ptp([self.distances(q, 10.0) for q in sampled], axis=0) > 1e-6
        self._pairs = [pair for pair, moves in zip(pairs, moved, strict=True) if moves]

    def distances(
        self,
        q: FloatArray,  # (n,), rad
        most_m: float = NEAR_M,  # what stands for any longer distance, m
    ) -> FloatArray:
        """(pairs,), m."""
        self._data.qpos[self._address] = q
        mujoco.mj_kinematics(self._model, self._data)
        return np.array(
            [mujoco.mj_geomDistance(self._model, self._data, g, h, most_m, None) for g, h in self._pairs]
        )

    def pairs_of(self, body: str) -> tuple[BoolArray, list[str]]:
        """Which pairs have a geom of the body of this name, (pairs,), and their other geoms."""
        pairs = np.array([[int(g), int(h)] for g, h in self._pairs]).reshape(-1, 2)
        mine = self._model.geom_bodyid[pairs] == self._model.body(body).id
        others = np.where(mine[:, 0], pairs[:, 1], pairs[:, 0])
        names = [self._model.geom(int(one)).name.removeprefix(_MARK) or str(one) for one in others]
        return mine.any(axis=1), names


_MARK: Final = "obstacle "


def _add(spec: mujoco.MjSpec, obstacle: Obstacle) -> None:
    geom = spec.worldbody.add_geom(name=_MARK + obstacle.name)
    match obstacle:
        case HalfSpace():
            geom.type, geom.size, geom.pos = mujoco.mjtGeom.mjGEOM_PLANE, [9, 9, 1], obstacle.point
            mujoco.mju_quatZ2Vec(geom.quat, obstacle.normal)
        case Sphere():
            geom.type, geom.size = mujoco.mjtGeom.mjGEOM_SPHERE, [obstacle.radius, 0, 0]
            geom.pos = obstacle.centre
        case Capsule():
            geom.type, geom.size = mujoco.mjtGeom.mjGEOM_CAPSULE, [obstacle.radius, 0, 0]
            geom.fromto = [*obstacle.start, *obstacle.end]
        case Box():
            geom.type, geom.size = mujoco.mjtGeom.mjGEOM_BOX, obstacle.half_extents
            geom.pos = obstacle.centre
            mujoco.mju_mat2Quat(geom.quat, obstacle.rotation.ravel())


def solid_geoms(model: Any) -> list[int]:
    """Geoms that collide, and the visual ones of bodies where none does; no planes."""
    found: list[int] = []
    for body in range(model.nbody):
        first, count = int(model.body_geomadr[body]), int(model.body_geomnum[body])
        geoms = [g for g in range(first, first + count) if model.geom_type[g] != mujoco.mjtGeom.mjGEOM_PLANE]
        colliding = [g for g in geoms if model.geom_contype[g] or model.geom_conaffinity[g]]
        found += colliding or geoms
    return found + [
        g
        for g in range(model.ngeom)
        if model.geom_type[g] == mujoco.mjtGeom.mjGEOM_PLANE and model.geom(g).name.startswith(_MARK)
    ]


def surface(model: Any, geom: int) -> FloatArray:
    """(N, 3), points of a geom's surface in its body's frame, the extreme ones among them, m."""
    size = model.geom_size[geom]
    out = np.random.default_rng(0).normal(size=(500, 3))
    out = np.concatenate([out / np.linalg.norm(out, axis=1, keepdims=True), np.eye(3), -np.eye(3)])
    up = np.sign(out[:, 2:]) * [0.0, 0.0, 1.0]
    match mujoco.mjtGeom(int(model.geom_type[geom])):
        case mujoco.mjtGeom.mjGEOM_MESH:
            mesh = model.geom_dataid[geom]
            points = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            points = size[0] * out
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            points = size[0] * out + size[1] * up
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            round_it = np.hypot(out[:, 0], out[:, 1])[:, None] + 1e-12
            points = size[0] * out * [1, 1, 0] / round_it + size[1] * up
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            points = size * out
        case mujoco.mjtGeom.mjGEOM_BOX:
            points = size * np.sign(out)
        case kind:
            raise ValueError(f"no surface for a geom of type {kind}")
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
    return points @ rotation.reshape(3, 3).T + model.geom_pos[geom]


def outside(robot: Robot, model: Any, reading: Any, geom: int) -> tuple[FloatArray, list[int]]:
    """How far a geom is outside each capsule of its link, (capsules, N), m; and which capsules these are."""
    body = int(model.geom_bodyid[geom])
    to_link = reading.body_transform[body]
    points = surface(model, geom) @ to_link[:3, :3].T + to_link[:3, 3]
    capsules = robot.capsules
    mine = np.flatnonzero(capsules.link == reading.body_link[body]).tolist()
    return np.array(
        [
            segment_distance(points, points, capsules.start[k], capsules.end[k])[0] - capsules.radius[k]
            for k in mine
        ]
    ).reshape(len(mine), -1), mine


def standing_for(robot: Robot, model: Any, reading: Any, geom: int) -> int | None:
    """The capsule that a geom sticks out of least, or None for what is not part of the robot."""
    gaps, mine = outside(robot, model, reading, geom)
    if not mine or model.geom_bodyid[geom] == 0:
        return None
    return mine[int(np.argmin(gaps.max(axis=1)))]
