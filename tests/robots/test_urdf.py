import shutil

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.robots.model_file import load_model_file

URDF = """
<robot name="short">
  <link name="base"><visual><geometry><mesh filename="package://arm/looks.dae"/></geometry></visual></link>
  <link name="upper">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry>{shape}</geometry></collision></link>
  <link name="hand"/>
  <joint name="shoulder" type="{kind}">
    <parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>{limit}
  </joint>
  <joint name="wrist" type="fixed"><parent link="upper"/><child link="hand"/><origin xyz="0.5 0 0"/></joint>
</robot>
"""
BOX = '<box size="0.1 0.1 0.1"/>'
LIMIT = '<limit lower="-1" upper="2" effort="10" velocity="0.7"/>'


def urdf(shape=BOX, kind="revolute", limit=LIMIT):
    return URDF.format(shape=shape, kind=kind, limit=limit)


def mesh(name):
    return f'<mesh filename="{name}"/>'


def test_a_link_that_is_only_fixed_can_be_the_end_effector(written):
    robot = load_model_file(written(urdf(), "arm.urdf"))
    assert robot.chain.tools[0].name == "hand"
    np.testing.assert_allclose(robot.chain.forward(np.array([np.pi / 2])).position, [0, 0.5, 0], atol=1e-9)
    np.testing.assert_allclose([robot.limits.lower[0], robot.limits.upper[0]], [-1, 2])
    assert robot.limits.velocity[0] == 0.7


@pytest.mark.parametrize("limit", ['<limit effort="1" velocity="0"/>', ""])
def test_a_joint_without_limits_gets_the_assumed_ones(written, limit):
    limits = load_model_file(written(urdf(kind="continuous", limit=limit))).limits
    assert limits.velocity[0] == 1.0
    np.testing.assert_allclose(limits.upper, 2 * np.pi)


def test_a_prismatic_joint_slides(written):
    robot = load_model_file(written(urdf(kind="prismatic")))
    np.testing.assert_allclose(robot.chain.forward(np.array([0.3])).position, [0.5, 0, 0.3], atol=1e-9)


@pytest.mark.parametrize(
    "name", ["package://arm_description/meshes/box.obj", "meshes/box.obj", "file://{}/meshes/box.obj"]
)
def test_collision_meshes_are_found(tmp_path, name, ur5e_file):
    package = tmp_path / "arm_description"
    (package / "meshes").mkdir(parents=True)
    (package / "urdf").mkdir()
    shutil.copy(ur5e_file.parent / "collision" / "wrist3.obj", package / "meshes" / "box.obj")
    folder = package if name.startswith("meshes") else package / "urdf"
    path = folder / "arm.urdf"
    path.write_text(urdf(mesh(name.format(package))))
    robot = load_model_file(path)
    assert robot.capsules.name == ("upper",)
    assert 0.03 < robot.capsules.radius[0] < 0.06


def test_a_prefix_that_is_not_declared_is_let_pass(written):
    convex = BOX + "</geometry></collision><drake:convex/><collision><geometry>" + BOX
    assert load_model_file(written(urdf(convex))).dof == 1


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (urdf(mesh("gone.stl")), r"the collision mesh 'gone\.stl' of link upper does not exist"),
        (urdf(mesh("package://nobody/gone.stl")), "of link upper does not exist"),
        (
            urdf(mesh("robot.dae")),
            r"in a format that cannot be read: convert it to one of \.stl, \.obj, \.msh",
        ),
        (
            urdf(limit='<limit lower="-1" upper="1" velocity="fast" effort="1"/>'),
            "shoulder is 'fast', not a number",
        ),
        (urdf(limit='<limit lower="-1" upper="1" velocity="-2" effort="1"/>'), "velocity of joint 1 is -2"),
        (urdf(limit='<limit lower="-1" upper="1" velocity="nan" effort="1"/>'), "velocity of joint 1 is nan"),
        (urdf(kind="floating", limit=""), "free joint"),
        (urdf(BOX + "</geometry><xacro:macro/><geometry>" + BOX), "is a xacro file: expand it first"),
        ("<robot name='empty'/>", "no hinge or slide joint"),
        (urdf(BOX + "</geometry><geometry>" + BOX), "cannot be used as a robot: .*repeated element"),
    ],
)
def test_what_cannot_be_used_is_said_in_one_sentence(written, text, sentence):
    path = written(text, "robot.urdf")
    (path.parent / "robot.dae").write_text("<COLLADA/>")
    with pytest.raises(UserError, match=sentence) as raised:
        load_model_file(path)
    assert str(path) in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_joint_name_that_occurs_twice_is_said(written):
    twice = urdf().replace('name="wrist" type="fixed"', 'name="shoulder" type="fixed"')
    with pytest.raises(UserError, match="has two joints named 'shoulder': give each a name of its own"):
        load_model_file(written(twice, "arm.urdf"))
    joint = '<joint name="j" axis="0 0 1"/><geom size=".1"/>'
    mjcf = (
        f"<mujoco><worldbody><body>{joint}<body pos='0 0 1'>{joint}<site/></body></body></worldbody></mujoco>"
    )
    with pytest.raises(UserError, match="repeated name 'j' in joint"):
        load_model_file(written(mjcf, "arm.xml"))


TETRAHEDRON = "v 0 0 0\nv {0} 0 0\nv 0 {0} 0\nv 0 0 {0}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


@pytest.mark.parametrize("link_m", [0.02, 0.4])
def test_a_mesh_in_mm_is_said_and_its_scale_advised(written, tmp_path, link_m):
    (tmp_path / "link.obj").write_text(TETRAHEDRON.format(1000 * link_m))
    path = written(urdf(mesh("link.obj")), "arm.urdf")
    with pytest.raises(
        UserError, match=r'mesh link of link upper is [\d.]+ m long.*scale="0.001 0.001 0.001"'
    ):
        load_model_file(path)
    scaled = urdf('<mesh filename="link.obj" scale="0.001 0.001 0.001"/>')
    robot = load_model_file(written(scaled, "arm.urdf"))
    assert robot.capsules.radius.max() < link_m
