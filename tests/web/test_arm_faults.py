"""What the page says and does when something happens to the arm, in simulated time."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.joined import JoinedController
from latentarm.assistance.controllers.latent import LatentController
from latentarm.models.pca.training import PCA
from latentarm.tasks.table_top import TableTop
from latentarm.web.arm_process.drive import Drive
from latentarm.web.arm_process.steering import Steering
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.orders import Enable

from .conftest import said

GRIPPER = ("observation.gripper_width", "action.gripper")

PRESSED = "The emergency stop on the arm is pressed: release it first."


def drive(desk, happenings, enabled_at_s=(0.1,)):
    """Push after 0.5 s, but let go for 0.3 s around each later Enable."""
    todo = sorted(happenings.items())

    def tick(now_s):
        for at_s in enabled_at_s:
            if abs(now_s - at_s) < 0.005:
                desk.order(Enable(driver=1, stops=desk.channel.stop.version))
        neutral = now_s < 0.5 or any(abs(now_s - at_s) < 0.15 for at_s in enabled_at_s)
        desk.give(0.0 if neutral else 1.0, 0.0)
        while todo and now_s >= todo[0][0]:
            todo.pop(0)[1]()

    desk.each_tick = tick


def reported(desk, at_s):
    return min(desk.reports, key=lambda report: abs(report.time_s - at_s))


def moving(desk, first_s, last_s):
    times = desk.times()
    return bool(desk.speeds()[(times > first_s) & (times < last_s)].any())


def test_an_emergency_stop_is_shown_and_enabling_waits_for_its_release(desk):
    drive(
        desk,
        {1.0: desk.arm.press_emergency_stop, 2.0: desk.arm.release_emergency_stop},
        enabled_at_s=(0.1, 1.5, 2.5),
    )
    desk.run(3.5)
    assert moving(desk, 0.6, 1.0)
    assert PRESSED in said(reported(desk, 1.2))
    assert PRESSED in said(reported(desk, 1.7))
    assert "is released" in said(reported(desk, 2.3))
    assert not moving(desk, 1.02, 2.5)
    assert moving(desk, 2.8, 3.4)


def test_after_a_collision_enable_recovers_the_arm(desk):
    drive(
        desk,
        {1.0: lambda: desk.arm.break_down("The arm has hit something.", recoverable=True)},
        enabled_at_s=(0.1, 1.5),
    )
    desk.run(2.5)
    assert "The arm has hit something." in said(reported(desk, 1.2))
    assert not moving(desk, 1.02, 1.5)
    assert moving(desk, 1.8, 2.4)


def test_a_collision_is_said_of_an_arm_that_something_else_had_stopped(desk):
    def collide(what):
        return lambda: desk.arm.break_down(what, recoverable=True)

    def stop():
        desk.channel.stop.write(Notice(code="stop_pressed").model_dump_json().encode())

    drive(
        desk,
        {
            0.9: stop,
            1.0: collide("The arm has hit something."),
            1.9: stop,
            2.0: collide("It has hit it again."),
        },
        enabled_at_s=(0.1, 1.5, 2.5),
    )
    desk.run(3.0)
    assert "Somebody pressed Stop." in said(reported(desk, 0.95))
    assert "The arm has hit something." in said(reported(desk, 1.2))
    assert "It has hit it again." in said(reported(desk, 2.2))
    assert moving(desk, 2.8, 2.9)


def test_a_lost_connection_to_the_arm_is_said_in_a_sentence(desk):
    drive(desk, {1.0: desk.arm.cut})
    desk.run(2.0)
    report = reported(desk, 1.5)
    assert "no report from the arm for 60 ms" in said(report)
    # What is shown is where the arm was last seen.
    assert np.isfinite(report.q).all()
    assert np.isfinite(report.tool).all()


def joint_speed(desk, at_s):
    """The fastest joint's over the 20 ms before, rad/s."""
    before, after = (np.array(reported(desk, one_s).q) for one_s in (at_s - 0.02, at_s))
    return np.abs(after - before).max() / 0.02


def test_the_arm_in_physics_is_driven_and_at_rest_soon_after_letting_go(desk_in_physics):
    desk = desk_in_physics
    drive(desk, {}, enabled_at_s=(0.1, 1.65))  # lets go from 1.5 to 1.8 s
    desk.run(1.75)
    assert reported(desk, 1.0).phase == "moving"
    assert joint_speed(desk, 1.0) > 0.05
    assert joint_speed(desk, 1.74) < 0.01
    start, end = (
        desk.setup.task.robot.chain.forward(np.array(reported(desk, at_s).q)) for at_s in (0.4, 1.4)
    )
    assert np.linalg.norm(end.position - start.position) > 0.05


def test_a_model_that_sees_the_gripper_outlives_readings_that_do_not_come(desk):
    shown = TableTop().demonstrate(4, np.random.default_rng(0))
    told = tuple(
        replace(one, extras={name: np.linspace(0.08, 0.0, len(one.state))[:, None] for name in GRIPPER})
        for one in shown.episodes
    )
    decoder = PCA(context=("joints", "gripper")).fit(replace(shown, episodes=told, objects=())).decoder()
    robot = desk.setup.task.robot
    controller = JoinedController([LatentController(decoder), EndEffectorController(robot)])
    setup = replace(desk.setup, controller=controller)
    on = (desk.arm, desk.channel, desk.clock, desk.writer, lambda: False, Steering("latent"))
    desk.drive = Drive(setup, *on, observers=[desk._saw])
    drive(desk, {1.0: desk.arm.cut})
    desk.run(2.0)
    assert moving(desk, 0.6, 1.0)
    assert desk.reports[0].gripper.width_m == pytest.approx(0.08)
    assert max(report.tick for report in desk.reports) > 150
    assert np.isnan(desk.records[-1].state).all()
