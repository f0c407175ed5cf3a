"""What is shown is what would happen."""

import numpy as np
import pytest

from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import SimulatedClock
from latentarm.types import Context, Input
from latentarm.web.arm_process.drive_setup import PERIOD_S
from latentarm.web.arm_process.ghosts import GhostPaths

DIRECTIONS = {"up": (0.0, 1.0), "down": (0.0, -1.0), "left": (-1.0, 0.0), "right": (1.0, 0.0)}


def looked(setup, q, mode):
    ghosts = GhostPaths(setup.task, setup.controller, setup.help, setup.step().safety)
    assert ghosts.newest is None
    belief = np.full(len(setup.task.goals), 1.0 / len(setup.task.goals))
    for direction in range(4):
        ghosts.look(direction, Context(q, belief), mode)
    return ghosts.newest


def driven(setup, q, u, mode):
    """Where the tool is after a second of a full deflection, through all safety filters."""
    step, clock = setup.step(), SimulatedClock()
    arm = KinematicArm(setup.task.robot, q, clock.now_s)
    arm.connect()
    arm.enable()
    step.reset(q)
    step.choose_mode(mode)
    step(Input(np.zeros(2)), 0.0, arm.read(), 0.0)
    step.enable()
    for tick in range(1, 101):
        clock.wait_until(tick * PERIOD_S)
        arm.send(step(Input(np.array(u)), 0.0, arm.read(), clock.now_s()).command)
    return setup.task.robot.chain.forward(arm.read().q).position


@pytest.mark.parametrize("mode", ["latent", "assisted", "end_effector"])
def test_the_arm_goes_where_the_ghosts_show(setup, mode):
    setup.help.level = "medium" if mode == "assisted" else "off"
    index = setup.mode_index(mode, 0)
    at = setup.task.robot.chain.forward(setup.start).position
    try:
        ghosts = looked(setup, setup.start, index)
        for name, u in DIRECTIONS.items():
            shown = np.array(getattr(ghosts, name))[-1]
            there = driven(setup, setup.start, u, index)
            # The ramp, which ghosts leave out, costs a good part of the first second.
            assert np.linalg.norm(shown - there) < 0.45 * np.linalg.norm(shown - at) + 0.005
    finally:
        setup.help.level = "off"


def test_ghosts_do_not_go_through_the_table(setup):
    low = setup.task.goals[1].configuration
    chain = setup.task.robot.chain
    index = setup.mode_index("end_effector", 1)
    q = low
    for _ in range(12):
        path = np.array(looked(setup, q, index).left)
        assert path[:, 2].min() > 0.0
        step, clock = setup.step(), SimulatedClock()
        arm = KinematicArm(setup.task.robot, q, clock.now_s)
        arm.connect()
        arm.enable()
        step.reset(q)
        step.choose_mode(index)
        step(Input(np.zeros(2)), 0.0, arm.read(), 0.0)
        step.enable()
        for tick in range(1, 21):
            clock.wait_until(tick * PERIOD_S)
            arm.send(step(Input(np.array([-1.0, 0.0])), 0.0, arm.read(), clock.now_s()).command)
        q = arm.read().q
    lowest = chain.forward(q).position
    np.testing.assert_allclose(np.array(looked(setup, q, index).left)[-1], lowest, atol=0.03)
