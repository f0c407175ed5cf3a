"""The force at the tool is estimated well enough, and stops what works against it, and nothing else."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from latentarm.arms.mujoco import Imperfections, MujocoArm
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import Input, Pose, Reading
from latentarm.robots.catalogue import load_robot
from latentarm.robots.scene.containers import cup
from latentarm.robots.scene.scene import TABLE, TOOL, Scene
from latentarm.robots.scene.thing import Part, Thing
from latentarm.robots.tines import TINES_BODY
from latentarm.safety.config import SafetyConfig
from latentarm.safety.tool_force import DAMPING_M, ToolForce
from latentarm.safety.yielding import YIELDING
from latentarm.tasks.inverse_kinematics import solve

BOTH = (min(TOOL, TABLE), max(TOOL, TABLE))
LIMIT_N = SafetyConfig().tool_force


def forces_n(robot, q, torque):
    """The estimated force at the only tool, N."""
    (force,), _ = ToolForce(robot, LIMIT_N).forces(q, torque)
    return np.linalg.norm(force)


def pushes(arm, thing):
    """Forces of a thing on the tool, (K, 3), N, and their torques on the joints, (n,), N m."""
    forces, torque = [], np.zeros(arm.model.nv)
    for index, contact in enumerate(arm.data.contact):
        first, second = (int(arm.model.geom_bodyid[geom]) for geom in contact.geom)
        sign, body = (1.0, second) if first == thing else (-1.0, first)
        # In random configurations the arm may touch itself, or the thing with another link.
        assume({thing, arm.model.body(TINES_BODY).id} == {first, second})
        wrench = np.zeros(6)
        mujoco.mj_contactForce(arm.model, arm.data, index, wrench)
        push, turn = (sign * contact.frame.reshape(3, 3).T @ one for one in (wrench[:3], wrench[3:]))
        mujoco.mj_applyFT(arm.model, arm.data, push, turn, contact.pos, body, torque)
        forces.append(push)
    return np.array(forces).reshape(-1, 3), torque[:7]


@settings(deadline=None, max_examples=20)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_estimate_is_near_the_true_force_and_never_far_above_it(seed):
    """A fixed ball pushes the tines from any side."""
    robot, rng = load_robot("panda_fork"), np.random.default_rng(seed)
    q = np.clip(robot.home + rng.normal(scale=0.6, size=7), robot.limits.lower, robot.limits.upper)
    tool = robot.chain.forward(q)
    aside = tool.rotation @ (rng.normal(size=3) * (1.0, 1.0, 0.2) + (0.0, 0.0, 0.5))
    place = tool.position + 0.048 * aside / np.linalg.norm(aside)
    ball = Thing("ball", (Part("sphere", (0.05,)),), 1.0, Pose(place, np.eye(3)), fixed=True)
    clock = SimulatedClock()
    arm = MujocoArm(robot, q, clock.now_s, scene=Scene((ball,), table_m=-5.0))
    arm.connect()
    clock.wait_until(0.004)  # by its first look
    reading = arm.read()
    forces, torque = pushes(arm, arm.model.body("thing ball").id)
    force_n = np.linalg.norm(forces.sum(axis=0))
    # Not squeezed from two sides, which leaves a moment and no force.
    assume(force_n > max(1.0, 0.9 * np.linalg.norm(forces, axis=1).sum()))
    np.testing.assert_allclose(reading.external_torque, torque, atol=1e-9 * force_n)
    estimated_n = forces_n(robot, reading.q, reading.external_torque)
    assert estimated_n < 1.05 * force_n
    if np.linalg.svd(robot.chain.jacobian(reading.q)[:3], compute_uv=False)[-1] > 0.1:
        assert estimated_n > 0.75 * force_n


class Pressing:
    """An arm over the table of which the filters know nothing, and its drive at 100 Hz."""

    def __init__(self, arm, scene=None, rotation=None, height_m=0.06, mode=1):
        self.clock, self.robot = SimulatedClock(), arm
        self.step = Step(arm, EndEffectorController(arm), SafetyConfig())
        rotation = arm.chain.forward(arm.home).rotation if rotation is None else rotation
        start = solve(arm, Pose(np.array([0.5, 0.0, height_m]), rotation), arm.home)
        flaws = Imperfections(payload_kg=1.0)
        self.arm = MujocoArm(arm, start, self.clock.now_s, flaws, scene or Scene())
        self.arm.connect()
        self.step.reset(self.arm.read().q)
        self.step.choose_mode(mode)
        self.records, self.force_n, self.torque = [], [], []
        self.tick(0.0)
        self.arm.enable()
        assert self.step.enable() is None

    def tick(self, *u, gripper=None, count=1):
        for _ in range(count):
            self.clock.wait_until(self.clock.now_s() + 0.01)
            reading = self.arm.read()
            given_ = Input(np.resize(np.array(u), 2) * (1.0, 0.0 if len(u) == 1 else 1.0), gripper=gripper)
            self.records.append(self.step(given_, 0.0, reading, self.clock.now_s()))
            self.arm.send(self.records[-1].command)
            self.force_n.append(self.arm.scene_state().force_n.get(BOTH, 0.0))
            self.torque.append(reading.external_torque)
        return self.records[-1]

    def until_stopped(self, u):
        for _ in range(2000):
            if self.tick(u).command.stop is not None:
                return self.step.stopped.code
        raise AssertionError("nothing stopped it")


def test_a_gentle_push_ends_at_a_gentle_force_and_any_other_way_is_free(arm):
    world = Pressing(arm)
    world.tick(-0.05, count=1500)
    assert world.step.stopped is None
    assert 0.5 * LIMIT_N < max(world.force_n) < 0.9 * LIMIT_N
    assert "force" in world.records[-1].command.limited_by
    pressing = len(world.force_n)
    world.tick(1.0, count=100)
    assert max(world.force_n[pressing + 50 :]) == 0.0


def test_an_arm_that_presses_stops_at_the_limit_and_draws_back(arm):
    world, u = Pressing(arm), -0.25
    assert world.until_stopped(u) == "force_high"
    stopped = len(world.records)
    world.tick(u, count=200)
    assert max(world.force_n) < LIMIT_N + 40.0
    assert max(world.force_n[stopped + 30 :]) == 0.0
    assert any(YIELDING in one.command.limited_by for one in world.records[stopped:])
    assert world.step.at_rest
    assert world.step.enable().code == "let_go_first"


def test_even_at_full_speed_it_lets_go_within_a_third_of_a_second(arm):
    world = Pressing(arm)
    assert world.until_stopped(-1.0) == "force_high"
    touched = int(np.flatnonzero(world.force_n)[0])
    assert len(world.records) - touched <= 3
    world.tick(-1.0, count=100)
    assert max(world.force_n[touched + 33 :]) == 0.0


def test_nothing_is_felt_in_free_motion_at_full_speed(arm):
    world, rng = Pressing(arm, height_m=0.4), np.random.default_rng(0)
    for _ in range(20):
        world.tick(*rng.choice([-1.0, 1.0], 2), count=20)
    assert np.abs(np.array([one.command.velocity for one in world.records])).max() > 0.2
    assert not np.any(world.torque)
    assert world.step.stopped is None


def test_a_cup_that_is_carried_weighs_little_and_stops_nothing(arm):
    scene = Scene((Thing("cup", cup().parts, 0.3, Pose(np.array([0.5, 0.0, 0.0]), np.eye(3))),))
    world = Pressing(arm, scene, np.diag([1.0, -1.0, -1.0]))
    world.tick(0.0, gripper="close", count=150)
    assert world.arm.scene_state().gripped == {"cup"}
    world.tick(1.0, count=150)
    for direction in (1.0, -1.0, 1.0):
        world.tick(direction, count=40)
    weighs = forces_n(arm, world.arm.read().q, world.torque[-1])
    assert 1.0 < weighs < 0.5 * LIMIT_N
    assert world.step.stopped is None
    assert world.arm.scene_state().poses["cup"].position[2] > 0.1


class Felt:
    """A kinematic arm that reports any torque."""

    def __init__(self, arm, scripted, velocity=None):
        self.q, self.now, self.u = arm.home.copy(), 0, 0.0
        velocity = np.full(arm.dof, 0.05) if velocity is None else velocity
        self.step = Step(replace(arm, gripper=None), scripted(velocity[None]), SafetyConfig())
        self.velocity = velocity
        self.step.reset(self.q)
        self.tick(None)
        self.step.enable()

    def tick(self, torque, u=0.0):
        self.now += 1
        reading = Reading(self.q, np.zeros(len(self.q)), 0.01 * self.now, self.now, None, torque)
        record = self.step(Input(np.full(1, u)), 0.0, reading, 0.01 * self.now)
        self.q = self.q + 0.01 * record.command.velocity
        return record


def large(arm, velocity, sign):
    """A torque far above the limit, with or against a motion."""
    return sign * 300.0 * velocity / np.linalg.norm(velocity)


def test_a_motion_that_leads_away_from_a_force_goes_on(arm, scripted):
    felt = Felt(arm, scripted)
    for _ in range(60):
        record = felt.tick(large(arm, felt.velocity, 1.0), 1.0)
    assert record.command.velocity.any()
    assert felt.step.stopped is None


def test_an_arm_that_was_enabled_under_a_force_is_never_driven_on(arm, scripted):
    felt = Felt(arm, scripted)
    against = large(arm, felt.velocity, -1.0)
    for _ in range(20):
        felt.tick(against)
    assert felt.step.stopped is None
    for _ in range(60):
        assert against @ felt.tick(against, 1.0).command.velocity >= 0.0


def test_it_does_not_draw_back_into_another_force(arm, scripted):
    felt = Felt(arm, scripted)
    for _ in range(60):
        felt.tick(None, 1.0)
    assert felt.tick(large(arm, felt.velocity, -1.0), 1.0).command.stop.code == "force_high"
    while YIELDING not in felt.tick(None).command.limited_by:
        assert felt.step.yielding
    for _ in range(30):
        record = felt.tick(large(arm, felt.velocity, 1.0))
    assert felt.step.at_rest
    assert record.command.stop.code == "force_high"


@pytest.mark.parametrize("wrong", [np.zeros(3), np.full(7, np.nan), "none", [1.0, None]])
def test_torques_that_are_none_are_a_reading_that_cannot_be_used(arm, scripted, wrong):
    felt = Felt(arm, scripted)
    assert felt.tick(wrong, 1.0).command.stop.code == "reading_invalid"


@settings(deadline=None, max_examples=20)
@given(seed=st.integers(0, 2**32 - 1))
def test_no_torque_below_the_bound_makes_a_force_above_the_limit(seed):
    """So that an arm that touches nothing works out no force."""
    robot, rng = load_robot("panda"), np.random.default_rng(seed)
    torque = rng.normal(size=7)
    torque *= 2.0 * DAMPING_M * LIMIT_N / np.linalg.norm(torque)
    q = rng.uniform(robot.limits.lower, robot.limits.upper)
    assert forces_n(robot, q, torque) <= LIMIT_N * (1.0 + 1e-9)


@settings(deadline=None, max_examples=50)
@given(seed=st.integers(0, 2**32 - 1), force_n=st.floats(0.0, 2.0 * LIMIT_N))
def test_a_force_takes_from_a_motion_at_most_what_goes_against_it(seed, force_n):
    """And nothing of the tool's turns and ways across, but for what damping leaves near singular places."""
    robot, rng = load_robot("panda"), np.random.default_rng(seed)
    q, velocity = rng.uniform(robot.limits.lower, robot.limits.upper), rng.normal(size=7)
    jacobian = robot.chain.jacobian(q)
    assume(np.linalg.svd(jacobian, compute_uv=False)[-1] > 0.15)
    toward = rng.normal(size=3)
    toward /= np.linalg.norm(toward)
    felt = ToolForce(robot, LIMIT_N)
    felt.saw(jacobian[:3].T @ (force_n * toward))
    (force,), _ = felt.forces(q, jacobian[:3].T @ (force_n * toward))
    force_n = np.linalg.norm(force)
    toward = force / max(force_n, 1e-9)
    eased = felt.eased(q, velocity)
    before, after = jacobian @ velocity, jacobian @ eased
    along, left = toward @ before[:3], toward @ after[:3]
    if along >= 0.0 or force_n <= 0.5 * LIMIT_N:
        assert eased is velocity
        return
    assert along - 1e-9 <= left <= 1e-9
    if force_n > 0.9 * LIMIT_N:
        assert abs(left) < 1e-9
    across = np.concatenate([toward * (left - along), np.zeros(3)])
    assert np.linalg.norm(after - before - across) <= 0.15 * abs(along)
