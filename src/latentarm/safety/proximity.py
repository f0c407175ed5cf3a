"""Shapes near the arm, obstacles and its own links, as heights above supporting planes."""

from dataclasses import dataclass, replace
from typing import TypeVar, final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray, IntArray
from latentarm.robots.kinematics.distances import box_separation, segment_distance
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Obstacle, Sphere
from latentarm.safety.body import Body, Placement
from latentarm.safety.small import any_nonzero, largest
from latentarm.safety.supports import beneath

_CROSSING_M = 1e-9
"""Segments closer than this intersect, so the line between their closest points has no direction."""

_Solid = TypeVar("_Solid", HalfSpace, Box)

_STALE_RAD = 0.02  # contacts older than this are measured again, because their planes have tilted
_STILL_M = 1e-9  # a capsule whose points no joint moves further than this per rad cannot approach anything


@final
@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """C pairs of shapes that are near each other, each with a plane between them.

    For a unit vector n that points from shape A to capsule B, ``min over the ends b of B of n·b -
    radius_B - max over A of n·a`` is a lower bound of their distance in any configuration, and equal
    to it where n joins their closest points. n is fixed in the frame of A's link where that link carries
    B (so only the joints between them matter), otherwise in the base frame. Both ends have a height,
    because a capsule may come down with either.
    """

    pair: IntArray  # (C,), index into the proximity's pairs
    height: FloatArray  # (C, 2), of both ends of B, m; the smaller one is the distance
    row: FloatArray  # (C, 2, n), how joint velocities change the heights, m/s per rad/s
    since: FloatArray  # (n,), how far each joint has moved since the measurement, rad
    fresh: bool  # whether no joint has moved since


