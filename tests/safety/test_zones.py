"""In a zone no part of the arm is faster than the zone allows; and the arm can always leave it."""

import math

import numpy as np
import pytest
from hypothesis import event, example, given, settings
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere
from latentarm.safety.config import SafetyConfig
from latentarm.safety.limits import Bounds
from latentarm.safety.stack import SafetyStack
from latentarm.safety.zones import MOST_ZONES, Zone, zone_of_filter

DT = 0.01
ROUNDING_M_S = 1e-6
"""The judge differentiates positions: its speeds are exact to some 1e-9 m/s."""


class Judge:
    """Distances and speeds of the arm's parts, worked out in other ways than the safety filters do."""

    def __init__(self, measure, zones):
        self.measure, self.zones = measure, zones

    def excess(self, states, velocities):
        """(T,), by how much the worst part in a zone is too fast, m/s; -inf where none is in any."""
        measure, chain = self.measure, self.measure.robot.chain
        shape = (len(states), len(self.zones), len(measure.moving))
        within = measure.distances(states)[:, len(measure.pairs) :].reshape(shape) <= 0.0
        transforms = chain.link_transforms(states)
        tools = [chain.tool_pose(transforms, tool).position for tool in range(len(chain.tools))]
        speeds = self.speeds(states, velocities)
        parts = np.concatenate([measure.moving, len(measure.robot.capsules) + np.arange(len(tools))])
        worst = np.full(len(states), -np.inf)
        for index, zone in enumerate(self.zones):
            reaching = np.column_stack(
                [within[:, index], *(within_solid(zone.shape, tool) for tool in tools)]
            )
            fast = np.where(reaching, speeds[:, parts], -np.inf).max(axis=1)
            worst = np.maximum(worst, fast - zone.speed)
        return worst

    def speeds(self, states, velocities):
        """(T, capsules + tools), of the fastest of points on each part; central differences."""
        robot = self.measure.robot
        capsules, chain, count = robot.capsules, robot.chain, len(robot.capsules)
        out = np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3)])
        ends = np.concatenate([capsules.start, capsules.end])
        around = ends[:, None] + np.tile(capsules.radius, 2)[:, None, None] * out
        link = np.repeat(np.tile(capsules.link, 2), len(out))
        at = []
        for sign in (1.0, -1.0):
            transforms = chain.link_transforms(states + sign * 1e-6 * velocities)
            tools = [chain.tool_pose(transforms, tool).position for tool in range(len(chain.tools))]
            points = chain.points(transforms, link, around.reshape(-1, 3))
            at.append(np.concatenate([points, np.stack(tools, axis=-2)], axis=-2))
        speeds = np.linalg.norm(at[0] - at[1], axis=-1) / 2e-6
        surface = speeds[:, : len(link)].reshape(-1, 2, count, len(out)).max(axis=(1, 3))
        return np.concatenate([surface, speeds[:, len(link) :]], axis=1)


def within_solid(shape, points):
    """(T,), whether points (T, 3) are in a solid."""
    match shape:
        case HalfSpace():
            return (points - shape.point) @ shape.normal <= 0.0
        case Sphere():
            return np.linalg.norm(points - shape.centre, axis=-1) <= shape.radius
        case Capsule():
            along = shape.end - shape.start
            share = np.clip((points - shape.start) @ along / (along @ along), 0.0, 1.0)
            nearest = shape.start + share[:, None] * along
            return np.linalg.norm(points - nearest, axis=-1) <= shape.radius
        case Box():
            return (np.abs((points - shape.centre) @ shape.rotation) <= shape.half_extents).all(axis=-1)


def zones_near(robot, q, rng):
    """Up to three zones of any shape within reach, with limits from a crawl to almost full speed."""
    starts, _ = robot.capsules.placed(robot.chain, robot.chain.link_transforms(q))
    points = np.concatenate([starts, [robot.chain.forward(q).position]])
    found = []
    for number in range(rng.integers(1, 4)):
        at = points[rng.integers(len(points))] + rng.normal(size=3) * 0.2
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
        name = f"zone {number}"
        shapes = (
            Sphere(name, at, rng.uniform(0.02, 0.2)),
            Capsule(name, at, at + rng.normal(size=3) * 0.2, rng.uniform(0.02, 0.1)),
            Box(name, at, turn, rng.uniform(0.02, 0.25, 3)),
            HalfSpace(name, at, turn[0]),
        )
        found.append(Zone(shapes[rng.integers(4)], rng.choice([0.01, 0.03, 0.1, 0.2])))
    return tuple(found)


