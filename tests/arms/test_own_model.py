"""The model is the arm: what the arm says of itself is compared with it, in mm and degrees."""

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbridge_server import RosbridgeServer, Setup
from scipy.spatial.transform import Rotation

from arms.xarm_rig import xarm7
from arms.xarm_server import XArmServer, serving
from latentarm.arms.address import parse_address
from latentarm.arms.catalogue import make_real_arm
from latentarm.arms.checking import look_at
from latentarm.arms.franka.limits import FR3, FrankaLimits
from latentarm.arms.franka.link import Link, refusals
from latentarm.arms.franka.options import FrankaOptions
from latentarm.arms.own_pose import OwnPose, compared, kind_misfit, misfits, poses_about
from latentarm.arms.real import Findings
from latentarm.arms.ros2.options import read_options
from latentarm.arms.ros2.own_model import Description
from latentarm.control.clock import MonotonicClock
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, StatedJointLimits, StatedLimits
from latentarm.robots.assemble import restate
from latentarm.robots.catalogue import ROBOTS, load_robot
from latentarm.robots.panda import fr3, panda
from latentarm.robots.robot import Robot

XARM_HOME = [0.0, -0.4, 0.0, 0.9, 0.0, 1.3, 0.0]


def longer(robot: Robot, by_m: float = 0.1) -> Robot:
    """The same arm with a longer tool."""
    tool = robot.chain.tools[0]
    transform = tool.transform.copy()
    transform[:3, 3] += by_m * transform[:3, 2]
    return replace(robot, chain=replace(robot.chain, tools=(replace(tool, transform=transform),)))


def swapped(robot: Robot, one: int, other: int) -> Robot:
    """The model of an arm in which two joints come in each other's place."""
    offset = robot.chain.offset.copy()
    offset[[one, other]] = offset[[other, one]]
    return replace(robot, chain=replace(robot.chain, offset=offset))


def wider(robot: Robot, by_deg: float = 5.0) -> Robot:
    """The same arm, with a second joint that may go farther."""
    name, limits = robot.joint_names[1], robot.limits
    position = float(limits.lower[1] - np.radians(by_deg)), float(limits.upper[1])
    return restate(robot, StatedLimits(joints={name: StatedJointLimits(position=position)}))


def told(robot: Robot, q: FloatArray, flange: int | None) -> OwnPose:
    """The pose that this robot reports, by MuJoCo's own kinematics; ``flange`` is a body before its tool."""
    model = robot.model()
    data = mujoco.MjData(model)
    for name, position in zip(robot.joint_names, q, strict=True):
        data.qpos[model.joint(name).qposadr[0]] = position
    mujoco.mj_kinematics(model, data)
    name, tool, body = robot.chain.tools[0].name, np.eye(4), np.eye(4)
    is_site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name) >= 0
    at = data.site(name) if is_site else data.body(name)
    tool[:3, :3], tool[:3, 3] = at.xmat.reshape(3, 3), at.xpos
    if flange is None:
        return OwnPose(q, tool)
    body[:3, :3], body[:3, 3] = data.xmat[flange].reshape(3, 3), data.xpos[flange]
    return OwnPose(q, tool, np.linalg.inv(body) @ tool)


def flange_of(robot: Robot) -> int:
    """The body that carries the last joint of the tool."""
    model = robot.model()
    return int(model.jnt_bodyid[model.joint(robot.joint_names[robot.chain.tools[0].link]).id])


@pytest.mark.parametrize("name", [*ROBOTS, "xarm7"])
@pytest.mark.parametrize("tells_flange", [True, False])
def test_an_arm_is_accepted_as_its_own_model(name: str, tells_flange: bool) -> None:
    robot = xarm7() if name == "xarm7" else load_robot(name)
    flange = flange_of(robot) if tells_flange else None
    q = 0.9 * robot.home + 0.05
    poses = [told(robot, one, flange) for one in (q, *poses_about(q, robot))]
    assert misfits(poses, robot) == ()
    assert "0.0 mm and 0.0° from the model's at 4 poses" in compared(poses, robot).value


@given(st.lists(st.floats(-0.4, 0.4), min_size=7, max_size=7), st.floats(0.006, 0.3), st.booleans())
def test_a_tool_of_another_length_is_refused_by_as_much_as_it_is_longer(
    by: list[float], longer_m: float, tells_flange: bool
) -> None:
    robot = panda()
    q = robot.home + np.array(by)
    (said,) = misfits([told(robot, q, flange_of(robot) if tells_flange else None)], longer(robot, longer_m))
    assert f"which is {1000 * longer_m:.0f} mm and 0.0° from tool of panda" in said
    assert ("set the tool on the arm to (0, 0, " in said) == tells_flange


