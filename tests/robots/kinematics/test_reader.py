import mujoco
import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.robots.kinematics.reader import read


def model(body: str, extra: str = "") -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{body}</worldbody>{extra}</mujoco>")


ARM = """
<body name="link"><joint name="hinge" axis="0 0 1"/><geom size="0.1"/>
  <body name="grip" pos="1 0 0"><joint name="finger" axis="0 0 1"/><geom size="0.1"/>
    <site name="nail" pos="0.5 0 0"/>
  </body>
  <body name="palm" pos="0 1 0"/>
  <site name="tip" pos="0 2 0"/>
</body>
"""


def test_joints_off_the_way_are_frozen_at_the_home_key_frame():
    posed = model(ARM, '<keyframe><key name="home" qpos="0.3 1.5707963267948966"/></keyframe>')
    chain = read(posed, ["tip"]).chain
    assert chain.joint_names == ("hinge",)
    both = read(posed, ["nail", "tip"]).chain
    assert both.joint_names == ("hinge", "finger")
    assert [tool.name for tool in both.tools] == ["nail", "tip"]
    np.testing.assert_allclose(both.forward(np.array([0.0, 0.0])).position, [1.5, 0, 0], atol=1e-12)
    np.testing.assert_allclose(both.forward(np.array([0.0, 0.0]), tool=1).position, [0, 2, 0], atol=1e-12)


def test_an_end_effector_may_be_a_body():
    chain = read(model(ARM), ["palm"]).chain
    np.testing.assert_allclose(chain.forward(np.array([np.pi / 2])).position, [-1, 0, 0], atol=1e-12)


def test_an_unknown_end_effector_is_named_with_what_there_is():
    with pytest.raises(UserError, match=r"no site or body named 'thumb'.*tip.*palm"):
        read(model(ARM), ["thumb"])


def test_an_end_effector_that_nothing_moves_is_refused():
    with pytest.raises(UserError, match="No joint moves 'table'"):
        read(model(ARM + '<body name="table"><geom size="0.1"/></body>'), ["table"])


@pytest.mark.parametrize("kind", ["ball", "free"])
def test_a_joint_that_cannot_be_driven_is_refused(kind):
    body = f"""<body name="link"><joint name="loose" type="{kind}"/><geom size="0.1"/>
      <body name="hand"><joint type="hinge"/><geom size="0.1"/></body></body>"""
    with pytest.raises(UserError, match=f"Joint 'loose' is a {kind} joint"):
        read(model(body), ["hand"])


def test_a_loose_object_beside_the_arm_does_no_harm():
    box = '<body name="box" pos="3 0 0"><freejoint/><geom size="0.1"/></body>'
    chain = read(model(box + ARM), ["tip"]).chain
    np.testing.assert_allclose(chain.forward(np.array([0.0])).position, [0, 2, 0], atol=1e-12)
