"""Arms in which joints follow others, beyond their kinematics: physics, saved models, the page's picture."""

import numpy as np

from latentarm.arms.mujoco import MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.core.types import Command
from latentarm.models.saved_chain import chain_of_tensors, chain_shapes, chain_tensors
from latentarm.robots.model_file import load_model_file
from scripted_arms import COUPLED

LIMITS = {"turn": (-3.0, 3.0), "third": (0.02, 0.09), "nod": (-2.2, 2.6)}
"""Range of each leader once its followers' limits count: the first and second segment, and the tilt."""


def test_physics_moves_followers_with_their_leader(written):
    strong = COUPLED.replace("<joint name", '<joint actuatorfrcrange="-200 200" name')
    apart = strong.replace("<geom", '<geom contype="0" conaffinity="0"')  # segments lie in each other
    robot = load_model_file(written(apart))
    assert robot.joint_names == tuple(LIMITS)
    np.testing.assert_allclose(np.stack([robot.limits.lower, robot.limits.upper], 1), [*LIMITS.values()])
    clock = SimulatedClock()
    start = np.array([0.3, 0.05, 0.4])
    arm = MujocoArm(robot, start, clock.now_s)
    arm.connect()
    arm.enable()
    velocity = np.array([0.1, 0.02, -0.2])
    for tick in range(1, 101):
        arm.send(Command(velocity, duration_s=0.05))
        clock.wait_until(0.01 * tick)
    q, _ = arm.truth()
    assert np.abs(q - start - velocity).max() < 0.02
    tip = arm.data.site("tip")
    pose = robot.chain.forward(q)
    assert np.linalg.norm(tip.xpos - pose.position) < 0.005
    assert np.abs(tip.xmat.reshape(3, 3) - pose.rotation).max() < 0.02


def test_a_saved_model_keeps_how_links_follow(coupled):
    chain = coupled.chain
    tensors = chain_tensors(chain)
    shapes = chain_shapes(chain.dof, len(chain.tools), chain.links)
    assert {name: one.shape for name, one in tensors.items()} == shapes
    read = chain_of_tensors(tensors)
    q = np.random.default_rng(0).uniform(coupled.limits.lower, coupled.limits.upper, (20, 3))
    np.testing.assert_array_equal(read.jacobian(q), chain.jacobian(q))
    np.testing.assert_array_equal(read.slide, chain.slide)
