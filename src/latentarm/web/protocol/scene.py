"""The scene for pages: the shapes of the robot's MuJoCo model, and of its surroundings."""

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Obstacle, Sphere
from latentarm.robots.kinematics.pose_rows import thing_rows
from latentarm.robots.kinematics.reader import ModelChain, read, reference_positions
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Part
from latentarm.safety.zones import Zone
from latentarm.tasks.place import Place
from latentarm.web.protocol.report import PoseRow, SeenThing, Things

_TYPES: Final = {
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): "ellipsoid",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
    int(mujoco.mjtGeom.mjGEOM_MESH): "mesh",
}
"""Shapes that are drawn; planes and height fields belong to the scene, which comes from the task."""

_VISIBLE_GROUPS: Final = 3  # MuJoCo's own viewer shows the groups below this one

_MESH_HEADER: Final = struct.Struct("<II")

_UNMOVED: Final = np.zeros(3)
_SIZES: Final = 3  # numbers in the size of a geom, as in MuJoCo
_DIGITS: Final = 4
"""Things' positions are sent to a tenth of a millimetre, so that things at rest need not be sent again."""


@final
@dataclass(frozen=True)
class Drawable:
    """A scene as pages get it."""

    # ``/scene.json``. ``bodies`` are the base frame and the links, in the order of a state's poses, each
    # with its ``geoms``; a geom's ``pos`` and ``quat`` (w, x, y, z) are in its body's frame, its ``size``
    # is MuJoCo's. ``fingers`` are those of a gripper, closed, each with its ``geoms``, the index of the
    # ``body`` that it slides on, the direction in which it ``opens`` there, and how far it is open ``at``
    # first, m. ``zones`` are obstacles that the arm may go into, at a ``speed``, m/s, and no faster. For
    # ``things`` and ``grains`` see `described`.
    description: dict[str, object]
    # ``/mesh/ID``: uint32 vertices, uint32 faces, float32 vertices, uint32 faces, little-endian
    meshes: dict[int, bytes]


def drawable(
    place: Place, obstacles: Sequence[Obstacle], scene: Scene | None, zones: Sequence[Zone] = ()
) -> Drawable:
    """The scene: robot, goals, obstacles, slow ``zones``, and the things about the arm."""
    robot = place.robot
    model = robot.model()
    reading = read(model, [tool.name for tool in robot.chain.tools])
    geoms = _visible(model)
    fingers = _finger_of(model, () if robot.gripper is None else robot.gripper.slides)
    return Drawable(
        description={
            "version": 1,
            "robot": robot.name,
            "bodies": [
                {
                    "name": name,
                    "geoms": [
                        _geom(model, reading, geom)
                        for geom in geoms
                        if (at := int(model.geom_bodyid[geom])) not in fingers
                        and reading.body_link[at] + 1 == body
                    ],
                }
                for body, name in enumerate(
                    ("base", *(model.joint(int(joint)).name for joint in reading.link_joints))
                )
            ],
            "fingers": [
                _finger(model, reading, joint, geoms, fingers) for joint in sorted(set(fingers.values()))
            ],
            "goals": [{"name": goal.name, "position": _rounded(goal.pose.position)} for goal in place.goals],
            "obstacles": [_obstacle(one) for one in obstacles],
            "zones": [{**_obstacle(zone.shape), "speed": zone.speed} for zone in zones],
            **described(scene or Scene()),
        },
        meshes={
            int(model.geom_dataid[geom]): _mesh(model, int(model.geom_dataid[geom]))
            for geom in geoms
            if model.geom_dataid[geom] >= 0
        },
    )


def pose_of(transforms: FloatArray) -> FloatArray:
    """Transforms (K, 4, 4) as x, y, z, qw, qx, qy, qz (K, 7)."""
    quaternion = Rotation.from_matrix(transforms[:, :3, :3]).as_quat(scalar_first=True)
    return np.concatenate([transforms[:, :3, 3], quaternion], axis=1)


def _visible(model: mujoco.MjModel) -> list[int]:
    drawn = [geom for geom in range(model.ngeom) if int(model.geom_type[geom]) in _TYPES]
    return [geom for geom in drawn if model.geom_group[geom] < _VISIBLE_GROUPS] or drawn


def _finger_of(model: mujoco.MjModel, joints: Sequence[str]) -> dict[int, int]:
    """The sliding joint of each body of a finger, by the body's id."""
    found: dict[int, int] = {}
    ids = [int(model.joint(name).id) for name in joints]
    of = {int(model.jnt_bodyid[joint]): joint for joint in ids}
    for body in range(1, model.nbody):
        joint = of.get(body, found.get(int(model.body_parentid[body])))
        if joint is not None:
            found[body] = joint
    return found


