"""A held thing keeps clear of what the arm keeps clear of, and may be put down."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from latentarm.core.types import Pose
from latentarm.robots.kinematics.obstacles import Box, HalfSpace, Sphere
from latentarm.robots.kinematics.rotations import angle_between
from latentarm.safety.config import SafetyConfig
from latentarm.safety.stack import SafetyStack
from latentarm.safety.zones import Zone
from latentarm.tasks.inverse_kinematics import solve

CUP, SPOON = np.array([0.035, 0.035, 0.045]), np.array([0.014, 0.005, 0.15])
REACHES_OUT_M = 0.018  # a cup's box out of the capsules that stand for it
STOPPED = 15  # ticks in which an arm at full speed has come to rest
SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
UP = np.array([0.0, 0.0, 1.0])
GRID = np.stack(np.meshgrid(*3 * [np.linspace(-1.0, 1.0, 7)]), axis=-1).reshape(-1, 3)


def thing(half, rng):
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    return Box("cup", rng.uniform(-0.01, 0.01, 3) + 0.5 * half[2] * UP, turn, half)


def corners(arm, held, q):
    """(8, 3), m."""
    tool = arm.chain.forward(q)
    inside = held.centre + SIGNS * held.half_extents @ held.rotation.T
    return tool.position + inside @ tool.rotation.T


def away(arm, held, q, point):
    """Distance of a point (3,), m, from the held box."""
    tool = arm.chain.forward(q)
    local = ((point - tool.position) @ tool.rotation - held.centre) @ held.rotation
    return float(np.linalg.norm(np.maximum(np.abs(local) - held.half_extents, 0.0)))


def towards(arm, q, way):
    """Joint velocities (n,), rad/s, that move the tool along a way (3,), m/s."""
    return np.linalg.pinv(arm.chain.jacobian(q)[:3], rcond=0.05) @ way


def straight(arm, q, way):
    """The same, and the tool does not turn."""
    return np.linalg.pinv(arm.chain.jacobian(q), rcond=0.05) @ [*way, 0.0, 0.0, 0.0]


def drive(arm, stack, q, wish, ticks):
    """The states (ticks + 1, n), rad, that a wish leads through."""
    states = [q]
    for tick in range(ticks):
        stack.tick(0.01 * tick)
        states.append(states[-1] + 0.01 * stack.command(wish(states[-1]), states[-1], 0.0).velocity)
    return np.array(states)


def pushes(arm, rng, down):
    """Mostly along a way (3,), m/s, at times anywhere; changing five times a second."""
    drawn = []

    def wish(q):
        if len(drawn) % 20 == 0:
            wish.now = rng.uniform(-0.5, 0.5, arm.dof) if rng.uniform() < 0.4 else None
        drawn.append(1)
        return towards(arm, q, down) if wish.now is None else wish.now

    return wish


@settings(max_examples=settings.default.max_examples // 4)
@given(st.integers(0, 2**32 - 1), st.sampled_from([CUP, SPOON]), st.sampled_from([-0.02, 0.0, 0.03]))
def test_no_corner_goes_below_a_table_or_deeper_than_it_was(arm, seed, half, above):
    rng = np.random.default_rng(seed)
    q, held = arm.home + 0.2 * rng.normal(size=arm.dof), thing(half, rng)
    table = HalfSpace("table", UP * (corners(arm, held, q)[:, 2].min() - above), UP)
    stack = SafetyStack(SafetyConfig(obstacles=(table,)), arm, 0.01)
    wish = pushes(arm, rng, -0.25 * UP)
    taken = drive(arm, stack, q, wish, rng.integers(0, 20))[-1]  # also while the arm moves
    stack.hold([held])
    height = [corners(arm, held, q)[:, 2].min() - table.point[2] for q in drive(arm, stack, taken, wish, 150)]
    event(f"inside {height[STOPPED] < 0.0}")
    assert min(height[STOPPED:]) >= min(height[STOPPED], 0.0) - 1e-4


@settings(max_examples=settings.default.max_examples // 4)
@given(st.integers(0, 2**32 - 1), st.sampled_from([CUP, SPOON]))
def test_a_held_thing_touches_no_ball(arm, seed, half):
    rng = np.random.default_rng(seed)
    q, held = arm.home + 0.2 * rng.normal(size=arm.dof), thing(half, rng)
    stack, radius, out = SafetyStack(SafetyConfig(), arm, 0.01), rng.uniform(0.02, 0.1), rng.normal(size=3)
    out /= np.linalg.norm(out)
    far = corners(arm, held, q)
    ball = Sphere("ball", far[(far @ out).argmax()] + (radius + 0.05) * out, radius)
    stack = SafetyStack(SafetyConfig(obstacles=(ball,)), arm, 0.01)
    stack.hold([held])
    states = drive(arm, stack, q, pushes(arm, rng, 0.25 * out), 150)
    gap = [away(arm, held, q, ball.centre) - radius for q in states]
    event(f"near {min(gap) < 0.03}")
    assert min(gap) >= stack.bounds.config.clearance - REACHES_OUT_M


TABLE = HalfSpace("table", np.zeros(3), UP)
TRAY = Box("tray", np.array([0.5, 0.0, -0.01]), np.eye(3), np.array([0.2, 0.15, 0.01]))


@pytest.mark.parametrize("solid", [TABLE, TRAY, replace(TRAY, half_extents=np.array([0.2, 0.15, 0.3]))])
def test_a_cup_is_put_down_upright_and_gently_on_what_is_level(arm, solid):
    """Also where it was not taken from, and where the bare hand keeps its distance."""
    q = solve(arm, Pose(np.array([0.5, 0.0, 0.2]), np.diag([1.0, -1.0, -1.0])), arm.home)
    begun = arm.chain.forward(q)
    cup = Box("cup", 0.01 * UP, np.eye(3), CUP)
    if isinstance(solid, Box):
        solid = replace(solid, centre=np.array([0.5, 0.0, -solid.half_extents[2]]))
    stack = SafetyStack(SafetyConfig(obstacles=(solid,)), arm, 0.01)
    stack.hold([cup])
    states = drive(arm, stack, q, lambda q: straight(arm, q, -0.15 * UP), 300)
    height = np.array([corners(arm, cup, q)[:, 2] for q in states])
    assert 0.0 <= height.min() <= np.sort(height[-1])[3] < 0.002  # all corners of its underside
    assert (-np.diff(height, axis=0) / 0.01 <= stack.bounds.damping_per_s * height[:-1] + 0.002).all()
    ended = arm.chain.forward(states[-1])
    assert np.abs(ended.position - begun.position)[:2].max() < 0.002
    assert angle_between(ended.rotation, begun.rotation) < np.deg2rad(0.5)
    risen = drive(arm, stack, states[-1], lambda q: straight(arm, q, 0.15 * UP), 100)
    assert corners(arm, cup, risen[-1])[:, 2].min() > 0.05


@pytest.mark.parametrize(("kind", "normal"), [("wall", [-1.0, 0.0, 0.0]), ("ramp", [-0.28, 0.0, 0.96])])
def test_a_held_thing_keeps_its_distance_from_what_is_not_level(arm, kind, normal):
    bowl, normal = Box("bowl", 0.01 * UP, np.eye(3), np.array([0.06, 0.06, 0.045])), np.array(normal)
    near = corners(arm, bowl, arm.home)
    point = near[(near @ normal).argmin()] - 0.08 * normal
    across = np.cross(normal, [0.0, 1.0, 0.0])
    turn = np.stack([across, np.cross(normal, across), normal], axis=1)
    ramp = Box("ramp", point - 0.02 * normal, turn, np.array([0.1, 0.1, 0.02]))
    solid = ramp if kind == "ramp" else HalfSpace("wall", point, normal)
    stack = SafetyStack(SafetyConfig(obstacles=(solid,)), arm, 0.01)
    stack.hold([bowl])
    states = drive(arm, stack, arm.home, lambda q: straight(arm, q, -0.15 * normal), 300)
    gap = min(((corners(arm, bowl, q) - point) @ normal).min() for q in states)
    assert 0.02 <= gap < 0.025


def depth(arm, held, q, box):
    """How deep points of the held box are in a box, or its corners in the held one, m; negative outside."""
    tool = arm.chain.forward(q)
    turn = tool.rotation @ held.rotation
    middle = tool.position + tool.rotation @ held.centre
    points = middle + (GRID * held.half_extents) @ turn.T
    inside = box.half_extents - np.abs((points - box.centre) @ box.rotation)
    its = box.centre + (SIGNS * box.half_extents) @ box.rotation.T
    within = held.half_extents - np.abs((its - middle) @ turn)
    return max(inside.min(axis=1).max(), within.min(axis=1).max())


@settings(max_examples=settings.default.max_examples // 4)
@given(st.integers(0, 2**32 - 1), st.sampled_from([CUP, SPOON]), st.sampled_from([0.005, 0.02, 0.1]))
def test_a_held_thing_goes_into_no_level_box_from_above_nor_over_its_edges(arm, seed, half, thick):
    rng = np.random.default_rng(seed)
    q, held = arm.home + 0.2 * rng.normal(size=arm.dof), thing(half, rng)
    if rng.uniform() < 0.5:  # upright, as a cup is carried
        held = replace(held, rotation=arm.chain.forward(q).rotation.T)
    size, below = np.array([*rng.uniform(0.01, 0.25, 2), thick]), rng.uniform(0.01, 0.05)
    centre = arm.chain.forward(q).position + rng.uniform(-0.1, 0.1, 3)
    centre[2] = corners(arm, held, q)[:, 2].min() - below - thick
    box = Box("tray", centre, Rotation.from_euler("z", rng.uniform(0.0, 3.0)).as_matrix(), size)
    stack = SafetyStack(SafetyConfig(obstacles=(box,)), arm, 0.01)
    stack.hold([held])
    edge = box.centre + box.rotation @ (size * [*rng.uniform(-1.2, 1.2, 2), rng.uniform(0.0, 1.0)])
    own = rng.uniform(-1.0, 1.0, 3) * held.half_extents

    def wish(q):
        tool = arm.chain.forward(q)
        way = edge - tool.position - tool.rotation @ (held.centre + held.rotation @ own)
        return straight(arm, q, 0.2 * way / np.linalg.norm(way))

    deep = max(depth(arm, held, q, box) for q in drive(arm, stack, q, wish, 150))
    event("touches" if deep > -0.003 else "near" if deep > -0.03 else "far")
    assert deep <= 1e-4


@pytest.mark.parametrize("aside", [[0.0, 0.0], [0.028, 0.0], [0.025, 0.025]])
def test_a_post_that_is_narrower_than_a_cup_does_not_go_into_it(arm, aside):
    """Between the capsules that stand for a thing nothing would feel its top."""
    q = solve(arm, Pose(np.array([0.5, 0.0, 0.2]), np.diag([1.0, -1.0, -1.0])), arm.home)
    cup, post = Box("cup", 0.01 * UP, np.eye(3), CUP), np.array([0.004, 0.004, 0.05])
    top = corners(arm, cup, q)[:, 2].min() - 0.06
    solid = Box("post", np.array([0.5 + aside[0], aside[1], top - post[2]]), np.eye(3), post)
    stack = SafetyStack(SafetyConfig(obstacles=(solid,)), arm, 0.01)
    stack.hold([cup])
    states = drive(arm, stack, q, lambda q: straight(arm, q, -0.15 * UP), 200)
    assert max(depth(arm, cup, q, solid) for q in states) < 0.0


def test_what_was_taken_inside_a_table_may_only_rise(arm):
    table = HalfSpace("table", UP * (arm.chain.forward(arm.home).position[2] - 0.12), UP)
    stack = SafetyStack(SafetyConfig(obstacles=(table,)), arm, 0.01)
    spoon = Box("spoon", 0.1 * UP, np.eye(3), SPOON)
    stack.hold([spoon])
    sunk = corners(arm, spoon, arm.home)[:, 2].min()
    assert sunk < table.point[2] - 0.1
    drive(arm, stack, arm.home, lambda q: np.zeros(7), 4)
    pressed = drive(arm, stack, arm.home, lambda q: towards(arm, q, -0.1 * UP), 50)
    assert corners(arm, spoon, pressed[-1])[:, 2].min() >= sunk - 1e-5
    risen = drive(arm, stack, pressed[-1], lambda q: towards(arm, q, 0.1 * UP), 300)
    assert corners(arm, spoon, risen[-1])[:, 2].min() > table.point[2]


@settings(max_examples=settings.default.max_examples // 4)
@given(st.integers(0, 2**32 - 1), st.sampled_from([CUP, SPOON]))
def test_neither_grasp_nor_release_makes_the_arm_jump(arm, seed, half):
    rng = np.random.default_rng(seed)
    q, held = arm.home + 0.2 * rng.normal(size=arm.dof), thing(half, rng)
    tip = arm.chain.forward(q).position
    face = Zone(Sphere("face", tip + rng.uniform(-0.1, 0.1, 3), 0.1), 0.03)
    table = HalfSpace("table", tip - 0.1 * UP, UP)
    stack = SafetyStack(SafetyConfig(obstacles=(table,), zones=(face,)), arm, 0.01)
    wish = pushes(arm, rng, 0.25 * rng.normal(size=3))
    states = [drive(arm, stack, q, wish, 20)]
    for things in ([held], []):
        stack.hold(things)
        states.append(drive(arm, stack, states[-1][-1], wish, 20)[1:])
    speeds = np.diff(np.concatenate(states), axis=0) / 0.01
    assert (np.abs(np.diff(speeds, axis=0)) <= 0.01 * stack.bounds.stop_acceleration + 1e-9).all()


@pytest.mark.parametrize("half", [CUP, SPOON])
def test_a_thing_taken_in_a_zone_is_slow_there_and_comes_out(arm, half):
    rng, slow = np.random.default_rng(3), 0.03
    for _ in range(3):
        q, held = arm.home + 0.2 * rng.normal(size=arm.dof), thing(half, rng)
        at = corners(arm, held, q)[0]
        zone = Zone(Sphere("face", at, 0.02), slow)
        stack = SafetyStack(SafetyConfig(zones=(zone,)), arm, 0.01)
        out = arm.chain.forward(q).position - at
        way = 0.25 * out / np.linalg.norm(out)
        before = drive(arm, stack, q, lambda q, way=way: towards(arm, q, -way), 20)
        stack.hold([held])
        states = drive(arm, stack, before[-1], lambda q, way=way: towards(arm, q, way), 500)[STOPPED:]
        moved = np.linalg.norm(np.diff([corners(arm, held, q) for q in states], axis=0), axis=2) / 0.01
        within = [away(arm, held, q, at) <= 0.02 for q in states]
        assert moved[np.array(within[:-1])].max() <= slow + 1e-9
        assert within[0]
        assert not within[-1]
