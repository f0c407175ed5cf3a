"""Wherever the arm is, asking for a way out moves it: see docs/decisions/0040-a-way-out.md."""

import numpy as np
import pytest
from hypothesis import event, example, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere
from latentarm.robots.planar import planar
from latentarm.safety.body import Body
from latentarm.safety.config import SafetyConfig, Workspace
from latentarm.safety.filter import GuardedArm, Situation
from latentarm.safety.halfspaces import slide
from latentarm.safety.limits import BUFFER_M, BUFFER_RAD, Bounds
from latentarm.safety.stack import SafetyStack
from latentarm.safety.zones import Zone

TICKS = 20


def shape(name, kind, at, out, rng):
    """A solid whose surface is at a point, beyond it in a direction."""
    across = np.cross(out, rng.normal(size=3))
    across /= np.linalg.norm(across)
    size = rng.uniform(0.02, 0.1)
    return (
        HalfSpace(name, at, -out),
        Sphere(name, at + out * size, size),
        Capsule(name, at + out * size - 0.1 * across, at + out * size + 0.1 * across, size),
        Box(name, at + out * size, np.column_stack([out, across, np.cross(out, across)]), np.full(3, size)),
    )[kind]


def corner(robot, rng):
    """Limits, a state and a wish: past joint limits, between things, off the workspace."""
    limits, capsules = robot.limits, robot.capsules
    q = rng.uniform(limits.lower, limits.upper) * 0.6 + 0.4 * robot.home
    margin = np.where(robot.chain.slide, 0.01, 0.1)
    end = np.where(rng.uniform(size=robot.dof) < 0.5, limits.lower + margin, limits.upper - margin)
    q = np.where(
        rng.uniform(size=robot.dof) < rng.choice([0.0, 0.3]), end + rng.normal(size=robot.dof) * 0.01, q
    )
    starts, ends = capsules.placed(robot.chain, robot.chain.link_transforms(q))
    moving = np.flatnonzero(capsules.link >= 0)
    points = np.concatenate([starts[moving], ends[moving]])
    things, zones, workspace = [], [], None
    for number in range(rng.integers(4)):
        capsule, out = rng.choice(moving), rng.normal(size=3) * [1.0, 1.0, robot.dof < 10]
        out /= np.linalg.norm(out)
        at = starts[capsule] + rng.uniform() * (ends[capsule] - starts[capsule])
        for side in (1.0, -1.0)[: rng.integers(1, 3)]:
            gap = (
                side
                * out
                * (capsules.radius[capsule] + rng.choice([-0.01, 0.005, 0.015, 0.02, 0.0205, 0.03]))
            )
            things.append(shape(f"thing {number} {side}", rng.integers(4), at + gap, side * out, rng))
    if rng.uniform() < 0.3:
        lower = points.min(axis=0) + rng.uniform(-0.03, 0.02, 3)
        workspace = Workspace(
            lower, np.maximum(points.max(axis=0) + rng.uniform(-0.02, 0.03, 3), lower + 0.1)
        )
    for number in range(rng.integers(3)):
        at, out = points[rng.integers(len(points))] + rng.normal(size=3) * 0.1, rng.normal(size=3)
        solid = shape(f"zone {number}", rng.integers(4), at, out / np.linalg.norm(out), rng)
        zones.append(Zone(solid, rng.choice([0.01, 0.05])))
    wish = rng.normal(size=robot.dof) * (rng.uniform(size=robot.dof) < rng.choice([0.3, 1.0]))
    wish[rng.integers(robot.dof)] += 0.1
    config = SafetyConfig(obstacles=tuple(things), zones=tuple(zones), workspace=workspace)
    return config, q, wish * rng.choice([0.05, 1.0]) / np.abs(wish).max()


def near(config, robot, q):
    """Unit rows of all distances and joints that are too near their limits or just before them, (C, n)."""
    bounds = Bounds(config, robot, 0.01)
    situation = Situation(GuardedArm(bounds, Body(robot)), q, np.zeros(robot.dof), np.zeros(robot.dof))
    contacts = situation.contacts(np.full(robot.dof, 0.5))
    placement, eye = situation.placement, np.eye(robot.dof)
    rows = [eye, -eye, contacts.row.reshape(-1, robot.dof)]
    room = [q - bounds.lower - BUFFER_RAD, bounds.upper - q - BUFFER_RAD]
    room.append(contacts.height.ravel() - config.clearance - BUFFER_M)
    for side in (1.0, -1.0) if config.workspace else ():
        face = config.workspace.lower if side > 0 else config.workspace.upper
        rows.append(side * placement.jacobian[:, :3].transpose(2, 1, 0).reshape(-1, robot.dof))
        room.append((side * (placement.points - face)).ravel() - BUFFER_M)
    rows = np.concatenate(rows)[np.concatenate(room) <= 1e-6]
    size = np.linalg.norm(rows, axis=1)
    return rows[size > 1e-9] / size[size > 1e-9][:, None]


def gain(rows, wish):
    """How far one can go the way that one wishes to without reducing anything; no joint faster than 1."""
    found = linprog(-wish, A_ub=-rows, b_ub=np.zeros(len(rows)), bounds=(-1.0, 1.0))
    return -found.fun