def _finger(
    model: mujoco.MjModel, reading: ModelChain, joint: int, geoms: list[int], fingers: dict[int, int]
) -> dict[str, object]:
    """A finger where its joint is at zero."""
    body = int(model.jnt_bodyid[joint])
    opens = reading.body_transform[body][:3, :3] @ model.jnt_axis[joint]
    here = float(reference_positions(model)[model.jnt_qposadr[joint]])
    return {
        "body": int(reading.body_link[body]) + 1,
        "opens": _rounded(opens),
        "at": round(here, 5),
        "geoms": [
            _geom(model, reading, geom, -here * opens)
            for geom in geoms
            if fingers.get(int(model.geom_bodyid[geom])) == joint
        ],
    }


def _geom(
    model: mujoco.MjModel, reading: ModelChain, geom: int, shift: FloatArray = _UNMOVED
) -> dict[str, object]:
    """A geom in the frame of its link, shifted by ``shift`` (3,), m."""
    body = int(model.geom_bodyid[geom])
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
    in_link = reading.body_transform[body] @ _frame(model.geom_pos[geom], rotation.reshape(3, 3))
    in_link[:3, 3] += shift
    mesh, material = int(model.geom_dataid[geom]), int(model.geom_matid[geom])
    pose = _rounded(pose_of(in_link[None])[0])
    return {
        "type": _TYPES[int(model.geom_type[geom])],
        "size": _rounded(model.geom_size[geom]),
        "pos": pose[:3],
        "quat": pose[3:],
        "rgba": _rounded(model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]),
        "mesh": mesh if mesh >= 0 else None,
    }


def _mesh(model: mujoco.MjModel, mesh: int) -> bytes:
    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    first_face, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    return b"".join(
        [
            _MESH_HEADER.pack(count, faces),
            model.mesh_vert[first : first + count].astype("<f4").tobytes(),
            model.mesh_face[first_face : first_face + faces].astype("<u4").tobytes(),
        ]
    )


def _obstacle(obstacle: Obstacle) -> dict[str, object]:
    match obstacle:
        case HalfSpace(name=name, point=point, normal=normal):
            return {"name": name, "type": "plane", "point": _rounded(point), "normal": _rounded(normal)}
        case Sphere(name=name, centre=centre, radius=radius):
            return {"name": name, "type": "sphere", "centre": _rounded(centre), "radius": radius}
        case Capsule(name=name, start=start, end=end, radius=radius):
            ends = {"start": _rounded(start), "end": _rounded(end)}
            return {"name": name, "type": "capsule", "radius": radius, **ends}
        case Box(name=name, centre=centre, rotation=rotation, half_extents=half):
            pose = _rounded(pose_of(_frame(centre, rotation)[None])[0])
            placed = {"pos": pose[:3], "quat": pose[3:]}
            return {"name": name, "type": "box", "half_extents": _rounded(half), **placed}


def _frame(position: FloatArray, rotation: FloatArray) -> FloatArray:
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = rotation, position
    return frame


def _rounded(values: FloatArray, digits: int = 5) -> list[float]:
    return np.round(np.asarray(values, dtype=float), digits).tolist()


def described(scene: Scene) -> dict[str, object]:
    """The part of ``/scene.json`` about things.

    ``things``, each with its name, its ``pose`` at first, whether it is ``fixed`` there, ``geoms`` like those
    of the robot's bodies, and ``soft`` ones, which give way to everything; and ``grains``, each kind with its
    name, ``radius`` (m), ``rgba`` and first ``positions`` (m).
    """
    first = _rows({thing.name: thing.pose for thing in scene.things}, scene.names)
    return {
        "things": [
            {
                "name": thing.name,
                "pose": pose,
                "fixed": thing.fixed,
                "geoms": [_part(part) for part in thing.parts],
                "soft": [_part(part) for part in thing.soft],
            }
            for thing, pose in zip(scene.things, first, strict=True)
        ],
        "grains": [
            {
                "name": grains.name,
                "radius": grains.radius_m,
                "rgba": list(grains.colour),
                "positions": _rounded(grains.positions.ravel(), _DIGITS),
            }
            for grains in scene.grains
        ],
    }


def things_at(
    scene: Scene, poses: Mapping[str, Pose], grains: Mapping[str, FloatArray], seen: Sequence[SeenThing]
) -> Things:
    """Where everything is, in the order of the scene; ``grains`` (K, 3) by the grains' name, m."""
    return Things(
        poses=tuple(_rows(poses, scene.names)),
        grains=tuple(tuple(_rounded(grains[one.name].ravel(), _DIGITS)) for one in scene.grains),
        seen=tuple(seen),
    )


def _part(part: Part) -> dict[str, object]:
    return {
        "type": part.shape,
        "size": [*part.size, *([0.0] * (_SIZES - len(part.size)))],
        "pos": list(part.position),
        "quat": list(part.quaternion),
        "rgba": list(part.colour),
        "mesh": None,
    }


def _rows(poses: Mapping[str, Pose], names: Sequence[str]) -> list[PoseRow]:
    rows = np.round(thing_rows(poses, names), _DIGITS).tolist()
    return [(x, y, z, w, i, j, k) for x, y, z, w, i, j, k in rows]
