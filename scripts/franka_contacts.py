"""What of a simulated Franka touches itself where the safety filters let the arm be, and how far apart it is.

Random postures of an FR3 that keep the clearance from the arm itself and from the floor are put into
franky-sim (see `tests/stand_ins/franka_server.py`). MuJoCo takes convex hulls for the shapes of the links.
This counts postures in which two hulls overlap, as franky-sim has them and as the stand-in does, and gives
the least distance of the meshes that the manufacturer draws, for each pair that touched and each turn of
joint 7. It needs trimesh, scipy and python-fcl besides the development environment:

    python scripts/franka_contacts.py --postures 40000
"""

import argparse
import json
import math
import sys
from collections import Counter
from pathlib import Path
from typing import Any, Final, final

import mujoco
import numpy as np
import trimesh
from franky_sim.mujoco_simulator import MujocoSimulator

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "stand_ins"))

from franka_server import DAMPING, START, STIFFNESS, part_forearm

from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.obstacles import HalfSpace
from latentarm.robots.panda import fr3
from latentarm.safety.body import Body, Placement
from latentarm.safety.config import SafetyConfig
from latentarm.safety.proximity import Proximity

FLOOR: Final = HalfSpace("floor", np.zeros(3), np.array([0.0, 0.0, 1.0]))
MARGIN_RAD: Final = SafetyConfig().joint_margin
CLEARANCE_M: Final = SafetyConfig().clearance
TURNS: Final = 60
"""Positions of joint 7 at which meshes are compared, at the lower end of joint 6."""

Pair = tuple[str, str]


@final
class Simulated:
    """franky-sim's model, to put into postures.

    Args:
        robot: of a running `MujocoSimulator`.
    """

    def __init__(self, robot: Any) -> None:
        self.model: mujoco.MjModel = robot._model
        self._data: mujoco.MjData = robot._data
        self._at = list(robot._qpos_addrs)

    def put(self, q: FloatArray) -> None:
        """Into a posture (7,), rad."""
        self._data.qpos[self._at] = q
        mujoco.mj_forward(self.model, self._data)

    def touching(self) -> set[Pair]:
        """The pairs of bodies whose hulls overlap."""
        return {
            tuple(sorted(self._body(int(geom)) for geom in contact.geom))
            for contact in self._data.contact
            if contact.dist < 0.0
        }

    def apart_m(self, pair: Pair) -> float:
        """The least distance of the drawn meshes of two bodies, m."""
        one, other = (self._meshes(name) for name in pair)
        return float(one.min_distance_other(other))

    def _body(self, geom: int) -> str:
        return str(self.model.body(self.model.geom_bodyid[geom]).name)

    def _meshes(self, body: str) -> trimesh.collision.CollisionManager:
        found = trimesh.collision.CollisionManager()
        for geom in np.flatnonzero(self.model.geom_contype == 0):
            if self._body(int(geom)) != body:
                continue
            mesh = self.model.mesh(self.model.geom_dataid[geom])
            vertices = self.model.mesh_vert[int(mesh.vertadr[0]) :][: int(mesh.vertnum[0])]
            faces = self.model.mesh_face[int(mesh.faceadr[0]) :][: int(mesh.facenum[0])]
            pose = np.eye(4)
            pose[:3, :3] = self._data.geom_xmat[geom].reshape(3, 3)
            pose[:3, 3] = self._data.geom_xpos[geom]
            found.add_object(str(geom), trimesh.Trimesh(vertices, faces, process=False), transform=pose)
        return found


def allowed_postures(count: int, seed: int) -> FloatArray:
    """Those of so many random postures that the safety filters allow, (N, 7), rad."""
    robot, rng = fr3(), np.random.default_rng(seed)
    body = Body(robot)
    proximity = Proximity(body, (FLOOR,), math.inf, CLEARANCE_M, 1.0)
    lower, upper = robot.limits.lower + MARGIN_RAD, robot.limits.upper - MARGIN_RAD
    found = []
    for q in rng.uniform(lower, upper, (count, 7)):
        heights = proximity.measured(Placement(body, q), np.zeros(7)).height
        if not len(heights) or heights.min() >= CLEARANCE_M:
            found.append(q)
    return np.array(found)


def main() -> None:
    """Print the figures as JSON."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--postures", type=int, default=40_000)
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    postures = allowed_postures(chosen.postures, chosen.seed)
    figures: dict[str, Any] = {"postures": chosen.postures, "allowed": len(postures)}
    with MujocoSimulator() as simulator:
        robot = simulator.add_robot(initial_q=START, kp=STIFFNESS, kv=DAMPING)
        simulator.start()
        simulated = Simulated(robot)
        touching: Counter[Pair] = Counter()
        apart_m: dict[Pair, float] = {}
        for q in postures:
            simulated.put(q)
            for pair in simulated.touching():
                touching[pair] += 1
                apart_m[pair] = min(apart_m.get(pair, math.inf), simulated.apart_m(pair))
        lowest = fr3().limits.lower[5] + MARGIN_RAD
        for turn in np.linspace(-2.8, 2.8, TURNS):
            simulated.put(np.array([*START[:5], lowest, turn]))
            apart_m = {pair: min(least, simulated.apart_m(pair)) for pair, least in apart_m.items()}
        figures["hulls_overlap"] = {" and ".join(pair): count for pair, count in touching.items()}
        figures["meshes_apart_mm"] = {" and ".join(pair): round(1e3 * m, 1) for pair, m in apart_m.items()}
        part_forearm(simulated.model)
        left: Counter[Pair] = Counter()
        for q in postures:
            simulated.put(q)
            left.update(simulated.touching())
        figures["hulls_overlap_in_stand_in"] = {" and ".join(pair): count for pair, count in left.items()}
    print(json.dumps(figures, indent=2))


if __name__ == "__main__":
    main()