def driven(config, robot, q, wish, ticks=TICKS):
    """Where a wish leads from rest, the states on the way included, and the fastest any joint became."""
    stack, states, fastest = SafetyStack(config, robot, 0.01), [q], 0.0
    for tick in range(ticks):
        stack.tick(0.01 * tick)
        velocity = stack.command(wish(states[-1]) if callable(wish) else wish, states[-1], 0.0).velocity
        states.append(states[-1] + 0.01 * velocity)
        fastest = max(fastest, float(np.abs(velocity).max()))
    return np.array(states), fastest


@settings(max_examples=settings.default.max_examples // 2)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["arm", "two_arms", "gantry"]))
@example(0, "two_arms")
@example(1, "two_arms")
@example(7, "arm")
def test_whoever_asks_for_a_way_out_is_moved(request, oracle, seed, name):
    """Of two opposite wishes at least one, unless every way out is at right angles to both."""
    robot = request.getfixturevalue(name)
    config, q, wish = corner(robot, np.random.default_rng(seed))
    rows, measure = near(config, robot, q), oracle(robot, config.obstacles)
    before = np.minimum(measure.distances(q), config.clearance)
    size = np.abs(wish).max()
    for way in (wish, -wish):
        least = gain(rows, way / size)
        states, fastest = driven(config, robot, q, way)
        event(f"in the way {len(rows) > 0}, a way out {least > 0.05}")
        # Between what is hardly open and what is shut lies the rounding of both solvers.
        assert fastest > 1e-4 or least < 0.05
        assert (measure.distances(states) >= before - 1e-5).all()


@settings(max_examples=settings.default.max_examples // 2)
@given(st.integers(0, 2**32 - 1), st.integers(1, 12))
def test_what_is_left_of_a_wish_is_nothing_only_where_no_way_out_leads_along_it(seed, count):
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(count, 7))
    # Walls on both sides of some.
    rows = np.concatenate([rows, -rows[: rng.integers(0, count + 1)]])
    wish = rng.normal(size=7)
    nothing, limits = np.zeros(len(rows)), (np.full(7, -1.0), np.full(7, 1.0))
    slid, _ = slide(wish, limits, rows, nothing, rng.uniform(size=len(rows)) < 0.5, np.eye(7))
    most = gain(rows / np.linalg.norm(rows, axis=1)[:, None], wish)
    assert (slid @ wish > 0.0) == (most > 1e-6) or most < 1e-3


@pytest.mark.parametrize("kinds", [(0, 0), (3, 3), (1, 3), (2, 1)])
@pytest.mark.parametrize("gap", [0.003, 0.02])
def test_between_two_things_that_are_both_too_near_the_arm_goes_along_them(oracle, kinds, gap):
    robot, q = planar(5), np.array([0.3, 0.4, -0.5, 0.6, -0.4])
    rng = np.random.default_rng(0)
    tip = robot.chain.forward(q)
    across = tip.rotation[:, 1]
    starts, ends = oracle(robot).ends(q)
    at = (starts[-1] + ends[-1]) / 2
    things = [
        shape(f"thing {side}", kind, at + side * across * (0.02 + gap), side * across, rng)
        for kind, side in zip(kinds, (1.0, -1.0), strict=True)
        if kind or side > 0
    ]
    measure = oracle(robot, things)
    before = np.minimum(measure.distances(q), 0.02)

    def back(q):
        return np.linalg.pinv(robot.chain.jacobian(q)[:2]) @ (-0.1 * tip.rotation[:2, 0])

    states, _ = driven(SafetyConfig(obstacles=tuple(things)), robot, q, back, 300)
    gone = (robot.chain.forward(states[-1]).position - tip.position) @ tip.rotation[:, 0]
    assert gone < -0.001
    assert (measure.distances(states) >= before - 1e-4).all()


def test_an_arm_that_any_motion_brings_nearer_to_something_stands_still(oracle):
    """One joint between two walls: there is no way out, and a person has to make one."""
    robot, q = planar(1), np.zeros(1)
    up = np.array([0.0, 1.0, 0.0])
    walls = (HalfSpace("left", 0.03 * up, -up), HalfSpace("right", -0.03 * up, up))
    for way in (np.ones(1), -np.ones(1)):
        assert driven(SafetyConfig(obstacles=walls), robot, q, way)[1] == 0.0


@settings(max_examples=settings.default.max_examples // 2)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["arm", "two_arms", "gantry"]))
@example(3887, "two_arms")
def test_without_a_thing_in_the_way_any_joints_may_turn_at_once(request, seed, name):
    """Fast joints whose links hardly move, because one takes back what another does, are no exception."""
    robot = request.getfixturevalue(name)
    rng = np.random.default_rng(seed)
    limits = robot.limits
    q = rng.uniform(limits.lower, limits.upper) * 0.5 + 0.5 * robot.home
    _, fastest = driven(SafetyConfig(), robot, q, rng.choice([-1.0, 1.0], robot.dof))
    # Slowly, where the arm is about to come near itself.
    assert fastest > 0.001 or len(near(SafetyConfig(), robot, q))