@final
class Proximity:
    """All pairs that could come close to each other, and which of them matter now.

    Pairs that do not matter are skipped by proof: a distance known from an earlier configuration has shrunk
    by at most ``Σ_j lever_j |q_j - q_j'|`` since, and will shrink by at most ``Σ_j lever_j |v_j|`` per
    second, nor faster than the points of the arm may move, ``link_speed``, m/s. Only the pairs that this
    could bring closer than ``nearest_m`` within ``horizon_s`` are measured anew.
    """

    def __init__(
        self,
        body: Body,
        obstacles: tuple[Obstacle, ...],
        link_speed: float,
        nearest_m: float,
        horizon_s: float,
        clearance: float,
    ) -> None:
        self._body, self._nearest_m, self._horizon_s = body, nearest_m, horizon_s
        rods, planes, boxes = _sorted_by_kind(obstacles)
        self._stay_start, self._stay_end, stay_radius, stay_names = _standing_still(body, rods)
        segments = _segment_pairs(body, rods)
        by_planes, planes = _solid_pairs(body, planes, clearance)
        by_boxes, boxes = _solid_pairs(body, boxes, clearance)
        # Pairs of all kinds in one list: segments, then planes, then boxes. `a` indexes its own kind.
        b, a = np.concatenate([segments, by_planes, by_boxes], axis=1)
        kind = np.repeat([0, 1, 2], [part.shape[1] for part in (segments, by_planes, by_boxes)])
        a_link = np.full(len(b), -1)
        on_arm = (kind == 0) & (a < body.count)
        a_link[on_arm] = body.link[a[on_arm]]
        lever, curvature, between, branch = _motion(body, b, a, a_link)
        kept = lever.max(axis=1, initial=0.0) > _STILL_M
        kept[kind == 1] &= heights_change(body, planes)[a[kind == 1], b[kind == 1]]
        # curvature: (pairs, n, n), bound of the heights' second derivative, see `Body`
        # lever: (pairs, n), bound of how fast a joint changes the pair's distance, m
        self.lever, self.curvature = lever[kept], curvature[kept]
        self._b, self._a, self._between, self._branch = b[kept], a[kept], between[kept], branch[kept]
        self._first_plane = int((kind[kept] < 1).sum())
        self._first_box = int((kind[kept] < 2).sum())
        arm_names = [body.robot.capsules.name[i] for i in body.capsule]
        a_names = (arm_names + stay_names, [plane.name for plane in planes], [box.name for box in boxes])
        self.names = [
            f"{arm_names[i]} and {a_names[k][j]}"
            for i, j, k in zip(self._b, self._a, kind[kept], strict=True)
        ]
        self._radius = np.concatenate([body.radius[: body.count], stay_radius])
        self._normals = np.array([plane.normal for plane in planes]).reshape(-1, 3)
        self._offsets = np.array([plane.normal @ plane.point for plane in planes])
        self._centre = np.array([box.centre for box in boxes]).reshape(-1, 3)
        self._rotation = np.array([box.rotation for box in boxes]).reshape(-1, 3, 3)
        self._extents = np.array([box.half_extents for box in boxes]).reshape(-1, 3)
        # A pair of moving capsules may close at twice the speed.
        self._closing = np.where(a_link[kept] >= 0, 2.0, 1.0) * link_speed
        # What is known: this distance at that configuration. Nothing at first.
        self._distance = np.full(len(self._b), -np.inf)
        self._at = np.zeros((len(self._b), body.robot.dof))
        # The last measurement, and the smallest slack of the pairs that were left out.
        self._held: Contacts | None = None
        self._spare: FloatArray = np.zeros(0)
        self._held_at = self._held_speed = np.zeros(body.robot.dof)

    def held(self, q: FloatArray, speed: FloatArray) -> Contacts | None:
        """The contacts measured last, if they are still all that matter at q (n,), rad; None if not.

        ``speed`` (n,), rad/s, bounds how fast each joint may go.
        """
        if self._held is None:
            return None
        since = q - self._held_at
        moved = np.abs(since)
        used = moved + self._horizon_s * np.maximum(speed - self._held_speed, 0.0)
        furthest = largest(moved)
        if furthest > _STALE_RAD or any_nonzero(self.lever @ used >= self._spare):
            return None
        held = self._held
        return Contacts(held.pair, held.height, held.row, since=since, fresh=furthest == 0.0)

    def measured(self, placement: Placement, speed: FloatArray) -> Contacts:
        """All pairs, measured now, that could come nearer than the distance to be kept within the horizon.

        ``speed`` (n,), rad/s, bounds how fast each joint may go.
        """
        q = placement.q
        known = self._distance - (self.lever * np.abs(q - self._at)).sum(axis=1)
        enough = np.minimum(self.lever @ speed, self._closing) * self._horizon_s + self._nearest_m
        pair = np.flatnonzero(known < enough)
        if len(pair):
            normal, edge = self._planes_between(placement.points, pair)
            contacts = self._assembled(placement, pair, normal, edge)
            # Where a pair has several contacts its distance is the smallest.
            self._at[pair] = q
            self._distance[pair] = np.inf
            np.minimum.at(self._distance, contacts.pair, contacts.height.min(axis=1))
            known[pair] = self._distance[pair]
            near = known[contacts.pair] < enough[contacts.pair]
            if not near.all():
                contacts = replace(
                    contacts, pair=contacts.pair[near], height=contacts.height[near], row=contacts.row[near]
                )
        else:
            still = np.zeros(len(q))
            none = np.zeros((0, 2)), np.zeros((0, 2, len(q)))
            contacts = Contacts(np.zeros(0, dtype=np.int64), *none, since=still, fresh=True)
        self._held, self._held_at, self._held_speed = contacts, q, speed
        self._spare = known - enough
        self._spare[contacts.pair] = np.inf
        return contacts

    def heights(self, contacts: Contacts, way: FloatArray) -> FloatArray:
        """Lower bounds (C, 2), m, of all heights once the joints have moved on by ``way`` (n,), rad.

        By Taylor's theorem from where they were measured, see `Body`. Along a straight way the bound
        is concave, so that between two points of it no height is below the lower of their bounds.
        """
        way = contacts.since + way
        size = np.abs(way)
        bend = self.curvature[contacts.pair] @ size @ size
        return contacts.height + contacts.row @ way - 0.5 * bend[:, None]

    def _planes_between(self, points: FloatArray, pair: IntArray) -> tuple[FloatArray, FloatArray]:
        """For each pair the plane's unit normal, out of A, and how far along it A reaches, m."""
        b, a = self._b[pair], self._a[pair]
        planes, boxes = np.searchsorted(pair, [self._first_plane, self._first_box])
        start, end = points[b], points[b + self._body.count]
        if planes == len(pair):
            return self._between_segments(points, start, end, a)
        normal, edge = np.empty((len(pair), 3)), np.empty(len(pair))
        if planes:
            part = slice(0, planes)
            normal[part], edge[part] = self._between_segments(points, start[part], end[part], a[part])
        if boxes > planes:
            part = slice(planes, boxes)
            normal[part], edge[part] = self._normals[a[part]], self._offsets[a[part]]
        if len(pair) > boxes:
            part = slice(boxes, len(pair))
            normal[part], edge[part] = self._beside_boxes(start[part], end[part], a[part])
        return normal, edge

    def _between_segments(
        self, points: FloatArray, start: FloatArray, end: FloatArray, a: IntArray
    ) -> tuple[FloatArray, FloatArray]:
        """The plane is perpendicular to the line between the closest points."""
        count = self._body.count
        a_start = np.concatenate([points[:count], self._stay_start])[a]
        a_end = np.concatenate([points[count : 2 * count], self._stay_end])[a]
        distance, on_b, on_a = segment_distance(start, end, a_start, a_end)
        normal = (on_b - on_a) / np.maximum(distance, _CROSSING_M)[:, None]
        crossing = distance < _CROSSING_M
        if crossing.any():
            normal[crossing] = _across(end[crossing] - start[crossing], a_end[crossing] - a_start[crossing])
        reach = np.maximum(np.vecdot(normal, a_start), np.vecdot(normal, a_end))
        return normal, reach + self._radius[a]

    def _beside_boxes(self, start: FloatArray, end: FloatArray, a: IntArray) -> tuple[FloatArray, FloatArray]:
        centre, rotation, extents = self._centre[a], self._rotation[a], self._extents[a]
        normal = box_separation(start, end, centre, rotation, extents)
        reach = (np.abs(np.vecdot(rotation.mT, normal[:, None, :])) * extents).sum(axis=1)
        return normal, np.vecdot(normal, centre) + reach

    def _assembled(self, place: Placement, pair: IntArray, normal: FloatArray, edge: FloatArray) -> Contacts:
        count = self._body.count
        branch = self._branch[pair]
        if (branch >= 0).any():
            # A moves as well: either of its ends may come up, so each is a contact of its own.
            twice = np.flatnonzero(branch >= 0)
            a = np.concatenate([np.where(branch >= 0, branch, 0), branch[twice] + count])
            pair, normal = np.concatenate([pair, pair[twice]]), np.concatenate([normal, normal[twice]])
            branch = np.concatenate([branch, branch[twice]])
            edge = np.concatenate([edge, edge[twice]])
            edge = np.where(branch >= 0, np.vecdot(normal, place.points[a]) + self._radius[a % count], edge)
            carried = (place.link_jacobian[:, :3, a] * normal.T).sum(axis=1) * (branch >= 0)
        else:
            carried = None
        b = self._b[pair]
        ends = np.stack([b, b + count], axis=1)
        height = np.vecdot(place.points[ends], normal[:, None, :])
        height -= (edge + self._radius[b])[:, None]
        linear = place.link_jacobian[:, :3, ends]
        row = (linear * normal.T[None, :, :, None]).sum(axis=1) * self._between[pair].T[:, :, None]
        if carried is not None:
            row -= carried[:, :, None]
        row = self._body.robot.chain.of_joints(row.transpose(1, 2, 0))
        return Contacts(pair, height, row, since=np.zeros(row.shape[-1]), fresh=True)


