"""Push arms towards harm, and let MuJoCo say how near they came.

Each drive starts an arm in a random pose, with a table and a wall, box, ball or rod near it. A simulated
person pushes one point of the arm at the obstacle, or at another part of the arm, with full input, and
then stops. The product keeps its distance by its own capsules and its own distance code. Here
`mujoco.mj_geomDistance` measures the geoms of the robot's model (meshes by their convex hulls) against
obstacles that are geoms as well, so a fault in the product's shapes or distances shows.

    python scripts/clearance_drives.py                 # 2,000 drives, in minutes
    python scripts/clearance_drives.py --drives 50

The exit status is 1 if an arm came closer than it may.
"""

import argparse
import sys
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.control.step import Step
from latentarm.core.types import Context, FloatArray, GripperReading, Input, Reading
from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.distances import segment_distance
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Obstacle, Sphere
from latentarm.robots.kinematics.reader import read
from latentarm.robots.robot import Robot
from latentarm.safety.config import SafetyConfig

CLEARANCE_M = SafetyConfig().clearance
ROUNDING_M = 1e-5
"""`mj_geomDistance` stops improving a distance between meshes at about a micrometre."""

START_M = 0.03
NEAR_M = 0.06
"""Distances beyond this are not worked out."""

PERIODS_S = (0.001, 0.01, 0.02)
PUSH_S = 2.0
LOOK_S = 0.02
HARMS = ("wall", "box", "ball", "rod", "itself")
ARMS = ("panda", "planar", "planar2", "ur5e", "jaco")


def arm(name: str) -> Robot:
    """One of `ARMS`: three of ours, two from other people's packages."""
    match name:
        case "ur5e":
            return load_robot(_shipped("airo_models", "arms/ur5e/ur5e.urdf"), "tool0")
        case "jaco":
            return load_robot(_shipped("dm_control", "third_party/kinova/jaco_arm.xml"))
        case _:
            return load_robot(name)


def _shipped(package: str, file: str) -> str:
    spec = find_spec(package)
    if spec is None or not spec.submodule_search_locations:
        raise SystemExit(f"Install the dev extra: {package} is missing.")
    return str(Path(next(iter(spec.submodule_search_locations))) / file)


class Judge:
    """Distances of a robot's solid geoms by `mujoco.mj_geomDistance`.

    Two geoms of the robot are measured against each other where the product watches the capsules
    that stand for them. Pairs that no joint moves are left out.

    Args:
        robot: the arm.
        obstacles: what stands near it.
    """

    def __init__(self, robot: Robot, obstacles: tuple[Obstacle, ...] = ()) -> None:
        spec = mujoco.MjSpec.from_string(robot.mjcf)
        for obstacle in obstacles:
            _add(spec, obstacle)
        # Some models turn MuJoCo's own collision code off for libccd, whose distances between meshes are
        # wrong by centimetres and change with the largest distance that is asked for.
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
            (g, h) for i, g in enumerate(own) for h in own[i + 1 :] if {capsule[g], capsule[h]} in watched
        ]
        self._pairs = pairs
        limits = robot.limits
        sampled = np.random.default_rng(0).uniform(limits.lower, limits.upper, (12, robot.dof))
        moved = np.ptp([self.distances(q, 10.0) for q in sampled], axis=0) > 1e-6
        self._pairs = [pair for pair, moves in zip(pairs, moved, strict=True) if moves]

    def distances(self, q: FloatArray, most_m: float = NEAR_M) -> FloatArray:
        """(pairs,), m.

        Args:
            q: (n,), rad.
            most_m: what stands for any longer distance, m.
        """
        self._data.qpos[self._address] = q
        mujoco.mj_kinematics(self._model, self._data)
        return np.array(
            [mujoco.mj_geomDistance(self._model, self._data, g, h, most_m, None) for g, h in self._pairs]
        )


_MARK = "obstacle "


