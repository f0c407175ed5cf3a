"""A gripper that a limits file states."""

from pathlib import Path

import numpy as np
import pytest

from latentarm.arms.mujoco import MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand
from latentarm.robots.catalogue import load_robot
from latentarm.robots.limits_file import limits_document, parse_limits
from latentarm.robots.robot import Robot

GRIPPER = {"joints": ["gripper"], "width_m": 0.1, "speed_m_per_s": 0.1, "force_n": 5}

MODEL = """
<mujoco model="jawed"><compiler angle="radian"/><worldbody>
  <body><joint name="pan" axis="0 0 1" range="-2 2" actuatorfrcrange="-3 3"/>
    <geom type="capsule" size="0.02" fromto="0 0 0.03 0 0 0.1" mass="0.3"/>
    <body pos="0 0 0.15"><joint name="lift" axis="0 1 0" range="-2 2" actuatorfrcrange="-3 3"/>
      <geom type="capsule" size="0.02" fromto="0 0 0.03 0 0 0.1" mass="0.3"/><site name="tool" pos="0 0 0.2"/>
      <body pos="0.03 0 0.12"><joint name="gripper" axis="0 1 0" range="-0.2 1.8"/>
        <geom type="capsule" size="0.005" fromto="0 0 0 0 0 0.06" mass="0.05" contype="0" conaffinity="0"/>
      </body></body></body>
</worldbody></mujoco>
"""


def _robot(folder: Path, **changes: object) -> Robot:
    path = folder / "jawed.xml"
    path.write_text(MODEL)
    return load_robot(str(path), None, parse_limits({"gripper": GRIPPER | changes}, "limits.toml"))


def test_it_is_kept_with_a_dataset() -> None:
    stated = parse_limits({"gripper": GRIPPER}, "limits.toml")
    assert parse_limits(limits_document(stated), "info.json") == stated


def test_a_jaw_that_turns_closes_and_opens_in_physics(tmp_path: Path) -> None:
    robot = _robot(tmp_path)
    clock = SimulatedClock()
    arm = MujocoArm(robot, robot.home, clock.now_s)
    arm.connect()
    arm.enable()
    assert arm.read().gripper.width_m == pytest.approx(0.1, abs=0.002)
    for goal_m in (0.0, 0.06):
        for _ in range(100):
            arm.send(Command(np.zeros(2), 0.05, gripper=GripperCommand(goal_m, 0.1, 5.0)))
            clock.wait_until(clock.now_s() + 0.02)
        assert arm.read().gripper.width_m == pytest.approx(goal_m, abs=0.003)
    np.testing.assert_allclose(arm.read().q, robot.home, atol=0.01)


def test_a_gripper_that_the_model_lacks_can_be_stated_and_is_not_simulated(tmp_path: Path) -> None:
    robot = _robot(tmp_path, joints=[])
    assert robot.gripper is not None
    assert robot.gripper.joints == ()
    with pytest.raises(UserError, match="has no joints in the model"):
        MujocoArm(robot, robot.home, SimulatedClock().now_s)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"joints": ["thumb"]}, "thumb"),
        ({"joints": ["pan"]}, "driven as one of the arm's"),
        ({"joints": [1]}, "list of names"),
        ({"joints": "gripper"}, "list of names"),
        ({"width_m": -0.1}, "above zero"),
        ({"width_mm": 100}, "width_mm"),
    ],
)
def test_what_makes_no_sense_is_refused(tmp_path: Path, changes: dict[str, object], says: str) -> None:
    with pytest.raises(UserError, match=says):
        _robot(tmp_path, **changes)


def test_a_missing_figure_is_named() -> None:
    with pytest.raises(UserError, match="force_n"):
        parse_limits({"gripper": {key: GRIPPER[key] for key in GRIPPER if key != "force_n"}}, "limits.toml")
