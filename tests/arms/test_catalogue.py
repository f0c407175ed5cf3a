"""Arms are made by name; a simulated one can live in real time."""

import numpy as np
import pytest

from latentarm.arms.catalogue import ARMS, DEFAULT_ARM, make_arm, make_live_arm, make_simulated_arm
from latentarm.arms.contract import Arm
from latentarm.errors import UserError
from latentarm.types import Command


class Hardware(Arm):
    simulated = False

    def __init__(self, robot, state):
        self.robot = robot

    def state(self):
        return self.robot.home

    def velocity(self):
        return np.zeros(self.robot.dof)

    def send(self, command):
        raise AssertionError("nothing may be sent")

    def stop(self):
        pass


@pytest.fixture
def registered(monkeypatch):
    monkeypatch.setitem(ARMS._loaded, "hardware", Hardware)
    monkeypatch.setitem(ARMS._loaded, "thing", lambda robot, state: object())
    monkeypatch.setattr(ARMS, "_own", {**ARMS._own, "hardware": ":", "thing": ":"})


def test_the_default_is_in_the_catalogue():
    assert DEFAULT_ARM in ARMS


def test_an_unknown_arm_is_refused(the_panda):
    with pytest.raises(UserError, match="--arm names the arm 'wooden', which is not one of kinematic"):
        make_arm("wooden", the_panda, the_panda.home)


@pytest.mark.usefixtures("registered")
def test_what_is_made_must_be_an_arm(the_panda):
    with pytest.raises(UserError, match="--arm thing made object"):
        make_arm("thing", the_panda, the_panda.home)


@pytest.mark.usefixtures("registered")
def test_time_is_simulated_for_simulated_arms_only(the_panda):
    with pytest.raises(UserError, match="--arm hardware is a real arm"):
        make_simulated_arm("hardware", the_panda, the_panda.home)
    assert isinstance(make_live_arm("hardware", the_panda, the_panda.home, lambda: 0.0), Hardware)


def test_a_live_arm_moves_as_time_passes_and_stops_by_itself(the_panda):
    now_s = 5.0
    arm = make_live_arm("kinematic", the_panda, the_panda.home, lambda: now_s)
    velocity = np.full(7, 0.1)
    arm.send(Command(velocity, duration_s=0.05))
    now_s = 5.02
    np.testing.assert_allclose(arm.state() - the_panda.home, 0.02 * velocity)
    np.testing.assert_array_equal(arm.velocity(), velocity)
    now_s = 6.0
    np.testing.assert_allclose(arm.state() - the_panda.home, 0.05 * velocity)
    assert not arm.velocity().any()
    assert arm.simulated
