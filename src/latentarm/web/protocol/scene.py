"""What a page draws: the shapes of the robot's MuJoCo model, and of its surroundings."""

import struct
from dataclasses import dataclass
from typing import Final, final

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.kinematics.obstacles import Box, Capsule, HalfSpace, Obstacle, Sphere
from latentarm.kinematics.reader import ModelChain, read
from latentarm.tasks.task import Task
from latentarm.types import FloatArray

_TYPES: Final = {
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): "ellipsoid",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
    int(mujoco.mjtGeom.mjGEOM_MESH): "mesh",
}
"""Shapes that are drawn; planes and height fields belong to the scene, which comes from the task."""

_VISIBLE_GROUPS: Final = 3
"""MuJoCo's own viewer shows the groups below this one."""

_MESH_HEADER: Final = struct.Struct("<II")


@final
@dataclass(frozen=True)
class Scene:
    """What a page draws.

    Attributes:
        description: ``/scene.json``. ``bodies`` are the base frame and the links, in the order of a state's
            poses, each with its ``geoms``; a geom's ``pos`` and ``quat`` (w, x, y, z) are in its body's
            frame, its ``size`` is MuJoCo's.
        meshes: ``/mesh/ID``: uint32 vertices, uint32 faces, float32 vertices, uint32 faces, little-endian.
    """

    description: dict[str, object]
    meshes: dict[int, bytes]


def scene_of(task: Task) -> Scene:
    """What a page draws of a task: its robot, its goals, its obstacles, and from where to look.

    Args:
        task: the task.
    """
    robot = task.robot
    model = robot.model()
    reading = read(model, [tool.name for tool in robot.chain.tools])
    geoms = _visible(model)
    positions = [goal.pose.position for goal in task.goals]
    return Scene(
        description={
            "version": 1,
            "robot": robot.name,
            "bodies": [
                {
                    "name": name,
                    "geoms": [
                        _geom(model, reading, geom)
                        for geom in geoms
                        if reading.body_link[model.geom_bodyid[geom]] + 1 == body
                    ],
                }
                for body, name in enumerate(("base", *robot.joint_names))
            ],
            "goals": [{"name": goal.name, "position": _rounded(goal.pose.position)} for goal in task.goals],
            "obstacles": [_obstacle(one) for one in task.obstacles],
            "cameras": _cameras(robot.chain.link_transforms(robot.home)[:, :3, 3], positions),
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


def _geom(model: mujoco.MjModel, reading: ModelChain, geom: int) -> dict[str, object]:
    body = int(model.geom_bodyid[geom])
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
    in_link = reading.body_transform[body] @ _frame(model.geom_pos[geom], rotation.reshape(3, 3))
    mesh = int(model.geom_dataid[geom])
    pose = _rounded(pose_of(in_link[None])[0])
    return {
        "type": _TYPES[int(model.geom_type[geom])],
        "size": _rounded(model.geom_size[geom]),
        "pos": pose[:3],
        "quat": pose[3:],
        "rgba": _rounded(_colour(model, geom)),
        "mesh": mesh if mesh >= 0 else None,
    }


def _colour(model: mujoco.MjModel, geom: int) -> FloatArray:
    material = int(model.geom_matid[geom])
    return model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]


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


def _cameras(joints: FloatArray, goals: list[FloatArray]) -> dict[str, object]:
    """From where the arm and its goals are in view: from the front, and from its right side."""
    seen = np.concatenate([joints, np.zeros((1, 3)), np.array(goals).reshape(-1, 3)])
    lower, upper = seen.min(axis=0), seen.max(axis=0)
    return {
        "target": _rounded((lower + upper) / 2.0),
        "radius": round(float(np.linalg.norm(upper - lower)) / 2.0 + 0.15, 3),
        "up": [0.0, 0.0, 1.0],
        "front": [1.0, 0.0, 0.35],
        "side": [0.0, -1.0, 0.35],
    }


def _frame(position: FloatArray, rotation: FloatArray) -> FloatArray:
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = rotation, position
    return frame


def _rounded(values: FloatArray) -> list[float]:
    return [round(float(value), 5) for value in values]
