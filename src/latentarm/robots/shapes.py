"""A robot's capsules, from the geoms of any MuJoCo model, and the pairs of them that could collide."""

from collections.abc import Sequence
from itertools import combinations

import mujoco
import numpy as np
from scipy.spatial import ConvexHull, QhullError

from latentarm.core.types import BoolArray, FloatArray, IntArray
from latentarm.robots.kinematics.chain import Capsules, Chain
from latentarm.robots.kinematics.distances import segment_distance
from latentarm.robots.kinematics.reader import ModelChain, reference_positions
from latentarm.robots.limits import JointLimits

# NumPy integers never equal MuJoCo's enums: compare plain integers.
_PLANE = int(mujoco.mjtGeom.mjGEOM_PLANE)
_SPHERE = int(mujoco.mjtGeom.mjGEOM_SPHERE)
_CAPSULE = int(mujoco.mjtGeom.mjGEOM_CAPSULE)
_CYLINDER = int(mujoco.mjtGeom.mjGEOM_CYLINDER)
_MESH = int(mujoco.mjtGeom.mjGEOM_MESH)
PER_BODY = 2  # capsules that one body keeps; more are merged, so that distances stay cheap online
PER_LINK = 4  # capsules that one link keeps, over all the bodies fixed to it
Balls = tuple[FloatArray, FloatArray]
"""Centres (K, 3), m, and radii (K,), m, of balls whose convex hull covers a shape."""


def read_capsules(
    model: mujoco.MjModel, reading: ModelChain, sliding: Sequence[str] = (), apart: Sequence[str] = ()
) -> Capsules:
    """Capsules that cover a robot: its moving links and the fixed bodies that carry them.

    Spheres and capsules stay as they are; a cylinder becomes the capsule around its axis; boxes, meshes and
    other geoms become the capsule around their corners or vertices. Visual geoms count only for bodies
    without colliding ones. Scenery (planes, geoms of the world, bodies that do not carry the robot) belongs
    to the task.

    ``sliding`` names joints that move independently, such as those of a gripper's fingers: their bodies are
    covered wherever they slide. ``apart`` names bodies whose capsules merge with no other body's, such as
    those of a fork, which must come close to things.
    """
    slides = _slides(model, reading, sliding)
    by_link: dict[int, list[tuple[str, Balls]]] = {}
    for body in range(1, model.nbody):
        if not _belongs(model, reading, body):
            continue
        placed = [_balls(model, geom, reading.body_transform[body]) for geom in _solid_geoms(model, body)]
        pieces = [_swept(balls, slides.get(body, _UNMOVED)) for balls in placed]
        name = body_name(model, body)
        kept = _merged([(name, piece) for piece in pieces], PER_BODY)
        by_link.setdefault(int(reading.body_link[body]), []).extend(kept)
    names: list[str] = []
    links: list[int] = []
    shapes: list[tuple[FloatArray, FloatArray, float]] = []
    for link, pieces in sorted(by_link.items()):
        alone = [piece for piece in pieces if piece[0] in apart]
        others = [piece for piece in pieces if piece[0] not in apart]
        for name, balls in [*_merged(others, PER_LINK), *alone]:
            names.append(name)
            links.append(link)
            shapes.append(bounding_capsule(*balls))
    return Capsules(
        name=tuple(names),
        link=np.array(links, dtype=np.int64),
        start=np.array([start for start, _, _ in shapes]).reshape(-1, 3),
        end=np.array([end for _, end, _ in shapes]).reshape(-1, 3),
        radius=np.array([radius for _, _, radius in shapes]),
    )


_UNMOVED: FloatArray = np.zeros((1, 3))