def _segment_pairs(body: Body, rods: list[Capsule | Sphere]) -> IntArray:
    """Pairs (2, pairs) of segments B and A; B moves, and A carries it, is on another branch, or stands."""
    capsules, chain = body.robot.capsules, body.robot.chain
    place = np.empty(len(capsules), dtype=np.int64)
    place[np.concatenate([body.capsule, np.flatnonzero(capsules.link < 0)])] = np.arange(len(capsules))
    one, other = body.robot.self_pairs.T
    link, other_link = capsules.link[one], capsules.link[other]
    as_is = (link >= 0) & ((other_link < 0) | chain.moves[link, other_link])
    apart = as_is | (other_link >= 0)
    both = place[np.where(as_is, [one, other], [other, one])[:, apart]]
    rod, moving = np.indices((len(rods), body.count)).reshape(2, -1)
    return np.concatenate([both, [moving, len(capsules) + rod]], axis=1)


def _solid_pairs(body: Body, solids: list[_Solid], clearance: float) -> tuple[IntArray, list[_Solid]]:
    """Pairs (2, pairs) of capsules and solids, and the solids: those for held things come last."""
    placed = list(beneath(solids, clearance)) if body.held.any() else []
    for_held = np.repeat([False, True], [len(solids), len(placed)])
    a, b = np.nonzero(for_held[:, None] == body.held)
    return np.stack([b, a]), solids + placed


