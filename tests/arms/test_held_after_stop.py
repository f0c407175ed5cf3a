"""What is between the fingers when Stop comes is pressed no harder afterwards.

`python tests/arms/test_held_after_stop.py` prints the table of `docs/your-arm.md`.
"""

import sys

import mujoco
import numpy as np
import pytest

from latentarm.arms.mujoco import MujocoArm
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import Input, Pose
from latentarm.robots.catalogue import load_robot
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Part, Thing
from latentarm.safety.config import SafetyConfig

THICK_M = 0.016
SOFT = (-500.0, -2.0 * np.sqrt(500.0))
"""MuJoCo's stiffness and damping of a contact that gives way by some 5 mm under 20 N."""
FIFTY_MS, A_SECOND = 5, 100


class Caught:
    """Something fixed between the fingers of an enabled arm that was told to close."""

    def __init__(self, *, soft=False, speed=0.05):
        robot = load_robot("panda")
        tool = robot.chain.forward(robot.home)
        between = Pose(np.ravel(tool.position), np.reshape(tool.rotation, (3, 3)))
        finger = Thing("finger", (Part("box", (0.006, THICK_M / 2, 0.01)),), 0.05, between, fixed=True)
        self.clock = SimulatedClock()
        self.arm = MujocoArm(robot, robot.home, self.clock.now_s, scene=Scene((finger,)))
        if soft:
            model = self.arm.model
            names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body) for body in model.geom_bodyid]
            fixed = model.body_weldid[model.geom_bodyid] == 0
            caught = fixed & np.array(["finger" in (name or "") for name in names])
            assert caught.any()
            model.geom_solref[caught], model.geom_priority[caught] = SOFT, 5
            model.geom_solimp[caught] = (0.9, 0.9, 0.001, 0.5, 2.0)
        self.arm.connect()
        self.arm.enable()
        self.step = Step(robot, EndEffectorController(robot), SafetyConfig(gripper_speed=speed))
        self.step.reset(robot.home)
        self.tick()
        assert self.step.enable() is None
        self.tick("close")
        for _ in range(1000):
            if self.arm.scene_state().force_n:
                return
            self.tick()
        raise AssertionError("the fingers meet nothing")

    def tick(self, ask=None, opens=False):
        """How hard a finger presses afterwards, N."""
        given = Input(np.zeros(2), gripper=ask, opens=opens)
        now_s = self.clock.now_s()
        record = self.step(given, 0.0, self.arm.read(), now_s)
        self.step.sent(now_s)
        self.arm.send(record.command)
        self.clock.wait_until(now_s + 0.01)
        self.arm.scene_state()
        return float(np.abs(self.arm.data.actuator_force[-2:]).max())

    def stopped_after(self, seconds):
        """How hard it was when Stop came so long after they met, and in each tick afterwards, N."""
        before = 0.0
        for _ in range(max(round(100 * seconds), 1)):
            before = self.tick()
        self.step.stop("Stop.")
        return before, [self.tick() for _ in range(A_SECOND)]


@pytest.mark.parametrize("soft", [False, True])
@pytest.mark.parametrize(("after_s", "speed"), [(0.02, 0.05), (0.2, 0.05), (0.2, 0.01), (1.0, 0.05)])
def test_stop_never_presses_harder(soft, after_s, speed):
    caught = Caught(soft=soft, speed=speed)
    before, afterwards = caught.stopped_after(after_s)
    assert before > 0.5
    assert max(afterwards) <= before * 1.001 + 0.01
    if caught.arm.read().gripper.holding and before > 19.9:
        # A cup does not fall.
        assert min(afterwards) > 0.99 * before


def test_fingers_that_shake_when_stop_comes_keep_what_they_hold():
    caught, joints = Caught(), load_robot("panda").gripper.joints
    before, _ = caught.stopped_after(0.5)
    assert caught.step.enable() is None
    caught.tick()
    caught.arm.data.qvel[[caught.arm.model.joint(name).dofadr[0] for name in joints]] = 0.03
    caught.step.stop("Stop.")
    caught.tick()
    assert caught.arm.read().gripper.holding
    assert min(caught.tick() for _ in range(A_SECOND)) > 0.99 * before


def test_what_is_caught_comes_free_by_holding_open_and_stays_held_when_the_arm_is_enabled():
    caught = Caught()
    before, _ = caught.stopped_after(0.5)
    assert caught.step.enable() is None
    enabled = [caught.tick() for _ in range(50)]
    assert max(enabled) <= before * 1.001
    assert min(enabled) > 0.99 * before
    caught.step.stop("Stop.")
    for _ in range(100):
        assert caught.tick(opens=True) > 0.99 * before
    for _ in range(40):
        caught.tick(opens=True)
    assert caught.arm.read().gripper.width_m > THICK_M + 0.01
    assert not caught.arm.read().gripper.holding


if __name__ == "__main__":
    sys.stdout.write("| pressed when Stop came | 50 ms later | 1 s later |\n|---|---|---|\n")
    for is_soft in (False, True):
        for met_s in (0.02, 0.06, 0.2, 1.0):
            first, later = Caught(soft=is_soft).stopped_after(met_s)
            what = f"{'soft' if is_soft else 'hard'}, touched for {met_s:g} s: {first:.1f}"
            sys.stdout.write(f"| {what} | {later[FIFTY_MS - 1]:.1f} | {later[-1]:.1f} |\n")