def _add(spec: mujoco.MjSpec, obstacle: Obstacle) -> None:
    geom = spec.worldbody.add_geom(name=_MARK + obstacle.name)
    match obstacle:
        case HalfSpace():
            geom.type, geom.size, geom.pos = mujoco.mjtGeom.mjGEOM_PLANE, [9, 9, 1], obstacle.point
            mujoco.mju_quatZ2Vec(geom.quat, obstacle.normal)
        case Sphere():
            geom.type, geom.size, geom.pos = (
                mujoco.mjtGeom.mjGEOM_SPHERE,
                [obstacle.radius, 0, 0],
                obstacle.centre,
            )
        case Capsule():
            geom.type, geom.size = mujoco.mjtGeom.mjGEOM_CAPSULE, [obstacle.radius, 0, 0]
            geom.fromto = [*obstacle.start, *obstacle.end]
        case Box():
            geom.type, geom.size, geom.pos = (
                mujoco.mjtGeom.mjGEOM_BOX,
                obstacle.half_extents,
                obstacle.centre,
            )
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


class Pusher(Controller):
    """Moves the arm as it is told, with one axis of input."""

    def __init__(self, dof: int) -> None:
        self.wanted: FloatArray = np.zeros(dof)

    @property
    def modes(self) -> tuple[str, ...]:
        """See the base class."""
        return ("push",)

    @property
    def input_dim(self) -> int:
        """See the base class."""
        return 1

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        """See the base class."""
        return u

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """See the base class."""
        return z * self.wanted


@dataclass
class Push:
    """A point of the arm, and where it is pushed to.

    Attributes:
        robot: the arm.
        link: the link that carries the point.
        local: (3,), the point in its link's frame, m.
        target: (3,), where to, m; None for another part of the arm.
        other: the capsule that it is pushed to where there is no target.
    """

    robot: Robot
    link: int
    local: FloatArray
    target: FloatArray | None
    other: int = 0

    def at(self, q: FloatArray) -> FloatArray:
        """The point in the base frame, (..., 3), m, for configurations (..., n)."""
        transforms = self.robot.chain.link_transforms(q)
        return self.robot.chain.points(transforms, np.array([self.link]), self.local[None])[..., 0, :]

    def towards(self, q: FloatArray) -> FloatArray:
        """(n,), the steepest way there, twice as fast as the fastest joint could be wanted, rad/s."""
        target = self.target
        if target is None:
            chain, capsules = self.robot.chain, self.robot.capsules
            start, end = capsules.placed(chain, chain.link_transforms(q))
            target = 0.5 * (start + end)[self.other]
        nudge = 1e-5 * np.eye(len(q))
        slope = (self.at(q + nudge) - self.at(q - nudge)) @ (target - self.at(q))
        return 2.0 * slope / max(float(np.abs(slope).max()), 1e-12)