def test_what_to_set_is_told_of_a_tool_at_right_angles_too() -> None:
    robot = panda()
    tool = robot.chain.tools[0]
    turned = tool.transform.copy()
    turned[:3, :3] = tool.transform[:3, :3] @ Rotation.from_euler("y", 90.0, degrees=True).as_matrix()
    model = replace(robot, chain=replace(robot.chain, tools=(replace(tool, transform=turned),)))
    (said,) = misfits([told(robot, robot.home, flange_of(robot))], model)
    assert "0 mm and 90.0° from tool" in said
    assert ", 90, " in said.split("roll, pitch, yaw")[1]


@given(st.integers(0, 6), st.integers(0, 6))
def test_joints_in_each_others_place_are_told_apart_by_poses_in_which_no_two_stand_alike(
    one: int, other: int
) -> None:
    robot = panda()
    model = swapped(robot, one, other)
    q = np.zeros(7)
    q[3], q[5] = -1.5, 1.5
    poses = [told(robot, where, flange_of(robot)) for where in (q, *poses_about(q, robot))]
    same = np.array_equal(model.chain.offset, robot.chain.offset)
    assert (misfits(poses, model) == ()) == same


def test_joints_that_stand_alike_are_named_where_one_pose_cannot_tell_them_apart() -> None:
    robot = panda()
    q = np.array([0.0, 0.0, 0.0, -1.5, 0.0, 1.5, 0.0])
    fact = compared([told(robot, q, None)], robot)
    assert "does not tell apart joint1 and joint2, joint1 and joint3" in fact.value
    assert "--guided" in fact.value
    assert (
        "tell apart" not in compared([told(robot, one, None) for one in poses_about(q, robot)], robot).value
    )


def test_names_that_say_another_arm_are_refused_and_unknown_ones_are_not() -> None:
    assert kind_misfit("xArm 7", panda())
    assert kind_misfit("fr3", panda())
    assert not kind_misfit("panda", load_robot("panda_fork"))
    assert not kind_misfit("UF_ROBOT", panda())
    assert not kind_misfit("xArm 7", replace(panda(), name="/home/panda/xarm7.urdf"))
    assert not kind_misfit("xArm 7", replace(panda(), name="/home/panda/arm.urdf"))


WRONG: dict[str, tuple[Callable[[Robot], Robot], str]] = {
    "swapped joints": (
        lambda robot: swapped(robot, 4, 6),
        r"says that its (flange|tool) is at .* mm and .*°",
    ),
    "a limit by degrees": (wider, "lower limit of joint2 is -1.*° for .* and -1.*° for the arm"),
    "a tool 10 cm longer": (longer, r"100 mm and 0\.0° from tool"),
}


def looked(address: str, robot: Robot) -> Findings:
    arm = make_real_arm(address, robot, MonotonicClock().now_s)
    try:
        return look_at(arm, robot, 0.01)
    finally:
        arm.close()


def refused(address: str, robot: Robot, said: str) -> None:
    sentences = looked(address, robot).refusals
    assert any(re.search(said, sentence) for sentence in sentences), sentences
    assert all(sentence.endswith(".") and ". " not in sentence for sentence in sentences)


@pytest.fixture(scope="module")
def xarm() -> Iterator[XArmServer]:
    with serving(q=XARM_HOME) as server:
        yield server


@pytest.mark.clock
@pytest.mark.parametrize("wrong", list(WRONG))
def test_an_xarm_is_refused_as_another_arm(xarm: XArmServer, wrong: str) -> None:
    model, said = WRONG[wrong]
    refused(xarm.address(), model(xarm7()), said)


@pytest.mark.clock
def test_an_xarm_7_is_no_panda_whatever_the_model_is_called(xarm: XArmServer) -> None:
    refused(xarm.address(), panda(), "says that its type is xArm 7, and panda is Franka Emika Panda")
    unnamed = replace(panda(), name="arm")
    refused(xarm.address(), unnamed, r"its flange is at .*, which is \d{2,3} mm and .*° from \w+ of arm")


@pytest.mark.clock
def test_an_xarm_is_accepted_with_the_tool_that_is_set_on_it_and_told_what_to_set(xarm: XArmServer) -> None:
    found = looked(xarm.address(), xarm7())
    assert found.refusals == ()
    assert {"tool pose", "tool set on the arm"} <= {fact.name for fact in found.facts}
    xarm.do("set", tool_offset=[0.0] * 6)
    try:
        refused(xarm.address(), xarm7(), r"set the tool on the arm to \(0, 0, 100\) mm")
        assert looked(xarm.address(), longer(xarm7(), -0.1)).refusals == ()
    finally:
        xarm.do("set", tool_offset=[0.0, 0.0, 100.0, 0.0, 0.0, 0.0])
    xarm.do("set", base_offset=[0.0, 0.0, 50.0, 0.0, 0.0, 0.0])
    try:
        refused(xarm.address(), xarm7(), "set the base coordinate offset to zero")
    finally:
        xarm.do("set", base_offset=[0.0] * 6)