class Driver:
    """A stack that is asked for velocities, and an arm that does exactly as it is told."""

    def __init__(self, robot, zones, q, late_ticks=0, **limits):
        self.stack = SafetyStack(SafetyConfig(zones=zones, **limits), robot, DT)
        self.robot, self.q, self.time_s = robot, q, 0.0
        self._read = [q] * (late_ticks + 1)
        self.limited_by, self.states, self.velocities = set(), [], []

    def push(self, wanted):
        passed = self._ticked(lambda: self.stack.command(wanted, self._read[0], 0.0))
        self.limited_by |= set(passed.limited_by)
        self._moved(passed.velocity)

    def stop(self):
        self._moved(self._ticked(self.stack.stop))

    def _ticked(self, command):
        self.time_s += DT
        self.stack.tick(self.time_s)
        return command()

    def _moved(self, velocity):
        after = self.q + DT * velocity
        self.states += [self.q, after]
        self.velocities += [velocity, velocity]
        self.q = after
        self._read = [*self._read[1:], after]

    def excess(self, oracle):
        """See `Judge`, at both ends of every tick."""
        zones = self.stack.bounds.config.zones
        judge = Judge(oracle(self.robot, [zone.shape for zone in zones]), zones)
        return judge.excess(np.array(self.states), np.array(self.velocities))


def whims(robot, rng, ticks):
    """Full speed one way for a while, then another, with pauses."""
    left, wanted = 0, np.zeros(robot.dof)
    for _ in range(ticks):
        if left == 0:
            left = int(rng.integers(1, 60))
            wanted = rng.normal(size=robot.dof) * rng.choice([0.0, 0.1, 1.0, 1e3], p=[0.1, 0.2, 0.5, 0.2])
        left -= 1
        yield wanted


def begun(robot, rng):
    return rng.uniform(robot.limits.lower, robot.limits.upper) * 0.6 + 0.4 * robot.home


@given(
    seed=st.integers(0, 2**32 - 1),
    name=st.sampled_from(["arm", "two_arms", "gantry", "coupled"]),
    shaped=st.booleans(),
)
def test_whatever_is_asked_no_part_is_too_fast_in_a_zone(request, oracle, seed, name, shaped):
    robot = request.getfixturevalue(name)
    rng = np.random.default_rng(seed)
    q = begun(robot, rng)
    driver = Driver(robot, zones_near(robot, q, rng), q, command_periods=rng.choice([1.5, 5.0]))
    if not shaped:
        # The guard must hold whatever the filters before it do.
        driver.stack._last = driver.stack._last[:1]
    for wanted in whims(robot, rng, rng.integers(60)):
        driver.push(wanted)
    # A stop at any moment keeps to the limit too, and takes no longer than without zones.
    began = len(driver.states)
    while not driver.stack.at_rest:
        driver.stop()
    assert (len(driver.states) - began) / 2 <= math.ceil(driver.stack.bounds.stop_s / DT) + 1
    excess = driver.excess(oracle) if driver.states else np.array([-np.inf])
    event(f"entered {bool((excess > -np.inf).any())}")
    assert excess.max() <= ROUNDING_M_S


