"""Addresses of real arms."""

import pytest

from latentarm.arms.address import ArmAddress, is_address, parse_address
from latentarm.arms.catalogue import make_real_arm
from latentarm.core.errors import UserError


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("franka://172.16.0.2", ArmAddress("franka", "172.16.0.2", None, {})),
        ("ros2://robot.local:9090", ArmAddress("ros2", "robot.local", 9090, {})),
        ("xarm://[::1]:502?tool=1.5", ArmAddress("xarm", "::1", 502, {"tool": "1.5"})),
        ("my_arm://10.0.0.2", ArmAddress("my_arm", "10.0.0.2", None, {})),
        ("lerobot:///dev/ttyACM0", ArmAddress("lerobot", "/dev/ttyACM0", None, {})),
    ],
)
def test_an_address_says_where_an_arm_is(text, address):
    assert is_address(text)
    assert parse_address(text) == address


def test_the_name_of_a_simulated_arm_is_no_address():
    assert not is_address("mujoco")


@pytest.mark.parametrize(
    "text",
    ["franka://", "://1.2.3.4", "franka://host:port", "franka://a@b", "xarm://h?a=1&a=2", "xarm://h?a"],
)
def test_what_is_no_address_is_refused_in_a_sentence(text):
    with pytest.raises(UserError, match=r"^--arm .*\.$"):
        parse_address(text)


def test_an_unknown_option_is_refused_with_those_that_there_are():
    with pytest.raises(UserError, match=r"option speed: it takes payload, hand\.$"):
        parse_address("franka://host?speed=1").only("payload", "hand")


def test_an_unknown_scheme_is_refused(the_panda):
    with pytest.raises(UserError, match="--arm brass://host names the driver 'brass'"):
        make_real_arm("brass://host", the_panda, lambda: 0.0)