def _slides(model: mujoco.MjModel, reading: ModelChain, joints: Sequence[str]) -> dict[int, FloatArray]:
    """For each body that the sliding joints move: (2, 3), from its reference position to both ends, m."""
    reference = reference_positions(model)
    found: dict[int, FloatArray] = {}
    for name in joints:
        joint = model.joint(name).id
        at = reference[model.jnt_qposadr[joint]]
        own = int(model.jnt_bodyid[joint])
        axis = reading.body_transform[own][:3, :3] @ model.jnt_axis[joint]
        found[own] = (model.jnt_range[joint] - at)[:, None] * axis
    for body in range(1, model.nbody):
        parent = int(model.body_parentid[body])
        if parent in found:
            found[body] = found[parent]
    return found


def _swept(balls: Balls, slides: FloatArray) -> Balls:
    centres, radii = balls
    return (centres + slides[:, None]).reshape(-1, 3), np.tile(radii, len(slides))


def body_name(model: mujoco.MjModel, body: int) -> str:
    """Name of a body's capsules."""
    return str(model.body(body).name) or f"body {body}"


def bounding_capsule(centres: FloatArray, radii: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Ends, each (3,), and radius, m, of the smallest capsule along several axes around balls."""
    spread = centres - centres.mean(axis=0)
    farthest = spread[np.argmax(np.vecdot(spread, spread))]
    longest = centres[np.argmax(np.linalg.norm(centres - centres.mean(axis=0) - farthest, axis=1))]
    candidates = [*np.linalg.svd(spread, full_matrices=False)[2], *np.eye(3)]
    direction = longest - centres.mean(axis=0) - farthest
    if np.linalg.norm(direction) > 0.0:
        candidates.append(direction / np.linalg.norm(direction))
    found = [_capsule_along(axis, centres, radii) for axis in candidates]
    return min(found, key=_volume)


def convex_hull_vertices(points: FloatArray) -> FloatArray:
    """The points (H, 3) that span the convex hull; all points where they lie in one plane or line."""
    try:
        return points[ConvexHull(points).vertices]
    except (QhullError, ValueError):  # flat, or fewer than four points
        return points


def _capsule_along(
    axis: FloatArray, centres: FloatArray, radii: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """The capsule around balls whose segment runs along a unit axis between them."""
    along = centres @ axis
    across = centres - along[:, None] * axis
    middle = 0.5 * ((across - radii[:, None]).min(axis=0) + (across + radii[:, None]).max(axis=0))
    middle -= (middle @ axis) * axis
    away = np.linalg.norm(across - middle, axis=1)
    radius = float(np.max(away + radii))
    # A ball is inside while the segment reaches to within radius - r of its centre.
    reach = np.sqrt(np.maximum((radius - radii) ** 2 - away**2, 0.0))
    low, high = float(np.min(along + reach)), float(np.max(along - reach))
    if low > high:
        low = high = 0.5 * (low + high)
    return middle + low * axis, middle + high * axis, radius


def _volume(capsule: tuple[FloatArray, FloatArray, float]) -> float:
    start, end, radius = capsule
    return float(np.pi * radius**2 * (np.linalg.norm(end - start) + 4.0 / 3.0 * radius))


def _merged(pieces: list[tuple[str, Balls]], most: int) -> list[tuple[str, Balls]]:
    """At most ``most`` capsules, merged two by two where that adds the least volume."""
    kept = [(name, _as_balls(bounding_capsule(*balls))) for name, balls in pieces]
    while len(kept) > most:
        joined = {
            (i, j): bounding_capsule(
                np.concatenate([kept[i][1][0], kept[j][1][0]]), np.concatenate([kept[i][1][1], kept[j][1][1]])
            )
            for i, j in combinations(range(len(kept)), 2)
        }
        volumes = [_volume(bounding_capsule(*balls)) for _, balls in kept]
        i, j = min(joined, key=lambda pair: _volume(joined[pair]) - volumes[pair[0]] - volumes[pair[1]])
        name, other = kept[i][0], kept[j][0]
        kept[i] = (name if name == other else f"{name} + {other}", _as_balls(joined[i, j]))
        del kept[j]
    return kept


def _as_balls(capsule: tuple[FloatArray, FloatArray, float]) -> Balls:
    start, end, radius = capsule
    return np.stack([start, end]), np.array([radius, radius])


def _belongs(model: mujoco.MjModel, reading: ModelChain, body: int) -> bool:
    """Whether a body is part of the robot: moved by it, carrying it, or fixed to a body that carries it."""
    if reading.body_link[body] >= 0:
        return True
    while body > 0:
        if body in reading.base_bodies:
            return True
        body = int(model.body_parentid[body])
    return False


def _solid_geoms(model: mujoco.MjModel, body: int) -> list[int]:
    first = int(model.body_geomadr[body])
    own = range(first, first + int(model.body_geomnum[body]))
    geoms = [geom for geom in own if model.geom_type[geom] != _PLANE]
    colliding = [geom for geom in geoms if model.geom_contype[geom] or model.geom_conaffinity[geom]]
    return colliding or geoms


def _balls(model: mujoco.MjModel, geom: int, body_transform: FloatArray) -> Balls:
    """Balls that cover a geom, in its link's frame."""
    kind, size = model.geom_type[geom], model.geom_size[geom]
    if kind == _SPHERE:
        centres, radius = np.zeros((1, 3)), float(size[0])
    elif kind in (_CAPSULE, _CYLINDER):
        centres, radius = np.array([[0.0, 0.0, -size[1]], [0.0, 0.0, size[1]]]), float(size[0])
    elif kind == _MESH:
        mesh = int(model.geom_dataid[geom])
        first = int(model.mesh_vertadr[mesh])
        vertices = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])].astype(np.float64)
        centres, radius = convex_hull_vertices(vertices), 0.0
    else:
        middle, half = model.geom_aabb[geom][:3], model.geom_aabb[geom][3:]
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        centres, radius = middle + signs * half, 0.0
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
    in_body = centres @ rotation.reshape(3, 3).T + model.geom_pos[geom]
    placed = in_body @ body_transform[:3, :3].T + body_transform[:3, 3]
    return placed, np.full(len(centres), radius)


