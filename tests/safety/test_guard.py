"""What the guard lets pass is safe along the whole path, measured densely and in another way."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import assume, event, given, settings
from hypothesis import strategies as st

from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere
from latentarm.safety.body import Body, Placement
from latentarm.safety.config import SafetyConfig, Workspace
from latentarm.safety.filter import GuardedArm, Situation
from latentarm.safety.guard import Guard, StoppingPath
from latentarm.safety.limits import Bounds


def beside(robot, q, rng, oracle):
    """Obstacles of every kind, 15 to 60 mm away from some capsule of the arm."""
    measure = oracle(robot)
    starts, ends = measure.ends(q)
    found = []
    for kind in rng.choice(4, size=3):
        capsule = rng.choice(measure.moving)
        out = rng.normal(size=3)
        out /= np.linalg.norm(out)
        at = starts[capsule] + rng.uniform() * (ends[capsule] - starts[capsule])
        gap = robot.capsules.radius[capsule] + rng.uniform(0.015, 0.06)
        if kind == 0:
            low = max(starts[measure.moving] @ out) if rng.uniform() < 0.5 else at @ out
            found.append(HalfSpace("plane", point=out * (low + gap), normal=-out))
        elif kind == 1:
            found.append(Sphere("ball", centre=at + out * (gap + 0.05), radius=0.05))
        elif kind == 2:
            along = np.cross(out, rng.normal(size=3)) * 0.1
            middle = at + out * (gap + 0.02)
            found.append(Capsule("rod", start=middle - along, end=middle + along, radius=0.02))
        else:
            turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            turn *= np.sign(np.linalg.det(turn))
            found.append(
                Box(
                    "box",
                    centre=at + out * (gap + 0.08),
                    rotation=turn,
                    half_extents=rng.uniform(0.02, 0.08, 3),
                )
            )
    return tuple(found)


def path_states(q, velocity, brake, hold_s):
    """Joint positions while the command lasts and the brake follows, early or late."""
    for held in (0.4 * hold_s, hold_s):
        hold = np.linspace(0.0, held, 12)[:, None] * velocity
        times = np.linspace(0.0, brake.duration_s, 120)
        speeds = np.array([brake.at(float(t))[0] for t in times])
        braking = np.concatenate(
            [np.zeros((1, len(q))), np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * times[1], axis=0)]
        )
        yield q + hold, np.broadcast_to(velocity, (12, len(q)))
        yield q + hold[-1] + braking, speeds


# An example looks along five ways, for each of which the guard is asked some ten times.
@settings(max_examples=settings.default.max_examples // 2)
@given(st.integers(0, 2**32 - 1), st.sampled_from(["arm", "two_arms", "gantry", "coupled"]))
def test_what_passes_is_safe_all_the_way(robot_named, oracle, seed, name):
    robot = robot_named(name)
    rng = np.random.default_rng(seed)
    lower, upper = robot.limits.lower, robot.limits.upper
    q = rng.uniform(lower, upper)
    # Near limits too, and outside them.
    margin = np.where(robot.chain.slide, 0.01, 0.1)
    q = np.where(rng.uniform(size=robot.dof) < 0.2, rng.choice([lower + margin, upper - margin]), q)
    q += rng.normal(size=robot.dof) * 0.005
    # Without things half of the time: they are so near that they leave little for the other limits to do.
    obstacles = beside(robot, q, rng, oracle) if rng.uniform() < 0.5 else ()
    workspace = None
    if rng.uniform() < 0.5:
        measure = oracle(robot)
        ends = np.concatenate(measure.ends(q))[np.r_[measure.moving, measure.moving + len(robot.capsules)]]
        pads = rng.uniform(-0.002, 0.02, (2, 3)) + 0.01 * (np.ptp(ends, axis=0) < 0.01)
        workspace = Workspace(ends.min(axis=0) - pads[0], ends.max(axis=0) + pads[1])
    # With slow links the age of what was measured weighs more than the way ahead.
    link_speed = rng.choice([0.25, 0.02])
    config = SafetyConfig(obstacles=obstacles, workspace=workspace, link_speed=link_speed)
    bounds = Bounds(config, robot, 0.01)
    surroundings = GuardedArm(bounds, Body(robot))
    measure = oracle(robot, obstacles)
    before = measure.distances(q)
    passed = 0
    for _ in range(5):
        # What was measured a few ticks ago must not change what is proven.
        drift = rng.normal(size=robot.dof) * rng.choice([0.0, 0.002, 0.007, 0.015])
        earlier, was_asked = (
            Placement(surroundings.body, q + drift),
            np.full(robot.dof, rng.choice([0.1, 1.0])),
        )
        velocity = rng.normal(size=robot.dof) * rng.choice([0.01, 0.1, 0.25])
        velocity = np.clip(velocity, -0.5, 0.5) * (rng.uniform(size=robot.dof) < 0.7)
        acceleration = rng.uniform(-1, 1, robot.dof) * bounds.acceleration * rng.choice([0.0, 1.0, 4.0])

        def allowed(share, velocity=velocity, acceleration=acceleration, earlier=earlier, asked=was_asked):
            surroundings.reference = earlier
            surroundings.proximity.measured(earlier, asked)
            brake = bounds.brake(share * velocity, acceleration)
            situation = Situation(surroundings, q, share * velocity, acceleration)
            return Guard().objection(share * velocity, brake, situation) is None

        # The fastest that passes in this direction is where a proof with a gap would show it.
        share, step = (1.0, 0.0) if allowed(1.0) else (0.0, 1.0)
        while step > 0.01:
            step /= 2
            share += step * allowed(share + step)
        if not allowed(share):
            continue
        velocity = share * velocity
        brake = bounds.brake(velocity, acceleration)
        passed += 1
        for states, speeds in path_states(q, velocity, brake, bounds.hold_s):
            assert (states <= np.maximum(upper - margin, q) + 1e-9).all()
            assert (states >= np.minimum(lower + margin, q) - 1e-9).all()
            # Boxes are measured without depth, so a box that the arm is inside of counts as touched.
            least = np.minimum(config.clearance, before)
            assert (measure.distances(states) >= least - 1e-6).all()
            for state, speed in list(zip(states, speeds, strict=True))[::20]:
                assert measure.link_speed(state, speed) <= config.link_speed + 1e-6
            if workspace is not None:
                starts, ends = measure.ends(states)
                points = np.concatenate([starts[:, measure.moving], ends[:, measure.moving]], axis=1)
                first = points[0] if (states[0] == q).all() else None
                if first is not None:
                    start_points = first
                assert (points >= np.minimum(workspace.lower, start_points) - 1e-6).all()
                assert (points <= np.maximum(workspace.upper, start_points) + 1e-6).all()
    event(f"passed {passed > 0}")


@pytest.mark.parametrize("name", ["arm", "two_arms", "gantry", "coupled"])
def test_an_old_placement_never_makes_the_links_look_slower(request, name):
    robot = request.getfixturevalue(name)
    rng = np.random.default_rng(5)
    body, rest = Body(robot), np.zeros(robot.dof)
    bounds = Bounds(SafetyConfig(), robot, 0.01)
    looked_slower = 0
    for _ in range(300):
        q = rng.uniform(robot.limits.lower, robot.limits.upper)
        velocity = rng.normal(size=robot.dof) * 0.02
        drift = rng.normal(size=robot.dof) * 0.02
        earlier = Placement(body, q + drift)
        true = Placement(body, q).speeds(velocity).max()
        looked_slower += earlier.speeds(velocity).max() < 0.995 * true
        path = StoppingPath(velocity, bounds.brake(velocity, rest), bounds.hold_s)
        assert Guard._exceeds(velocity, path, earlier, np.abs(drift), 0.999 * true)
    assert looked_slower > 10


@pytest.mark.parametrize("name", ["arm", "two_arms", "gantry", "coupled"])
def test_links_that_speed_up_while_a_command_lasts_are_foreseen(request, name):
    robot = request.getfixturevalue(name)
    rng = np.random.default_rng(6)
    body, rest = Body(robot), np.zeros(robot.dof)
    bounds = Bounds(SafetyConfig(), robot, 0.01)
    sped_up = 0
    for _ in range(300):
        q = rng.uniform(robot.limits.lower, robot.limits.upper)
        velocity = rng.uniform(-0.5, 0.5, robot.dof) * (1.0 - 0.5 * robot.chain.slide)
        here = Placement(body, q)
        later = Placement(body, q + bounds.hold_s * velocity).speeds(velocity).max()
        sped_up += later > 1.002 * here.speeds(velocity).max()
        path = StoppingPath(velocity, bounds.brake(velocity, rest), bounds.hold_s)
        assert Guard._exceeds(velocity, path, here, rest, 0.999 * later)
    assert sped_up > 10


@given(st.floats(0.0, 0.25), st.floats(0.0, 4.0), st.floats(0.5, 20.0))
def test_a_point_that_speeds_up_before_the_brake_takes_more_off_is_foreseen(speed, bend, rate):
    """At most ``(1 - r t)(speed + bend t)`` while braking at rate r: the peak of that is what counts."""
    limit, since = 0.25, np.linspace(0.0, 1.0 / rate, 2001)
    peak = ((1.0 - rate * since) * (speed + bend * since)).max()
    assume(abs(peak - limit) > 1e-4)
    path = SimpleNamespace(
        brake=SimpleNamespace(rate=rate, onset_s=0.0, settle_s=0.0), before_s=0.0, fastest=np.ones(1)
    )
    body = SimpleNamespace(bent=lambda joints: np.full((1, 1), bend))
    here = SimpleNamespace(body=body, speeds=lambda velocity: np.full(1, speed))
    assert Guard._exceeds(np.ones(1), path, here, np.zeros(1), limit) == (peak > limit)


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 1.0, 4.0]))
def test_no_joint_goes_further_than_it_is_given_room_for(arm, seed, share):
    """Where a joint has any less room than the command and its brake take, the limit is named."""
    rng = np.random.default_rng(seed)
    bounds = Bounds(SafetyConfig(), arm, 0.01)
    velocity = rng.uniform(-0.5, 0.5, 7) * rng.choice([0.001, 0.1, 1.0])
    brake = bounds.brake(velocity, share * rng.uniform(-1.0, 1.0, 7) * bounds.acceleration)
    path = StoppingPath(velocity, brake, bounds.hold_s)
    times = np.concatenate(
        [
            np.linspace(0.0, brake.settle_s, 200, endpoint=False),
            np.linspace(brake.settle_s, brake.duration_s, 200),
        ]
    )
    speeds = np.array([brake.at(float(time))[0] for time in times])
    steps = np.diff(times)[:, None] * (speeds[1:] + speeds[:-1]) / 2
    positions = np.concatenate(
        [np.zeros((1, 7)), velocity * bounds.hold_s + np.vstack([np.zeros(7), np.cumsum(steps, axis=0)])]
    )
    for side, furthest in ((1, positions.max(axis=0)), (0, positions.min(axis=0))):
        for joint in np.flatnonzero(np.abs(furthest) > 1e-5):
            room = np.stack([np.full(7, -np.inf), np.full(7, np.inf)])
            room[side, joint] = furthest[joint] * (1.0 - 1e-4)
            situation = SimpleNamespace(room=room, nearest_limit=0.0)
            assert Guard._passes_joint_limits(velocity, path, situation)


def test_rest_is_always_allowed(arm):
    bounds = Bounds(SafetyConfig(), arm, 0.01)
    surroundings = GuardedArm(bounds, Body(arm))
    rest = np.zeros(7)
    for q in (arm.home, arm.limits.upper + 1.0, np.full(7, 100.0)):
        assert (
            Guard().objection(rest, bounds.brake(rest, rest), Situation(surroundings, q, rest, rest)) is None
        )


def test_what_goes_too_far_or_too_fast_is_named(arm):
    plane = HalfSpace("plane", point=np.array([0, 0, 0.1]), normal=np.array([0.0, 0.0, 1.0]))
    surroundings = GuardedArm(Bounds(SafetyConfig(obstacles=(plane,)), arm, 0.01), Body(arm))

    def objection(q, velocity):
        rest = np.zeros(7)
        brake = surroundings.bounds.brake(velocity, rest)
        return Guard().objection(velocity, brake, Situation(surroundings, q, rest, rest))

    at_limit = arm.home.copy()
    at_limit[0] = arm.limits.upper[0] - 0.101
    turn = np.array([0.1, 0, 0, 0, 0, 0, 0])
    assert objection(at_limit, turn) == "joint position"
    assert objection(at_limit, -turn) is None
    stretched = np.array([0.0, 1.2, 0.0, -0.3, 0.0, 1.5, 0.0])
    assert objection(stretched, turn * 4) == "link speed"
    down = np.array([0, 0.2, 0, 0, 0, 0, 0])
    assert objection(arm.home, down) in (None, "clearance")
    nearer = arm.home.copy()
    while objection(nearer, down) is None:
        nearer = nearer + 0.01 * down
    assert objection(nearer, down) == "clearance"
    assert objection(nearer, -down) is None


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 1.0, 4.0]))
def test_the_path_ends_where_the_command_and_its_brake_lead(arm, seed, share):
    """Within `stray`, joint by joint; `fastest` is never passed on the way."""
    rng = np.random.default_rng(seed)
    bounds = Bounds(SafetyConfig(), arm, 0.01)
    velocity = rng.uniform(-0.5, 0.5, 7)
    brake = bounds.brake(velocity, share * rng.uniform(-1.0, 1.0, 7) * bounds.acceleration)
    path = StoppingPath(velocity, brake, bounds.hold_s)
    settling = np.linspace(0.0, brake.settle_s, 50)
    ramp = np.linspace(brake.settle_s, brake.duration_s, 300)
    covered = velocity * bounds.hold_s
    for times in (settling, ramp):
        speeds = np.array([brake.at(float(time))[0] for time in times])
        assert (np.abs(speeds) <= path.fastest + 1e-12).all()
        covered = covered + np.trapezoid(speeds, times, axis=0)
    assert (np.abs(covered - path.way) <= path.stray + 3e-6).all()
    # Along each joint the settling is bounded by its whole time at the faster of both speeds.
    assert (np.abs(covered) <= path.fastest * (path.before_s + path.after_s) + 3e-6).all()
