"""What is shown is what would happen."""

import numpy as np
import pytest

from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import SimulatedClock
from latentarm.control.stick_ring import DIRECTIONS, STRETCHES, full_pushes
from latentarm.core.types import Context, Input
from latentarm.robots.kinematics.rotations import quaternion
from latentarm.web.arm_process.drive_setup import PERIOD_S
from latentarm.web.arm_process.ghosts import GhostPaths
from latentarm.web.protocol.orders import ChooseHelp, ChooseMode
from latentarm.web.protocol.report import NO_GHOSTS, Ghosts
from latentarm.web.server.states import PageMemory

ROUND = {"right": 0, "up": DIRECTIONS // 4, "left": DIRECTIONS // 2, "down": 3 * DIRECTIONS // 4}


def here(setup, q):
    return Context(q, np.full(len(setup.task.goals), 1.0 / len(setup.task.goals)))


def looked(setup, q, mode):
    ghosts = GhostPaths(setup.task, setup.controller, setup.help, setup.step().safety)
    for _ in range(STRETCHES):
        assert ghosts.newest(mode) == NO_GHOSTS
        ghosts.look(here(setup, q), mode)
    return ghosts.newest(mode)


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
        pushes = full_pushes(2)
        for direction in [*ROUND.values(), 5]:
            shown = np.array(ghosts.ring[direction][:3])
            there = driven(setup, setup.start, pushes[direction], index)
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


def test_the_ring_goes_round_the_stick_through_the_ends_of_the_four_paths(setup):
    ghosts = looked(setup, setup.start, setup.mode_index("end_effector", 0))
    assert len(ghosts.ring) == DIRECTIONS
    for name, direction in ROUND.items():
        assert getattr(ghosts, name)[-1] == ghosts.ring[direction][:3]
    tool = setup.task.robot.chain.forward(setup.start)
    # Each push leads along the base frame's x and y, as far as it is pushed that way, and turns nothing.
    away = np.array(ghosts.ring)[:, :3] - tool.position
    np.testing.assert_allclose(away[:, :2], 0.15 * full_pushes(2), atol=0.02)
    np.testing.assert_allclose(
        np.abs(np.array(ghosts.ring)[:, 3:] @ quaternion(tool.rotation)), 1.0, atol=1e-2
    )


def test_the_ring_turns_with_the_tool_where_the_stick_turns_it(setup):
    ghosts = looked(setup, setup.start, setup.mode_index("end_effector", 2))
    turned = np.abs(
        np.array(ghosts.ring)[:, 3:] @ quaternion(setup.task.robot.chain.forward(setup.start).rotation)
    )
    np.testing.assert_allclose(2.0 * np.arccos(turned), 0.5, atol=0.05)


def test_a_push_that_means_something_else_empties_the_ring_until_all_of_it_is_known(setup):
    """Not half of the one mode and half of the other, whenever the change comes."""
    first, second = (setup.mode_index("end_effector", axes) for axes in (0, 1))
    whole = {mode: looked(setup, setup.start, mode) for mode in (first, second)}
    context = here(setup, setup.start)
    for looks in range(2 * STRETCHES):
        ghosts = GhostPaths(setup.task, setup.controller, setup.help, setup.step().safety)
        for _ in range(looks):
            ghosts.look(context, first)
        for _ in range(STRETCHES):
            assert ghosts.newest(second) == NO_GHOSTS
            ghosts.look(context, second)
        assert ghosts.newest(second) == whole[second] != whole[first]


@pytest.mark.parametrize(
    "order",
    [ChooseMode(mode="end_effector", axes=1), ChooseMode(mode="assisted", axes=0), ChooseHelp(level="high")],
)
def test_no_report_shows_the_ring_of_the_mode_or_help_before(desk, order):
    desk.each_tick = lambda now_s: desk.order(order) if round(now_s / PERIOD_S) == 43 else None
    desk.run(0.8)
    assert len(desk.reports[40].ghosts.ring) == DIRECTIONS
    changed = next(
        at for at, one in enumerate(desk.reports) if (one.mode, one.axes, one.help) != ("latent", 0, "off")
    )
    after = [one.ghosts for one in desk.reports[changed:]]
    known = next(at for at, ghosts in enumerate(after) if ghosts != NO_GHOSTS)
    assert 0 < known < 20
    for ghosts in after[known:]:
        np.testing.assert_allclose(ghosts.ring, after[-1].ring, atol=5e-3)


def test_an_orientation_is_the_same_whichever_sign_its_quaternion_has():
    """That of a tool that points down has no real part to tell the sign by."""

    def shown(shift_m, sign):
        row = (0.5 + shift_m, 0.0, 0.3, *(sign * np.array([1e-4, 1.0, 0.0, 0.0])))
        path = ((0.5 + shift_m, 0.0, 0.3),) * 6
        return Ghosts(up=path, down=path, left=path, right=path, ring=(tuple(map(float, row)),) * 32)

    memory = PageMemory()
    assert memory.new_ghosts(shown(0.0, 1.0))
    assert not memory.new_ghosts(shown(0.0, -1.0))
    assert not memory.new_ghosts(shown(0.0005, -1.0))
    assert memory.new_ghosts(shown(0.002, 1.0))
    assert memory.new_ghosts(NO_GHOSTS)
    assert not memory.new_ghosts(NO_GHOSTS)
