from pathlib import Path

import mujoco
import numpy as np
import pytest

from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import SimulatedClock
from latentarm.core.errors import UserError
from latentarm.core.types import Command
from latentarm.robots.catalogue import load_robot
from latentarm.robots.model_file import load_model_file
from latentarm.robots.model_xml import MOST_XML_BYTES

ARM = """
<mujoco><worldbody><body name="a"><joint name="j" axis="0 0 1" {joint}/><geom size="0.1"/>
<site name="tip" pos="1 0 0"/>{more}</body></worldbody>{end}</mujoco>
"""


def arm(joint="", more="", end=""):
    return ARM.format(joint=joint, more=more, end=end)


@pytest.mark.parametrize(("which", "tool", "dof"), [("jaco_file", "wristsite", 6), ("ur5e_file", "tool0", 6)])
def test_a_third_partys_arm_loads_and_can_be_driven(which, tool, dof, request):
    path = request.getfixturevalue(which)
    robot = load_robot(str(path))
    assert (robot.dof, robot.chain.tools[0].name, robot.model_path) == (dof, tool, str(path))
    assert 5 <= len(robot.capsules) <= 16
    assert len(robot.self_pairs) <= 40
    # Resolved rates lift the tool straight up.
    clock = SimulatedClock()
    simulated = KinematicArm(robot, robot.home, clock.now_s)
    simulated.connect()
    simulated.enable()
    start = robot.chain.forward(robot.home).position
    for _ in range(50):
        rates = np.linalg.pinv(robot.chain.jacobian(simulated.read().q))[:, 2] * 0.02
        simulated.send(Command(rates, duration_s=0.02))
        clock.wait_until(clock.now_s() + 0.02)
    moved = robot.chain.forward(simulated.read().q).position - start
    np.testing.assert_allclose(moved, [0, 0, 0.02], atol=1e-4)


@pytest.mark.parametrize("which", ["jaco_file", "ur5e_file"])
def test_the_chain_is_that_of_the_file_as_mujoco_reads_it(which, request):
    path = request.getfixturevalue(which)
    robot = load_robot(str(path))
    spec = mujoco.MjSpec.from_file(str(path))
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = robot.home
    mujoco.mj_kinematics(model, data)
    tool = robot.chain.tools[0].name
    placed = data.site(tool) if which == "jaco_file" else data.body(tool)
    pose = robot.chain.forward(robot.home)
    # The robot keeps its model as text with six digits.
    np.testing.assert_allclose(pose.position, placed.xpos, atol=1e-5)
    np.testing.assert_allclose(pose.rotation, placed.xmat.reshape(3, 3), atol=1e-5)


def test_urdf_limits_are_read_from_the_file(ur5e_file):
    limits = load_robot(str(ur5e_file)).limits
    np.testing.assert_allclose(limits.velocity, np.pi, atol=1e-6)
    np.testing.assert_allclose(
        limits.upper, [2 * np.pi, 2 * np.pi, np.pi, 2 * np.pi, 2 * np.pi, 2 * np.pi], atol=1e-4
    )
    assert (limits.acceleration == 10.0).all()


def test_a_model_with_meshes_can_be_rebuilt_from_anywhere(jaco_file, tmp_path, monkeypatch):
    robot = load_robot(str(jaco_file))
    monkeypatch.chdir(tmp_path)
    assert robot.model().nmesh == 5


def test_a_home_without_a_key_frame_is_not_singular(ur5e_file):
    robot = load_robot(str(ur5e_file))
    assert np.linalg.svd(robot.chain.jacobian(robot.home), compute_uv=False).min() > 0.05
    assert robot.chain.forward(robot.home).position[2] > 0.0
    assert not robot.limits.violation(robot.home).any()


def test_a_home_key_frame_is_the_home(written):
    path = written(arm(end='<keyframe><key name="home" qpos="0.7"/></keyframe>'))
    np.testing.assert_allclose(load_model_file(path).home, [0.7])