@pytest.fixture(scope="module")
def ros() -> Iterator[RosbridgeServer]:
    with RosbridgeServer(panda()) as server:
        yield server


@pytest.mark.clock
@pytest.mark.parametrize("setup", [Setup(), Setup(describes=False), Setup(frames=False)])
@pytest.mark.parametrize("wrong", [None, *WRONG])
def test_an_arm_behind_ros_is_refused_as_another_arm(
    ros: RosbridgeServer, wrong: str | None, setup: Setup
) -> None:
    ros.setup = setup
    if wrong is None:
        found = looked(ros.address, panda())
        assert found.refusals == ()
        assert "0.0 mm" in next(fact.value for fact in found.facts if fact.name == "tool pose")
    elif setup.describes or wrong != "a limit by degrees":  # only a description has limits
        model, said = WRONG[wrong]
        refused(ros.address, model(panda()), said)


@pytest.mark.clock
def test_what_ros_does_not_say_is_not_compared_and_that_is_said(ros: RosbridgeServer) -> None:
    ros.setup = Setup(describes=False, frames=False)
    found = looked(ros.address, panda())
    assert found.refusals == ()
    assert "not told" in next(fact.value for fact in found.facts if fact.name == "tool pose")
    ros.setup = Setup()
    refused(f"{ros.address}&tool_frame=hand", panda(), "tool_frame=NAME, one of .*tool")
    assert looked(f"{ros.address}&base_frame=base", panda()).refusals == ()
    refused(f"{ros.address}&base_frame=link1", panda(), "its tool is at")


@pytest.mark.clock
def test_an_fr3_behind_ros_is_no_panda() -> None:
    with RosbridgeServer(fr3()) as server:
        refused(server.address, panda(), "says that its type is Franka Research 3")


@pytest.mark.parametrize("text", ["", "<robot", "<robot name='a'><link name='b'/></robot>", "<html/>"])
def test_a_description_that_is_none_is_one_sentence(text: str) -> None:
    options = read_options(parse_address("ros2://arm?controller=c&gripper_joint=f"), panda())
    try:
        said = " ".join(Description(text, options).misfits(panda()))
    except UserError as error:
        said = str(error)
    assert said.endswith(".")


class FakeFranka:
    """A Franka's state and model, as franky tells them, by the Panda's kinematics."""

    def __init__(self, robot: Robot, tool: FloatArray) -> None:
        self.chain = robot.chain
        last = robot.chain.link_transforms(robot.home)[-1]
        flange = last @ _along(0.107)
        self.model = self
        self.state = SimpleNamespace(
            q=robot.home, F_T_EE=_affine(tool), F_T_NE=_affine(tool), O_T_EE=_affine(flange @ tool)
        )
        self._flange = flange

    def pose(self, frame: object, state: object) -> Any:
        return SimpleNamespace(translation=self._flange[:3, 3])

    def zero_jacobian(self, frame: object, state: Any) -> FloatArray:
        axes, anchors = self.chain.joint_axes(self.chain.link_transforms(np.asarray(state.q)))
        return np.vstack([np.cross(axes, self._flange[:3, 3] - anchors).T, axes.T])


def _along(by_m: float, turned: float = 0.0) -> FloatArray:
    frame = np.eye(4)
    frame[:2, :2] = [[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]]
    frame[2, 3] = by_m
    return frame


def _affine(frame: FloatArray) -> Any:
    return SimpleNamespace(matrix=frame)


HAND = _along(0.1034, -np.pi / 4)
"""The Franka Hand as Desk sets it."""


def franka_says(
    robot: Robot, kind: FrankaLimits = FR3, tool: FloatArray = HAND, rate: float = 1.0, **options: Any
) -> str:
    pytest.importorskip("franky", reason="franky-control is not installed")
    link = Link(FakeFranka(fr3(), tool), None, kind)  # pyright: ignore[reportArgumentType]
    return " ".join(refusals(link, FrankaOptions(realtime="ignore", **options), robot, rate))


def test_a_franka_is_accepted_with_its_hand_and_refused_as_another_arm() -> None:
    assert franka_says(fr3()) == ""
    assert "says that its type is Franka Research 3, and panda" in franka_says(panda())
    assert "joint5 is off by" in franka_says(swapped(fr3(), 4, 6))
    assert "--limits" not in franka_says(panda())  # lower ones would not make it a Panda
    assert "The lower limit of joint2 is" in franka_says(wider(fr3()))
    assert "The arm's clock passes 0.179 s" in franka_says(fr3(), rate=0.179)
    assert "100 mm and 0.0° from tool of fr3" in franka_says(longer(fr3()))
    assert "set the tool on the arm to (0, 0, 103) mm" in franka_says(fr3(), tool=np.eye(4))
    assert franka_says(longer(fr3()), attachment_tip_m=(0.0, 0.0, 0.1)) == ""
