"""Poses, contacts and forces in a simulated scene."""

import math
from typing import Final, final

import mujoco
import numpy as np

from latentarm.arms.scene_model import grain_body, rotation_of, thing_body
from latentarm.core.types import BoolArray, FloatArray, IntArray, Pose
from latentarm.robots.robot import Robot
from latentarm.robots.scene.scene import TABLE, TOOL, Scene, SceneState

_UNNAMED: Final = -1


@final
class SceneWatch:
    """Reads a scene out of a simulation; ``body_link`` (nbody of the robot,) is each body's link."""

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, robot: Robot, body_link: IntArray, scene: Scene
    ) -> None:
        self._data, self._scene, self._chain = data, scene, robot.chain
        self._names = (TOOL, TABLE, *scene.names)
        self._group = np.full(model.ngeom, _UNNAMED, dtype=np.int64)
        carried = np.flatnonzero(body_link == robot.chain.tools[0].link)
        self._group[np.isin(model.geom_bodyid, carried)] = 0
        self._group[model.geom(TABLE).id] = 1
        self._bodies = np.array([model.body(thing_body(thing.name)).id for thing in scene.things], dtype=int)
        for index, body in enumerate(self._bodies):
            self._group[model.geom_bodyid == body] = index + 2
        self._fingers = _fingers(model, robot)
        self._middles = model.body_ipos[self._bodies]
        first = model.body_jntadr[self._bodies]
        self._free = first >= 0
        self._positions = np.where(self._free, model.jnt_qposadr[first], _UNNAMED)
        self._speeds = np.where(self._free, model.jnt_dofadr[first], _UNNAMED)
        self._grains = {
            one.name: _grain_positions(model, one.name, len(one.positions)) for one in scene.grains
        }
        self._peaks = np.zeros((len(self._names), len(self._names)))

    def look(self) -> None:
        """Record the present forces between things."""
        pairs = self._touching()
        if pairs is None:
            return
        groups, address = pairs
        one, other = np.sort(groups, axis=1).T
        count = len(self._names)
        # The cone is elliptic: the first row of each contact is its normal force.
        forces = np.bincount(one * count + other, self._data.efc_force[address], count * count)
        np.maximum(self._peaks, forces.reshape(count, count), out=self._peaks)

    def state(self, q: FloatArray, stabbed: frozenset[str], bonds: frozenset[tuple[str, str]]) -> SceneState:
        """State of the scene with the arm at q, (n,), rad; forces begin anew."""
        self.look()
        force_n = {
            (min(pair), max(pair)): float(self._peaks[i, j])
            for i, j in zip(*np.nonzero(self._peaks > 0.0), strict=True)
            for pair in [(self._names[i], self._names[j])]
        }
        self._peaks[:] = 0.0
        poses: dict[str, Pose] = {}
        speeds: dict[str, float] = {}
        for index, thing in enumerate(self._scene.things):
            poses[thing.name], speeds[thing.name] = (
                self._moving(index) if self._free[index] else (thing.pose, 0.0)
            )
        return SceneState(
            time_s=float(self._data.time),
            tool=self._chain.forward(q),
            poses=poses,
            speed_m_s=speeds,
            stabbed=stabbed,
            gripped=self._gripped(),
            bonds=bonds,
            grains={name: start + self._data.qpos[at] for name, (start, at) in self._grains.items()},
            force_n=force_n,
        )

    def _moving(self, index: int) -> tuple[Pose, float]:
        at, speed = self._positions[index], self._speeds[index]
        place = self._data.qpos[at : at + 7]
        rotation = rotation_of(place[3:])
        vx, vy, vz, wx, wy, wz = self._data.qvel[speed : speed + 6].tolist()
        mx, my, mz = self._middles[index].tolist()
        turning = rotation @ (wy * mz - wz * my, wz * mx - wx * mz, wx * my - wy * mx)
        velocity = turning + np.array([vx, vy, vz])
        return Pose(place[:3].copy(), rotation), math.sqrt(velocity @ velocity)

    def _touching(self) -> tuple[IntArray, IntArray] | None:
        """Groups (K, 2) and addresses (K,) of the contacts between two named groups, or None."""
        if not self._data.ncon:
            return None
        contact = self._data.contact
        groups, address = self._group[contact.geom], contact.efc_address
        keep = (groups >= 0).all(axis=1) & (groups[:, 0] != groups[:, 1]) & (address >= 0)
        return (groups[keep], address[keep]) if keep.any() else None

    def _gripped(self) -> frozenset[str]:
        if not self._data.ncon or not self._fingers:
            return frozenset()
        geoms = self._data.contact.geom
        touched: list[set[int]] = []
        for finger in self._fingers:
            on = finger[geoms]
            touched.append({int(group) for group in self._group[geoms[on[:, ::-1]]]})
        both = set.intersection(*touched)
        return frozenset(self._names[group] for group in both if group > 1)


def _fingers(model: mujoco.MjModel, robot: Robot) -> list[BoolArray]:
    """For each finger of the robot's gripper, whether each geom is its own, (ngeom,)."""
    joints = () if robot.gripper is None else robot.gripper.joints
    return [model.geom_bodyid == model.jnt_bodyid[model.joint(name).id] for name in joints]


def _grain_positions(model: mujoco.MjModel, name: str, count: int) -> tuple[FloatArray, IntArray]:
    """Start of each grain, (K, 3), and addresses of its displacement in the positions, (K, 3)."""
    bodies = [model.body(grain_body(name, index)).id for index in range(count)]
    first = model.jnt_qposadr[model.body_jntadr[bodies]].reshape(-1, 1)
    return model.body_pos[bodies].copy(), first + np.arange(3)