def heights_change(body: Body, planes: list[HalfSpace]) -> BoolArray:
    """(planes, capsules), whether any joint changes how high a capsule is above a plane.

    A shoulder that turns about the table's normal keeps its height. Heights are analytic in the joint
    positions: where they are equal in some random configurations they are equal in all.
    """
    chain, limits, ends = body.robot.chain, body.robot.limits, slice(2 * body.count)
    states = np.random.default_rng(0).uniform(limits.lower, limits.upper, (16, body.robot.dof))
    points = chain.points(chain.link_transforms(states), body.link[ends], body.local[ends])
    normals = np.array([plane.normal for plane in planes]).reshape(-1, 3)
    spread = np.ptp(points @ normals.T, axis=0).reshape(2, body.count, len(planes))
    return spread.max(axis=0).T > _STILL_M


def _motion(
    body: Body, b: IntArray, a: IntArray, a_link: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """Levers, curvatures, factors of the links that matter, and A's capsule where on another branch."""
    moves, count = body.robot.chain.moves, body.count
    carries = (a_link >= 0) & moves[body.link[b], a_link]
    between: BoolArray = ~(carries[:, None] & moves[a_link])
    lever = np.maximum(body.link_lever[b], body.link_lever[b + count]) * between
    curvature = body.curvature(lever)
    beside = (a_link >= 0) & ~carries
    a_lever = np.maximum(body.link_lever[a[beside]], body.link_lever[a[beside] + count])
    lever[beside] += a_lever
    curvature[beside] += body.curvature(a_lever)
    return body.by_joints(lever), curvature, between.astype(np.float64), np.where(beside, a, -1)


def _sorted_by_kind(
    obstacles: tuple[Obstacle, ...],
) -> tuple[list[Capsule | Sphere], list[HalfSpace], list[Box]]:
    rods = [item for item in obstacles if isinstance(item, Capsule | Sphere)]
    planes = [item for item in obstacles if isinstance(item, HalfSpace)]
    boxes = [item for item in obstacles if isinstance(item, Box)]
    return rods, planes, boxes


def _standing_still(
    body: Body, rods: list[Capsule | Sphere]
) -> tuple[FloatArray, FloatArray, FloatArray, list[str]]:
    """Starts, ends, radii and names of the arm's own base capsules and of round obstacles."""
    capsules = body.robot.capsules
    base = np.flatnonzero(capsules.link < 0)
    starts = [capsules.start[i] for i in base]
    ends = [capsules.end[i] for i in base]
    for rod in rods:
        starts.append(rod.centre if isinstance(rod, Sphere) else rod.start)
        ends.append(rod.centre if isinstance(rod, Sphere) else rod.end)
    radius = np.array([*capsules.radius[base], *(rod.radius for rod in rods)], dtype=np.float64)
    names = [capsules.name[i] for i in base] + [rod.name for rod in rods]
    return np.array(starts).reshape(-1, 3), np.array(ends).reshape(-1, 3), radius, names


def _across(b: FloatArray, a: FloatArray) -> FloatArray:
    """Unit vectors at right angles to both directions, for segments that cross, (N, 3)."""
    normal = np.cross(b, a)
    length = np.sqrt(np.vecdot(normal, normal))
    any_other = np.cross(b, np.eye(3)[np.abs(b).argmin(axis=-1)])
    normal = np.where((length > 1e-12)[:, None], normal, any_other)
    length = np.sqrt(np.vecdot(normal, normal))
    upward = np.array([0.0, 0.0, 1.0])
    return np.where((length > 1e-12)[:, None], normal / np.maximum(length, 1e-12)[:, None], upward)
