"""Which end-effector is chosen, and what is left to the person."""

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.robots.end_effector import AmbiguousEndEffectorError
from latentarm.robots.model_file import load_model_file
from latentarm.robots.notices import notices


def serial(*joints: str, site_on: int | None = None, last: str = "", extra: str = "") -> str:
    """An arm of hinges one after the other; bodies are called link0, link1, ..."""
    text = last
    for index in reversed(range(len(joints))):
        site = '<site name="mark"/>' if site_on == index else ""
        text = (
            f'<body name="link{index}" pos="0.1 0 0.2"><joint name="{joints[index]}" axis="{index % 2} 1 0"/>'
            f'<geom size="0.05"/>{site}{text}</body>'
        )
    return f"<mujoco><worldbody>{text}</worldbody>{extra}</mujoco>"


def test_a_site_that_leaves_joints_unused_is_not_chosen(written):
    """As in a model of Spot's arm, where the only site marks the shoulder."""
    path = written(serial("a", "b", "c", "d", "e", "f", site_on=0))
    with pytest.raises(
        AmbiguousEndEffectorError,
        match=r"only 1 of 6 joints move 'mark', .*-effector, one of link5 \(6 joints\), mark \(1 joint\)\.",
    ):
        load_model_file(path)
    assert load_model_file(path, "link5").dof == 6


def test_an_explicit_end_effector_is_used_and_idle_joints_are_named(written):
    robot = load_model_file(written(serial("a", "b", "c", site_on=0)), "mark")
    assert (robot.joint_names, robot.still_joints) == (("a",), ("b", "c"))
    assert "1 of 3 joints move mark; these stay still: b, c." in notices(robot)


@pytest.mark.parametrize("finger", ["gripper", "left_finger_joint", "jaw", "Knuckle1"])
def test_a_jaw_is_no_end_effector_and_its_joint_none_of_the_arms(written, finger):
    path = written(serial("pan", "lift", "elbow", finger))
    with pytest.raises(
        AmbiguousEndEffectorError,
        match=rf"moved by '{finger}', which looks.*of link2 \(3 joints\), link3 \(3 joints and a finger\)",
    ):
        load_model_file(path)
    assert load_model_file(path, "link2").joint_names == ("pan", "lift", "elbow")
    with_jaw = load_model_file(path, "link3")
    assert with_jaw.driven_fingers == (finger,)
    assert any(finger in sentence for sentence in notices(with_jaw))


def test_fingers_beyond_the_tool_do_not_count_as_unused(written):
    robot = load_model_file(written(serial("pan", "lift", "gripper", site_on=1)))
    assert (robot.chain.tools[0].name, robot.still_joints) == ("mark", ())


def test_of_two_arms_one_is_named(written):
    arms = "".join(
        f"""<body name="{side}_upper"><joint name="{side}_1" axis="0 0 1"/><geom size="0.1"/>
        <body name="{side}_hand" pos="0.3 0 0"><joint name="{side}_2" axis="0 1 0"/><geom size="0.1"/></body>
        </body>"""
        for side in ("left", "right")
    )
    path = written(f"<mujoco><worldbody>{arms}</worldbody></mujoco>")
    with pytest.raises(AmbiguousEndEffectorError, match=r"left_hand \(2 joints\), right_hand \(2 joints\)"):
        load_model_file(path)
    assert load_model_file(path, "left_hand").still_joints == ("right_1", "right_2")


def test_a_joint_that_follows_another_moves_with_it_and_within_the_limits_of_both(written):
    """URDF's <mimic>, and MJCF's <equality><joint>."""
    link = """<link name="{}"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
    joint = """<joint name="{0}" type="{4}"><parent link="{1}"/><child link="{2}"/><origin xyz="0 0 0.3"/>
    <axis xyz="0 1 0"/><limit velocity="2" effort="1" {5}/>{3}</joint>"""
    text = "".join(link.format(name) for name in ("base", "upper", "lower")) + joint.format(
        "shoulder", "base", "upper", "", "continuous", ""
    )
    mimic = '<mimic joint="shoulder" multiplier="2"/>'
    follows = joint.format("elbow", "upper", "lower", mimic, "revolute", 'lower="-1" upper="1"')
    path = written(f'<robot name="r">{text}{follows}</robot>', "robot.urdf")
    both = load_model_file(path)
    assert (both.joint_names, both.chain.tools[0].name) == (("shoulder",), "lower")
    np.testing.assert_allclose([*both.limits.lower, *both.limits.upper], [-0.5, 0.5])
    assert both.limits.velocity == [1.0]
    assert both.limits.sources["position"] == ("model",)
    robot = load_model_file(path, "upper")
    assert robot.joint_names == ("shoulder",)
    # It turns for ever: that it stays within two turns is this program's choice, and said so.
    assert robot.limits.assumed["position"] == (0,)
    assert "velocity" not in robot.limits.assumed


@pytest.mark.parametrize(
    ("rules", "said"),
    [
        ({"b": 'joint2="a" polycoef="0 1 0.5 0 0"'}, "Joint 'b' follows joint 'a' in no fixed ratio"),
        ({"b": 'joint2="a" polycoef="0 0 0 0 0"'}, "Joint 'b' follows joint 'a' in no fixed ratio"),
        ({"b": ""}, "Joint 'b' follows no joint"),
        ({"a": 'joint2="b"', "b": 'joint2="a"'}, "in no fixed ratio"),
        ({"c": 'joint2="a"', "a": 'joint2="b"', "b": 'joint2="a"'}, "in no fixed ratio"),
    ],
)
def test_a_joint_that_follows_in_no_fixed_ratio_is_refused(written, rules, said):
    equalities = "".join(f'<joint joint1="{joint}" {rule}/>' for joint, rule in rules.items())
    path = written(serial("a", "b", "c", extra=f"<equality>{equalities}</equality>"))
    with pytest.raises(UserError, match=said):
        load_model_file(path, "link2")


def test_a_closed_chain_is_refused_unless_it_is_off_the_arm(written):
    closed = '<equality><connect body1="{}" body2="{}" anchor="0 0 0"/></equality>'
    path = written(serial("a", "b", "c", extra=closed.format("link2", "link0")))
    with pytest.raises(UserError, match="Joint 'b' is part of a closed chain"):
        load_model_file(path)
    # A gripper's linkage moves no joint of the arm.
    fingers = """<body name="l"><joint name="finger_l" axis="1 0 0"/><geom size="0.01"/></body>
    <body name="r"><joint name="finger_r" axis="1 0 0"/><geom size="0.01"/></body><site name="tip"/>"""
    gripper = written(serial("a", "b", last=fingers, extra=closed.format("l", "r")), "gripper.xml")
    assert load_model_file(gripper).joint_names == ("a", "b")
    # Nor does the handle by which simulations drag an arm.
    handle = written(
        serial("a", "b")
        .replace("<worldbody>", '<worldbody><body name="handle" mocap="true"/>')
        .replace("</mujoco>", '<equality><weld body1="handle" body2="link1"/></equality></mujoco>'),
        "handle.xml",
    )
    assert load_model_file(handle, "link1").joint_names == ("a", "b")


def test_a_floating_base_is_refused(written):
    path = written(serial("a", "b").replace('<joint name="a" axis="0 1 0"/>', "<freejoint name='base'/>"))
    with pytest.raises(UserError, match="'base' is a free joint"):
        load_model_file(path, "link1")
