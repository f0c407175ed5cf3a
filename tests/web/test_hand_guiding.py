"""A real arm that is guided by hand: recorded, learned from, and held still by whatever ends it."""

import time

import numpy as np
import pytest
from wooden_server import wooden_server

from latentarm.demonstrations.provenance import BY_HAND
from latentarm.recordings.dataset_export import demonstrations_of
from latentarm.recordings.journal_reader import read_journal
from latentarm.robots.panda import panda
from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.arm_process.initial_state import RobotOptions

from .conftest import said, wait_for


@pytest.fixture(scope="module")
def robot():
    return panda()


@pytest.fixture(scope="module")
def arm(robot):
    with wooden_server(robot) as server:
        yield server


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("teleop")


@pytest.fixture(scope="module")
def site(serve, arm, out):
    spec = Spec(arm=arm.address, robot=RobotOptions("panda"), out=out, found=(("firmware", "2.1"),))
    with serve(spec) as site:
        yield site


class Hands:
    """A page whose person guides the arm: it says so as long as `here`."""

    def __init__(self, page):
        self.page = page
        self.said_s = 0.0

    def stay(self, for_s, act=lambda: None):
        end_s = time.monotonic() + for_s
        while time.monotonic() < end_s:
            if time.monotonic() - self.said_s > 0.2:
                self.said_s = time.monotonic()
                self.page.send(type="guided")
            act()
            time.sleep(0.01)

    def begin(self):
        self.page.send(type="guide", on=True)
        self.page.wait(lambda state: state["guiding"] == "on")

    def push(self, arm, by, for_s):
        """Little by little."""
        steps = round(for_s / 0.01)
        self.stay(for_s, lambda: arm.push(by / steps))


def test_a_motion_by_hand_is_recorded_with_the_gripper(site, arm, robot, out):
    by = np.linspace(0.1, 0.2, robot.dof)
    with site.page() as page:
        assert page.state["guiding"] == "offered"
        begun = arm.positions()
        page.send(type="record", on=True, task="wave", by_hand=True)
        time.sleep(0.1)
        assert not (page.state["recording"] or {}).get("on")
        hands = Hands(page)
        hands.begin()
        page.send(type="record", on=True, task="wave", by_hand=True)
        page.wait(lambda state: state["recording"] and state["recording"]["on"])
        hands.push(arm, by, 0.6)
        page.send(type="guided", gripper="close")
        hands.stay(0.2)
        page.wait(lambda state: state["gripper"]["closing"])
        hands.push(arm, by, 0.6)
        page.send(type="record", on=False)
        page.wait(lambda state: not state["recording"]["on"])
        page.send(type="guide", on=False)
        page.wait(lambda state: state["guiding"] == "offered" and "Guiding by hand has ended" in said(state))
        held = arm.positions()
        assert np.abs(held - begun).max() > 0.2
        arm.push(by)
        np.testing.assert_array_equal(arm.positions(), held)
    (episode,) = read_journal(next(out.glob("*.sqlite")))
    assert episode.header.provenance.controller == BY_HAND
    told = [one.command.gripper for one in episode.records]
    assert told[0] is None
    assert told[-1].width_m == 0.0
    assert episode.records[-1].gripper.width_m < episode.records[0].gripper.width_m
    assert not any(one.command.velocity.any() for one in episode.records)


def test_whatever_ends_guiding_lets_the_arm_hold_still(site, arm, robot):
    by = np.full(robot.dof, 0.02)
    with site.page() as page:
        hands = Hands(page)
        hands.begin()
        page.send(type="stop")
        page.wait(lambda state: state["guiding"] == "offered" and "pressed Stop" in said(state))
        wait_for(lambda: not arm.guiding, within_s=0.5)
        hands.begin()
        page.wait(lambda state: "has gone" in said(state))  # it says nothing more
        wait_for(lambda: not arm.guiding, within_s=0.5)
        hands.begin()
        page.enable()
        wait_for(lambda: not arm.guiding, within_s=0.5)
        page.send(type="guide", on=True)
        page.wait(lambda state: "Stop the arm first" in said(state))
        page.u = None
        page.send(type="stop")
        page.wait(lambda state: state["phase"] == "disengaged")
        hands.begin()
        arm.press_emergency_stop()
        page.wait(lambda state: "emergency stop" in said(state))
        arm.release_emergency_stop()
        time.sleep(0.2)
        hands.begin()
    wait_for(lambda: not arm.guiding)  # the page has gone
    held = arm.positions()
    arm.push(by)
    np.testing.assert_array_equal(arm.positions(), held)


def test_a_lost_arm_is_connected_again_by_a_button_and_enabled_by_another(site, arm, robot):
    with site.page() as page:
        page.enable()
        arm.cut()
        page.wait(lambda state: state["lost"], within_s=10.0)
        assert "not connected" in said(page.state)
        page.u = None
        page.send(type="reconnect")
        page.wait(lambda state: "does not answer" in said(state), within_s=20.0)
        assert page.state["lost"]
        arm.repair()
        page.send(type="reconnect")
        page.wait(lambda state: not state["lost"] and "connected again" in said(state), within_s=10.0)
        rested = arm.positions()
        time.sleep(0.3)
        assert page.state["phase"] == "disengaged"
        np.testing.assert_array_equal(arm.positions(), rested)
        page.enable()


@pytest.mark.slow
def test_an_arm_learns_from_motions_by_hand_and_is_driven_with_what_it_learned(site, arm, robot, out):
    rng = np.random.default_rng(0)
    with site.page() as page:
        hands = Hands(page)
        hands.begin()
        before = (page.state["recording"] or {"episodes": 0})["episodes"]
        for number in range(before, before + 4):
            page.send(type="record", on=True, task="reach", by_hand=True)
            page.wait(lambda state: state["recording"] and state["recording"]["on"])
            away = rng.normal(scale=0.2, size=robot.dof)
            hands.push(arm, away, 2.0)
            page.send(type="record", on=False)
            page.wait(lambda state, number=number: state["recording"]["episodes"] == number + 1)
            hands.push(arm, -away, 0.5)
        page.send(type="guide", on=False)
        wait_for(lambda: len(page.learning["recordings"]) >= 4)
        began_s = time.monotonic()
        page.send(
            type="train",
            name="by-hand",
            model="pca",
            latent_dim=2,
            episodes=[
                {key: one[key] for key in ("file", "episode")} for one in page.learning["recordings"][-4:]
            ],
        )
        ended = wait_for(lambda: (page.learning["training"] or {}).get("phase") in ("done", "failed"), 180.0)
        assert ended
        assert page.learning["training"]["phase"] == "done", page.learning["training"]
        assert time.monotonic() - began_s < 120.0
        page.send(type="run", run="by-hand")
        wait_for(lambda: page.welcome["run"] == "by-hand")
        begun = arm.positions()
        page.drive(1.0, 0.0)
        time.sleep(1.0)
        page.u = [0.0, 0.0]
        assert np.abs(arm.positions() - begun).max() > 0.02
    episodes = read_journal(next(out.glob("*.sqlite")))
    assert {one.header.provenance.controller for one in episodes} == {BY_HAND}
    shown = demonstrations_of(episodes, source="the journal").episodes[0]
    moved = np.trapezoid(shown.action, shown.timestamp, axis=0)
    np.testing.assert_allclose(moved, shown.state[-1] - shown.state[0], atol=0.02)
