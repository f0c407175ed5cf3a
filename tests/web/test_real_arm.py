"""A real arm behind the page: made and connected once, kept, never moved by anything but driving."""

import time
from dataclasses import replace

import numpy as np
import pytest
from wooden_server import wooden_server

from latentarm.control.clock import MonotonicClock
from latentarm.core.errors import UserError
from latentarm.robots.panda import panda
from latentarm.web.arm_process.arm_lifecycle import first_arm, from_where_it_stands, next_arm
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.arm_process.initial_state import RobotOptions
from latentarm.web.server.app import serve
from latentarm.web.server.config import TeleopConfig
from latentarm.web.server.loaded_run import LoadedRun

ONE_JOINT = """<mujoco><compiler angle="radian"/><worldbody><body>
<joint name="hinge" axis="0 1 0" range="-1 1"/><geom type="capsule" size="0.02 0.2" pos="0 0 0.2"/>
<site name="tool" pos="0 0 0.4"/></body></worldbody>{keys}</mujoco>"""

NOWHERE = "wooden://127.0.0.1:1"
PANDA = RobotOptions("panda")


@pytest.fixture(scope="module")
def server():
    with wooden_server(panda()) as server:
        yield server


def test_without_a_run_a_real_arm_has_nothing_about_it_and_its_way_back_leads_home():
    setup = load_setup(Spec(arm=NOWHERE, robot=PANDA))
    assert setup.real
    assert (setup.task.goals, tuple(setup.task.obstacles), setup.scene) == ((), (), None)
    np.testing.assert_array_equal(setup.start, setup.task.robot.home)
    assert LoadedRun(setup, None).welcome("me", "server").real is not None


def test_the_robot_of_a_real_arm_can_be_named_with_its_limits(tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text("[joints.joint1]\nvelocity_rad_per_s = 0.7\n")
    setup = load_setup(Spec(arm=NOWHERE, robot=RobotOptions("panda", limits=limits)))
    assert setup.task.robot.limits.velocity[0] == 0.7


def test_a_task_with_things_drives_a_real_arm_without_physics():
    setup = load_setup(Spec(arm=NOWHERE, task="marshmallows", robot=RobotOptions("panda_fork")))
    assert [thing.name for thing in setup.tracked] == list(setup.objects) == list(setup.scene.names)
    assert setup.task.goals == ()
    assert len(setup.task.obstacles) > 0
    assert setup.task.robot.tines is not None


def test_a_run_goes_with_a_real_arm_and_its_goals_are_those_of_its_demonstrations(trained):
    setup = load_setup(Spec(trained, arm=NOWHERE))
    assert len(setup.task.goals) == 3
    assert setup.modes[0] == "latent"


@pytest.mark.parametrize("task", [None, "reach", "marshmallows"])
def test_no_robot_is_taken_for_a_real_arm_that_nobody_named(task):
    with pytest.raises(UserError, match=r"^A real arm is driven only as a robot that you name: .*--robot"):
        load_setup(Spec(arm=NOWHERE, task=task))


@pytest.mark.parametrize("arm", ["brass://127.0.0.1", "wooden://", "brass"])
def test_an_address_without_a_driver_is_refused_where_it_was_typed(arm):
    with pytest.raises(UserError, match=r"^--arm.*\.$"):
        load_setup(Spec(arm=arm, robot=PANDA))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("?rate=30", "loop runs at 100 Hz, but the arm takes 30"),
        ("?stops_after=0.3", "takes 300 ms until it stops by itself"),
        ("?colour=red", "option colour"),
    ],
)
def test_an_arm_that_cannot_be_driven_is_refused_before_anything_is_served(server, options, said):
    config = TeleopConfig(Spec(arm=server.address + options, robot=PANDA), port=0)
    with pytest.raises(UserError, match=said):
        serve(config, lambda sentence: None, pytest.fail)


def test_no_arm_at_all_is_one_sentence():
    with pytest.raises(UserError, match=r"^There is no wooden arm at 127.0.0.1:1\.$"):
        serve(TeleopConfig(Spec(arm=NOWHERE, robot=PANDA), port=0), lambda sentence: None, pytest.fail)