@settings(max_examples=settings.default.max_examples // 2)
@given(st.integers(0, 2**32 - 1), st.integers(1, 5))
def test_nor_where_readings_are_late(arm, oracle, seed, late_ticks):
    """By up to clearance / link_speed, 80 ms: the limit begins so far before the zone."""
    rng = np.random.default_rng(seed)
    q = begun(arm, rng)
    driver = Driver(arm, zones_near(arm, q, rng), q, late_ticks)
    for wanted in whims(arm, rng, 30):
        driver.push(wanted)
    assert driver.excess(oracle).max() <= ROUNDING_M_S


@given(st.integers(0, 2**32 - 1), st.sampled_from(["two_arms", "gantry"]))
# What the ramp would have added while it lasted was too much for the zone, in every tick.
@example(25971, "two_arms")
def test_an_arm_in_a_zone_goes_wherever_it_is_asked_to_go(request, oracle, seed, name):
    """Slowly, but at no less than half of what the slowest zone allows, and never another way."""
    robot = request.getfixturevalue(name)
    rng = np.random.default_rng(seed)
    q = begun(robot, rng)
    zones = zones_near(robot, q, rng)
    driver, wanted = Driver(robot, zones, q), rng.uniform(-0.2, 0.2, robot.dof)
    for _ in range(25):
        driver.push(wanted)
    if not all(name == "ramp" or zone_of_filter(name) for name in driver.limited_by):
        event("something else was in the way")
        return
    velocity = driver.velocities[-1]
    event(f"slowed {bool(np.abs(velocity - wanted).max() > 1e-6)}")
    assert velocity @ wanted == pytest.approx(np.linalg.norm(velocity) * np.linalg.norm(wanted))
    fastest = Judge(oracle(robot), zones).speeds(driver.q[None], velocity[None]).max()
    slowest = min(zone.speed for zone in zones)
    assert fastest >= 0.5 * slowest or np.allclose(velocity, wanted, atol=1e-6)


def pushed(driver, way, ticks):
    """Steer the tool along a straight line at full speed; whether that ever took an emergency stop."""
    stopped = False
    for _ in range(ticks):
        jacobian = driver.robot.chain.jacobian(driver.q)
        driver.push(np.linalg.pinv(jacobian) @ np.r_[0.25 * np.array(way), np.zeros(3)])
        stopped |= driver.stack._brake is not None
    return stopped


@pytest.mark.parametrize(("speed", "ticks"), [(0.02, 300), (0.1, 120)])
def test_a_straight_way_in_at_full_speed_is_smooth_and_so_is_the_way_out(arm, oracle, speed, ticks):
    tool = arm.chain.forward(arm.home).position
    face = Zone(Sphere("face", tool + np.array([0.0, 0.35, 0.0]), 0.12), speed)
    driver = Driver(arm, (face,), arm.home)
    assert not pushed(driver, (0.0, 1.0, 0.0), 60)
    assert driver.excess(oracle).max() == -np.inf
    fastest = np.linalg.norm(
        np.diff([arm.chain.forward(q).position for q in driver.states[::2]], axis=0), axis=1
    )
    assert fastest.max() > 0.2 * DT
    assert not pushed(driver, (0.0, 1.0, 0.0), ticks)
    assert "zone face" in driver.limited_by
    inside = driver.excess(oracle)
    assert inside[-1] > -np.inf
    assert inside.max() <= ROUNDING_M_S
    # As fast as may be, but for a tenth and what links that turn could add.
    assert inside[-20:].min() > -0.35 * speed
    assert not pushed(driver, (0.0, -1.0, 0.0), 2 * ticks)
    assert driver.excess(oracle)[-1] == -np.inf
    assert within_solid(face.shape, arm.chain.forward(driver.q).position[None]) == [False]


SPHERE = Sphere("face", np.array([0.6, 0.0, 0.5]), 0.15)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Zone(SPHERE, 0.0), "The zone 'face' allows 0 m/s: it must be at least 0.01"),
        (lambda: Zone(SPHERE, math.nan), "The zone 'face' allows nan m/s"),
        (lambda: Zone(SPHERE, True), "The zone 'face' needs a number of m/s as its speed, not True"),
        (lambda: Zone(Sphere("face", np.zeros(3), -1.0), 0.1), "The zone 'face' has radius -1.0"),
        (lambda: Zone(Sphere("a,b", np.zeros(3), 1.0), 0.1), "needs another name"),
        (lambda: Zone("face", 0.1), "is not a zone's shape"),
        (lambda: SafetyConfig(zones=SPHERE), "must be a tuple of zones"),
        (lambda: SafetyConfig(zones=(SPHERE,)), "must hold zones, not Sphere"),
        (
            lambda: SafetyConfig(zones=(Zone(SPHERE, 0.1), Zone(Sphere("Face", np.zeros(3), 0.1), 0.2))),
            "Two zones are called 'Face'",
        ),
        (
            lambda: SafetyConfig(
                zones=[Zone(Sphere(str(n), np.zeros(3), 0.1), 0.1) for n in range(MOST_ZONES + 1)]
            ),
            "There are 9 zones: 8 at most",
        ),
    ],
)
def test_what_is_no_zone_is_refused(make, said):
    with pytest.raises(UserError, match=said):
        make()


def test_a_zone_that_allows_more_than_the_arm_may_do_is_refused(arm):
    config = SafetyConfig(zones=(Zone(SPHERE, 0.3),))
    with pytest.raises(UserError, match=r"'face' allows 0\.3 m/s, above the 0\.25 m/s that the arm may do"):
        Bounds(config, arm, DT)
