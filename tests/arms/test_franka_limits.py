import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from latentarm.arms.address import parse_address
from latentarm.arms.franka.limits import FR3, PANDA, SHARE, limits_of
from latentarm.arms.franka.options import FrankaOptions, read_options
from latentarm.arms.franka.pace import Pace
from latentarm.arms.franka.words import _ERRORS, fault
from latentarm.arms.own_limits import beyond
from latentarm.core.errors import UserError
from latentarm.robots.panda import fr3, panda

shares = arrays(np.float64, 7, elements=st.floats(0.0, 1.0))
velocities = arrays(np.float64, 7, elements=st.floats(-6.0, 6.0))


@given(shares, velocities, st.sampled_from([FR3, PANDA]))
def test_what_is_sent_keeps_to_the_limits_and_to_the_direction(share, velocity, limits):
    q = limits.lower + share * (limits.upper - limits.lower)
    sent = limits.slowed(velocity, q)
    least, most = limits.speeds(q)
    assert (sent <= SHARE * most + 1e-12).all()
    assert (sent >= SHARE * least - 1e-12).all()
    assert not limits.exceeds(sent, q)
    speed = np.linalg.norm(velocity)
    if speed > 1e-6:
        factor = sent @ velocity / speed**2
        assert -1e-12 <= factor <= 1.0 + 1e-12
        np.testing.assert_allclose(sent, factor * velocity, atol=1e-9)


@given(shares)
def test_a_slow_motion_in_the_middle_is_left_as_it_is(share):
    limits = fr3().limits
    q = limits.lower + 0.3 + share * (limits.upper - limits.lower - 0.6)
    velocity = 0.5 * np.sign(np.sin(1e3 * share))
    np.testing.assert_array_equal(FR3.slowed(velocity, q), velocity)


@pytest.mark.parametrize("limits", [FR3, PANDA])
def test_no_speed_is_left_towards_an_end(limits):
    for end, inward in ((limits.upper, -1.0), (limits.lower, 1.0)):
        assert not limits.slowed(-inward * np.ones(7), end).any()
        assert not limits.exceeds(np.zeros(7), end)


def test_each_robot_fits_its_arm_and_a_panda_does_not_fit_an_fr3():
    assert beyond(FR3.found, fr3()) == ()
    assert beyond(PANDA.found, panda()) == ()
    assert (
        "The lower limit of joint1 is -166.0° for panda and -157.6° for the arm"
        in beyond(FR3.found, panda())[0]
    )
    assert any("velocity limit" in sentence for sentence in beyond(PANDA.found, fr3()))


@pytest.mark.parametrize(
    ("urdf", "limits"),
    [
        ('<robot name="fr3">', FR3),
        ("<?xml version='1.0'?><robot xmlns:x='y' name='fr3v2'>", FR3),
        ('<robot name="panda">', PANDA),
        ("", PANDA),
        ('<robot name="ur5e">', None),
        ("nonsense", None),
    ],
)
def test_the_arm_says_which_it_is(urdf, limits):
    assert limits_of(urdf) is limits


def test_an_address_sets_thresholds_payload_and_attachment():
    assert read_options(parse_address("franka://172.16.0.2")) == FrankaOptions()
    options = read_options(
        parse_address(
            "franka://fr3.local?collision_torque_nm=10&collision_force_n=10,11,12&payload_kg=0.2"
            "&payload_centre_m=0,0,0.1&attachment_tip_m=0,0,0.15&realtime=ignore"
        )
    )
    assert options.collision_torque_nm == (10.0,) * 7
    assert options.collision_force_n == (10.0, 11.0, 12.0)
    assert options.payload_kg == 0.2
    assert options.attachment_tip_m == (0.0, 0.0, 0.15)
    assert options.realtime == "ignore"


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("payload=1", "does not know the option payload"),
        ("payload_kg=4", "payload_kg is a number, from 0 to 3"),
        ("payload_kg=nan", "payload_kg"),
        ("payload_centre_m=0,0,0.1", "give the payload's mass too"),
        ("payload_kg=1&payload_centre_m=0.1", "3 numbers with commas between"),
        ("collision_torque_nm=0", "collision_torque_nm is a number, or 7 numbers"),
        ("collision_force_n=1,2", "3 numbers"),
        ("realtime=maybe", "enforce or ignore"),
    ],
)
def test_an_option_that_cannot_be_is_one_sentence(query, said):
    with pytest.raises(UserError, match=said) as error:
        read_options(parse_address(f"franka://172.16.0.2?{query}"))
    assert str(error.value).endswith(".")


def test_a_port_is_refused():
    with pytest.raises(UserError, match="takes no port"):
        read_options(parse_address("franka://172.16.0.2:1337"))


def test_an_error_of_the_arm_becomes_a_sentence():
    assert fault(["joint_reflex"], "x", "y") == "It felt a collision: see what it touches."
    assert fault(["instability_detected"], "x", "y") == "Instability detected."
    assert fault([], "Move command rejected", "y") == "Move command rejected."
    for name in _ERRORS:
        assert ": " in fault([name], "x", "y"), name
    late = fault(["communication_constraints_violation"], "x", "use a cable")
    assert late == "Too many of its messages came late or not at all: use a cable."


def test_clocks_are_compared_over_spans_in_which_this_computer_was_not_late():
    for rate, said in ((1.0, ""), (0.179, "passes 0.179 s"), (3.0, "passes 3.000 s")):
        pace = Pace()
        told = [pace.strange(now_s, rate * now_s) for now_s in np.arange(0.0, 4.5, 0.004)]
        assert sum(said in one for one in told if one) == (2 if said else 0)
        late = [pace.strange(now_s, rate * now_s) for now_s in np.arange(10.0, 20.0, 0.2)]
        assert not any(late)