def test_what_the_file_does_not_say_is_assumed(written):
    robot = load_model_file(written(arm()))
    np.testing.assert_allclose(robot.limits.upper, [2 * np.pi])
    assert (robot.limits.velocity[0], robot.limits.acceleration[0], robot.limits.jerk[0]) == (
        1.0,
        10.0,
        1000.0,
    )
    sliding = load_model_file(written(arm('type="slide" range="-0.1 0.2"')))
    assert (sliding.limits.velocity[0], sliding.limits.upper[0]) == (0.25, 0.2)


def test_joints_without_names_get_some(written):
    robot = load_model_file(
        written(arm(more='<body name="b"><joint axis="0 1 0"/><geom size="0.1"/></body>')), "b"
    )
    assert robot.joint_names == ("j", "joint1")
    assert robot.model().joint("joint1").id == 1


def test_the_end_effector_may_be_left_out_where_there_is_one(written):
    fork = '<site name="other"/><body name="left"/><body name="right"/>'
    with pytest.raises(
        UserError, match=r"robot\.xml: several.*--end-effector, one of left \(1 joint\), other"
    ):
        load_model_file(written(arm(more=fork)))
    assert load_model_file(written(arm(more=fork)), "left").chain.tools[0].name == "left"
    # Two sites but one last body: that is it.
    one = '<site name="other"/><body name="hand"/>'
    assert load_model_file(written(arm(more=one))).chain.tools[0].name == "hand"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "not valid XML: no element found"),
        ("<mujoco><worldbody>", "not valid XML"),
        ("\x00\x01\x02", "not valid XML"),
        ("<svg/>", "neither MJCF nor URDF: its outermost element is <svg>"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><mujoco/>', "declares a document type"),
        ("<mujoco/>", "no hinge or slide joint"),
        ("<mujoco><worldbody><nonsense/></worldbody></mujoco>", "unrecognized element"),
        (arm('type="nonsense"'), "invalid keyword"),
        (arm('range="57.3 0"'), "Joint 1 may move from 57.3 to 0: its lower limit must be below"),
        (arm('type="ball"'), "no hinge or slide joint: j can turn or move freely"),
        (arm(more='<geom type="mesh" mesh="gone"/>'), "cannot be used as a robot: .*mesh"),
        (
            '<mujoco><asset><mesh file="gone.stl"/></asset><worldbody/></mujoco>',
            r"robot: Error opening file .*gone\.stl'\. Leave the model in its folder, with its meshes\.$",
        ),
    ],
)
def test_a_file_that_is_no_robot_is_refused_in_one_sentence(written, text, sentence):
    path = written(text)
    with pytest.raises(UserError, match=sentence) as raised:
        load_model_file(path)
    message = str(raised.value)
    assert str(path) in message
    assert "\n" not in message
    assert message.endswith(".")


def test_an_unknown_end_effector_is_refused_with_the_files_name(written):
    with pytest.raises(UserError, match=r"robot\.xml: .*no site or body named 'thumb'; it has: tip, a"):
        load_model_file(written(arm()), "thumb")


def test_a_folder_is_no_file(tmp_path):
    with pytest.raises(UserError, match="is a folder, not a file"):
        load_model_file(tmp_path)


def test_a_huge_file_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "huge.xml"
    with path.open("wb") as stream:
        stream.truncate(MOST_XML_BYTES + 1)
    with pytest.raises(UserError, match="is too large"):
        load_model_file(path)


def test_a_robot_given_by_a_relative_path_is_found_from_another_folder(written, monkeypatch, tmp_path):
    """A dataset remembers the name, and is trained on and driven from anywhere."""
    path = written(arm())
    monkeypatch.chdir(path.parent)
    name = load_model_file(Path(path.name)).name
    monkeypatch.chdir(tmp_path.parent)
    assert load_robot(name).name == str(path)


@pytest.mark.parametrize(("at", "known"), [(0.01, True), (9.0, False)])
def test_a_key_frame_tuck_is_a_pose_of_the_robots_where_its_limits_allow(written, at, known):
    end = f'<keyframe><key name="home" qpos="0"/><key name="tuck" qpos="{at}"/></keyframe>'
    tuck = load_model_file(written(arm('range="-1 1" limited="true"', end=end))).tuck
    assert (tuck == pytest.approx([at])) if known else (tuck is None)
    assert load_model_file(written(arm())).tuck is None
