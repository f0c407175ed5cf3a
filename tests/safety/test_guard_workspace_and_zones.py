"""What the guard alone proves of the workspace and of zones, a few millimetres before them."""

import numpy as np
import pytest

from latentarm.robots.kinematics.obstacles import HalfSpace
from latentarm.safety.body import Body, Placement
from latentarm.safety.config import SafetyConfig, Workspace
from latentarm.safety.filter import GuardedArm, Situation
from latentarm.safety.guard import Guard, StoppingPath
from latentarm.safety.limits import Bounds
from latentarm.safety.zones import Zone

REST = np.zeros(7)


def objection(arm, config, q, velocity, acceleration=REST):
    bounds = Bounds(config, arm, 0.01)
    situation = Situation(GuardedArm(bounds, Body(arm)), q, velocity, acceleration)
    return Guard().objection(velocity, bounds.brake(velocity, acceleration), situation)


def towards(arm, q, way, speed):
    """Joint velocities (n,), rad/s, that move the tool along a unit vector at so many m/s."""
    return np.linalg.pinv(arm.chain.jacobian(q)[:3]) @ (speed * way)


def outwards(arm, rng, axis, side, radius=0.0):
    """A state, how far its outermost point reaches along a side, m, and 0.1 m/s that way, rad/s.

    Points count with their ``radius`` (P,), m.
    """
    while True:
        q = rng.uniform(arm.limits.lower, arm.limits.upper) * 0.9
        here = Placement(Body(arm), q)
        along = side * here.points[:, axis] + radius
        row = side * here.jacobian[:, axis, int(along.argmax())]
        if row @ row > 0.1:
            velocity = 0.1 * row / (row @ row)
            if not any(objection(arm, SafetyConfig(), q, one) for one in (velocity, -velocity)):
                return q, along.max(), velocity


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_no_face_of_the_workspace_is_passed(arm, axis, side):
    """The box ends 2 mm beyond the outermost point; a command of 0.1 m/s and its stop take 4 mm."""
    rng = np.random.default_rng(0)
    for _ in range(5):
        q, reach, velocity = outwards(arm, rng, axis, side)
        corners = np.array([[-2.0] * 3, [2.0] * 3])
        corners[int(side > 0.0), axis] = side * (reach + 0.002)
        config = SafetyConfig(workspace=Workspace(*corners))
        assert objection(arm, config, q, velocity) == "workspace"
        assert objection(arm, config, q, -velocity) is None


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_part_that_comes_near_a_zone_only_while_it_brakes_is_too_fast_for_it(arm, axis):
    rng = np.random.default_rng(1)
    bounds = Bounds(SafetyConfig(), arm, 0.01)
    for _ in range(5):
        q, reach, velocity = outwards(arm, rng, axis, 1.0, Body(arm).radius)
        path = StoppingPath(velocity, bounds.brake(velocity, REST), bounds.hold_s)
        goes = 0.1 * (path.before_s + path.after_s)
        assert 0.1 * path.before_s < 0.9 * goes
        for gap, named in ((0.9 * goes, "zone wall"), (3.0 * goes, None)):
            at = np.eye(3)[axis] * (reach + bounds.config.clearance + gap)
            config = SafetyConfig(zones=(Zone(HalfSpace("wall", at, -np.eye(3)[axis]), 0.05),))
            assert objection(arm, config, q, velocity) == named


@pytest.mark.parametrize("name", ["arm", "two_arms", "gantry", "coupled"])
def test_no_part_is_faster_on_its_path_than_zones_are_told(request, name):
    """Also where acceleration still adds to a slow command before the brake takes it off."""
    robot = request.getfixturevalue(name)
    rng = np.random.default_rng(2)
    bounds = Bounds(SafetyConfig(), robot, 0.01)
    surroundings = GuardedArm(bounds, Body(robot))
    sped_up = 0
    for _ in range(100):
        q = rng.uniform(robot.limits.lower, robot.limits.upper)
        velocity = rng.normal(size=robot.dof) * rng.choice([0.0, 0.02, 0.2])
        brake = bounds.brake(velocity, rng.uniform(-4.0, 4.0, robot.dof) * bounds.acceleration)
        path = StoppingPath(velocity, brake, bounds.hold_s)
        here = Placement(surroundings.body, q)
        told = Guard._fastest(velocity, path, here, np.zeros(robot.dof), surroundings.zones)
        times = np.linspace(0.0, brake.duration_s, 40)
        speeds = np.array([brake.at(time)[0] for time in times])
        states = q + velocity * bounds.hold_s + np.cumsum(speeds, axis=0) * times[1]
        for state, speed in zip(states, speeds, strict=True):
            true = surroundings.zones.of_parts(Placement(surroundings.body, state).speeds(speed))
            assert (true <= told + 1e-6).all()
            sped_up += int((true > 1.01 * surroundings.zones.of_parts(here.speeds(velocity))).any())
    assert sped_up > 100


def test_a_command_that_turns_back_is_judged_where_it_turns(gantry):
    """The rail goes towards a wall and back while another slide takes long to brake."""
    q = np.array([0.0, 0.5 * np.pi, 0.1, 0.0])
    velocity, acceleration = np.array([0.02, 0.0, 0.15, 0.0]), np.array([-8.0, 0.0, 0.0, 0.0])
    bounds = Bounds(SafetyConfig(), gantry, 0.01)
    brake = bounds.brake(velocity, acceleration)
    times = np.linspace(0.0, brake.duration_s, 400)
    rail = velocity[0] * bounds.hold_s + np.cumsum([brake.at(time)[0][0] for time in times]) * times[1]
    ends = StoppingPath(velocity, brake, bounds.hold_s).way[0]
    assert rail.max() > ends + 1e-4
    body = Body(gantry)
    reach = (Placement(body, q).points[:, 0] + body.radius).max() + bounds.config.clearance
    for gap, named in ((0.5 * (rail.max() + ends), "clearance"), (0.003, None)):
        wall = HalfSpace("wall", np.array([reach + gap, 0.0, 0.0]), np.array([-1.0, 0.0, 0.0]))
        assert objection(gantry, SafetyConfig(obstacles=(wall,)), q, velocity, acceleration) == named
