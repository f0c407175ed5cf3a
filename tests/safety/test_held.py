"""A held thing keeps clear of what the arm keeps clear of, and may be put down."""

import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

from latentarm.robots.held import Held
from latentarm.robots.kinematics.obstacles import Box, HalfSpace, Sphere
from latentarm.safety.config import SafetyConfig
from latentarm.safety.stack import SafetyStack
from latentarm.safety.zones import Zone

CUP, SPOON = np.array([0.035, 0.035, 0.045]), np.array([0.014, 0.005, 0.15])
REACHES_OUT_M = 0.018  # a cup's box out of the capsules that stand for it
STOPPED = 15  # ticks in which an arm at full speed has come to rest
SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
UP = np.array([0.0, 0.0, 1.0])


def thing(half, rng):
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    return Held(Box("cup", rng.uniform(-0.01, 0.01, 3) + 0.5 * half[2] * UP, turn, half), 0.2)


def corners(arm, held, q):
    """(8, 3), m."""
    tool, box = arm.chain.forward(q), held.box
    inside = box.centre + SIGNS * box.half_extents @ box.rotation.T
    return tool.position + inside @ tool.rotation.T


def away(arm, held, q, point):
    """Distance of a point (3,), m, from the held box."""
    tool, box = arm.chain.forward(q), held.box
    local = ((point - tool.position) @ tool.rotation - box.centre) @ box.rotation
    return float(np.linalg.norm(np.maximum(np.abs(local) - box.half_extents, 0.0)))


def towards(arm, q, way):
    """Joint velocities (n,), rad/s, that move the tool along a way (3,), m/s."""
    return np.linalg.pinv(arm.chain.jacobian(q)[:3], rcond=0.05) @ way


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


def test_a_cup_is_put_down_where_the_bare_hand_keeps_its_distance(arm):
    """Also where it was not taken from."""
    q = arm.home
    tip = arm.chain.forward(q).position[2]
    table = HalfSpace("table", UP * (tip - 0.12), UP)
    upright = Held(Box("cup", np.zeros(3), arm.chain.forward(q).rotation.T, CUP), 0.2)
    stack = SafetyStack(SafetyConfig(obstacles=(table,)), arm, 0.01)
    stack.hold([upright])
    down = drive(arm, stack, q, lambda q: towards(arm, q, -0.1 * UP), 300)
    assert 0.0 <= corners(arm, upright, down[-1])[:, 2].min() - table.point[2] <= 0.002
    stack.hold([])
    spoon = Held(Box("spoon", 0.1 * UP, np.eye(3), SPOON), 0.05)
    stack.hold([spoon])  # inside the table at once: it may only rise
    sunk = corners(arm, spoon, down[-1])[:, 2].min()
    assert sunk < table.point[2] - 0.1
    pressed = drive(arm, stack, down[-1], lambda q: towards(arm, q, -0.1 * UP), 50)
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