def test_a_real_arm_is_connected_once_and_kept_for_the_same_robot(server, trained):
    clock = MonotonicClock()
    before = load_setup(Spec(arm=server.address, robot=PANDA))
    arm = first_arm(before, clock)
    try:
        hellos = server.requests.count("hello")
        again = load_setup(replace(before.spec, seed=1))
        assert next_arm(again, before, arm, clock) is arm
        with_run = load_setup(replace(before.spec, run=trained))
        assert next_arm(with_run, before, arm, clock) is arm
        assert server.requests.count("hello") == hellos
        other = load_setup(Spec(arm=server.address, task="marshmallows", robot=RobotOptions("panda_fork")))
        with pytest.raises(UserError, match="connected as panda"):
            next_arm(other, before, arm, clock)
    finally:
        arm.close()


def test_the_way_back_leads_to_where_a_real_arm_stood(server):
    setup = load_setup(Spec(arm=server.address, robot=PANDA))
    arm = first_arm(setup, MonotonicClock())
    try:
        np.testing.assert_allclose(from_where_it_stands(setup, arm).start, server.positions(), atol=1e-6)
    finally:
        arm.close()
    simulated = load_setup(Spec())
    assert from_where_it_stands(simulated, first_arm(simulated, MonotonicClock())) is simulated


def test_home_is_offered_only_where_the_robot_states_one(tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text(
        "tool_speed_m_per_s = 1.0\n[joints.hinge]\nvelocity_rad_per_s = 2.0\nacceleration_rad_per_s2 = 10.0\n"
        "jerk_rad_per_s3 = 1000.0\n"
    )
    key = '<keyframe><key name="home" qpos="0.3"/></keyframe>'
    for named, keys in ((False, ""), (True, key)):
        model = tmp_path / f"{named}.xml"
        model.write_text(ONE_JOINT.format(keys=keys))
        setup = load_setup(Spec(arm=NOWHERE, robot=RobotOptions(str(model), limits=limits)))
        assert (LoadedRun(setup, None).built_in("home", "Home") is not None) == named


@pytest.mark.clock
def test_a_page_drives_it_and_what_ends_the_page_stops_it(serve_arm, server):
    with serve_arm(server) as site, site.page() as page:
        assert page.welcome["real"]["facts"]
        begun = server.positions()
        time.sleep(0.3)
        np.testing.assert_array_equal(server.positions(), begun)
        page.send(type="mode", mode="end_effector", axes=0)
        page.drive(1.0, 0.0)
        assert np.abs(server.positions() - begun).max() > 0.01
        site.control.end()
        rested = server.positions()
        time.sleep(0.2)
        np.testing.assert_allclose(server.positions(), rested, atol=1e-3)


def test_no_client_enables_it_before_it_has_confirmed_the_checklist(serve_arm, server):
    with serve_arm(server) as site, site.page("Ada") as page, site.page("Bob") as bob:
        page.u = [0.0, 0.0]
        for confirmed in ({}, {"arm_start": page.state["arm_start"] + 1}):
            if confirmed:
                page.confirm(**confirmed)
            page.state["note"] = None
            server.requests.clear()
            page.send(type="enable")
            page.wait(lambda state: state["note"] and state["note"]["code"] == "checklist_first")
            time.sleep(0.4)
            assert "enable" not in server.requests
        bob.confirm()  # one person confirms nothing for another
        page.send(type="enable")
        time.sleep(0.4)
        assert "enable" not in server.requests
        page.enable()
        assert "enable" in server.requests
        page.send(type="stop")
        page.wait(lambda state: state["phase"] == "disengaged")
        server.cut()
        page.wait(lambda state: state["lost"])
        server.repair()
        page.send(type="reconnect")
        page.wait(lambda state: not state["lost"])
        server.requests.clear()
        page.send(type="enable")
        time.sleep(0.4)
        assert "enable" not in server.requests
        page.enable()


def test_a_confirmation_that_leaves_out_a_point_is_no_message_of_a_page(serve_arm, server):
    with serve_arm(server) as site, site.page() as page:
        page.send(type="confirm", arm_start=0, stop=True, area=False, payload=True)
        page.wait_closed()


@pytest.fixture
def serve_arm(serve, tmp_path):
    return lambda server: serve(
        Spec(arm=server.address, robot=PANDA, out=tmp_path / "teleop", found=(("firmware", "2.1"),))
    )