SAMPLES = 4000  # configurations within the joint limits, always the same
TOUCHING_M = 0.02  # closer than this, two capsules count as touching
NEVER_CLOSER_M = 0.05  # pairs that never come closer than this in any sampled configuration are left out


def self_pairs(
    chain: Chain, capsules: Capsules, limits: JointLimits, home: FloatArray, excluded: BoolArray
) -> IntArray:
    """Pairs (P, 2) of capsules that may collide, found by sampling.

    Omits pairs on the same or on adjacent links, ``excluded`` ones (K, K), pairs that touch at home or in
    most sampled configurations (their capsules are coarser than the robot's shell there), and pairs that
    never come near each other.
    """
    pairs = np.array(
        [
            (i, j)
            for i, j in combinations(range(len(capsules)), 2)
            if not _adjacent(chain, int(capsules.link[i]), int(capsules.link[j])) and not excluded[i, j]
        ],
        dtype=np.int64,
    ).reshape(-1, 2)
    if not len(pairs):
        return pairs
    sampled = np.random.default_rng(0).uniform(limits.lower, limits.upper, size=(SAMPLES, chain.dof))
    gap = _gaps(chain, capsules, pairs, np.concatenate([home[None], sampled]))
    touching = gap < TOUCHING_M
    keep = ~touching[0] & (touching.mean(axis=0) <= 0.5) & (gap.min(axis=0) < NEVER_CLOSER_M)
    return pairs[keep]


def _adjacent(chain: Chain, first: int, second: int) -> bool:
    if first == second:
        return True
    return (first >= 0 and chain.parent[first] == second) or (second >= 0 and chain.parent[second] == first)


def _gaps(chain: Chain, capsules: Capsules, pairs: IntArray, q: FloatArray) -> FloatArray:
    """(N, P), distance between the surfaces of each pair at each configuration, m."""
    start, end = capsules.placed(chain, chain.link_transforms(q))
    i, j = pairs.T
    distance, _, _ = segment_distance(start[:, i], end[:, i], start[:, j], end[:, j])
    return distance - capsules.radius[i] - capsules.radius[j]