def scene(
    robot: Robot, harm: str, rng: np.random.Generator
) -> tuple[tuple[Obstacle, ...], Judge, FloatArray, Push]:
    """Obstacles, their judge, a start and a push, with all distances above `START_M`."""
    limits, capsules, chain = robot.limits, robot.capsules, robot.chain
    outer = np.flatnonzero(capsules.link >= max(1, robot.dof // 3))
    while True:
        q = rng.uniform(limits.lower + 0.15, limits.upper - 0.15)
        starts, ends = capsules.placed(chain, chain.link_transforms(q))
        k, share = int(rng.choice(outer)), rng.uniform()
        local = (1 - share) * capsules.start[k] + share * capsules.end[k]
        at = (1 - share) * starts[k] + share * ends[k]
        out = rng.normal(size=3)
        if robot.name.startswith("planar"):
            out[2] = 0.0
        out /= np.linalg.norm(out)
        gap = capsules.radius[k] + rng.uniform(0.04, 0.2)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
        table = HalfSpace("table", np.zeros(3), np.array([0.0, 0.0, 1.0]))
        size = rng.uniform(0.02, 0.1)
        middle = at + (gap + size) * out
        match harm:
            case "wall":
                thing = HalfSpace("wall", at + gap * out, -out)
            case "ball":
                thing = Sphere("ball", middle, size)
            case "rod":
                across = np.cross(out, turn[:, 0]) * rng.uniform(0.1, 0.4)
                thing = Capsule("rod", middle - across, middle + across, size)
            case _:
                thing = Box("box", middle, turn, rng.uniform(0.3, 1.0, 3) * size)
        obstacles = (table,) if harm == "itself" else (table, thing)
        far = np.flatnonzero(np.abs(capsules.link - capsules.link[k]) > 1)
        target = None if harm == "itself" else middle
        push = Push(robot, int(capsules.link[k]), local, target, int(rng.choice(far)))
        judge = Judge(robot, obstacles)
        if judge.distances(q).min() > START_M:
            return obstacles, judge, q, push


@dataclass
class Seen:
    """What came of the drives of one arm.

    Attributes:
        drives: how many there were.
        least_m: the least distance, m.
        near: drives that came within twice the clearance.
        too_near: drives that came closer than they may: arm, harm, seed and the distance, m.
    """

    drives: int = 0
    least_m: float = np.inf
    near: int = 0
    too_near: list[tuple[str, str, int, float]] = field(default_factory=list)


def drive(robot: Robot, harm: str, period_s: float, rng: np.random.Generator) -> float:
    """The least distance of one drive, m."""
    obstacles, judge, q, push = scene(robot, harm, rng)
    controller = Pusher(robot.dof)
    step = Step(robot, controller, SafetyConfig(obstacles=obstacles), dt_s=period_s)
    step.reset(q)
    at_rest = np.zeros(robot.dof)
    hand = None if robot.gripper is None else GripperReading(robot.gripper.width_m)
    step(Input(np.zeros(1)), 0.0, Reading(q, at_rest, 0.0, 0, hand), 0.0)
    if step.enable() is not None:
        raise RuntimeError("the arm could not be enabled")
    ticks, look = round(PUSH_S / period_s), round(LOOK_S / period_s)
    least = np.inf
    for tick in range(ticks + round(0.3 / period_s)):
        if tick == ticks:
            step.stop("The drive is over.")
        if tick % max(1, round(0.05 / period_s)) == 0:
            controller.wanted = push.towards(q)
        now_s = (tick + 1) * period_s
        record = step(Input(np.ones(1)), 0.0, Reading(q, at_rest, now_s, tick + 1, hand), now_s)
        if record.command.stop is not None and tick < ticks:
            raise RuntimeError(f"stopped: {record.command.stop.reason}")
        q = q + record.command.velocity * period_s
        if tick % look == 0:
            least = min(least, float(judge.distances(q).min()))
    return least


def main() -> int:
    """All drives, one row per arm."""
    parser = argparse.ArgumentParser(description="Distances that arms keep, as MuJoCo measures them.")
    parser.add_argument("--drives", type=int, default=2000, help="how many, over all arms")
    parser.add_argument("--first", type=int, default=0, help="number of the first, to go on from")
    chosen = parser.parse_args()
    seen = {name: Seen() for name in ARMS}
    robots = {name: arm(name) for name in ARMS}
    for number in range(chosen.first, chosen.first + chosen.drives):
        name, harm = ARMS[number % len(ARMS)], HARMS[number // len(ARMS) % len(HARMS)]
        period_s = PERIODS_S[number // 25 % len(PERIODS_S)]
        least = drive(robots[name], harm, period_s, np.random.default_rng([0, number]))
        arms = seen[name]
        arms.drives += 1
        arms.least_m = min(arms.least_m, least)
        arms.near += least < 2 * CLEARANCE_M
        if least < CLEARANCE_M - ROUNDING_M:
            arms.too_near.append((name, harm, number, least))
    print(f"{'arm':<10}{'drives':>8}{'near':>8}{'least, mm':>12}{'too near':>10}")
    for name, arms in seen.items():
        least_mm = f"{1000 * arms.least_m:.3f}"
        print(f"{name:<10}{arms.drives:>8}{arms.near:>8}{least_mm:>12}{len(arms.too_near):>10}")
    for arms in seen.values():
        for name, harm, number, least in arms.too_near:
            print(f"too near: {name}, {harm}, drive {number}: {1000 * least:.3f} mm")
    return int(any(arms.too_near for arms in seen.values()))


if __name__ == "__main__":
    sys.exit(main())
