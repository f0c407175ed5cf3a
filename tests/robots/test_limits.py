import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.robots.limits import JointLimits, LimitSources

GOOD = {"lower": [-1.0, -2.0], "upper": [1.0, 2.0], "velocity": [1.0, 1.0]}
GOOD |= {"acceleration": [5.0, 5.0], "jerk": [50.0, 50.0]}


def limits(**changed) -> JointLimits:
    return JointLimits(**{name: np.array(value) for name, value in (GOOD | changed).items()})


@pytest.mark.parametrize("field", GOOD)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_limit_that_is_not_finite_is_refused(field, value):
    with pytest.raises(UserError, match=f"{field}.*joint 2"):
        limits(**{field: [GOOD[field][0], value]})


@pytest.mark.parametrize("field", ["velocity", "acceleration", "jerk"])
@given(value=st.floats(max_value=0.0, allow_infinity=False))
def test_a_speed_of_zero_or_less_is_refused(field, value):
    with pytest.raises(UserError, match=f"{field} of joint 1 is .*above zero"):
        limits(**{field: [value, 1.0]})


@pytest.mark.parametrize(("lower", "upper"), [(1.0, 1.0), (1.0, -1.0)])
def test_an_empty_range_is_refused(lower, upper):
    with pytest.raises(UserError, match="Joint 1 may move from"):
        limits(lower=[lower, -2.0], upper=[upper, 2.0])


@pytest.mark.parametrize("value", [[1.0], [[1.0, 1.0]], 1.0, [1.0, 1.0, 1.0]])
def test_a_limit_for_other_than_every_joint_is_refused(value):
    with pytest.raises(UserError, match="velocity has shape"):
        limits(velocity=value)


def test_text_is_no_limit():
    with pytest.raises(UserError, match="velocity must be numbers"):
        limits(velocity=["fast", "slow"])


def test_limits_cannot_be_changed_afterwards():
    given_lower = np.array(GOOD["lower"])
    checked = limits(lower=given_lower)
    given_lower[0] = np.nan
    assert checked.lower[0] == -1.0
    with pytest.raises(ValueError):
        checked.velocity[0] = 1e9


def test_violation_is_how_far_outside():
    q = np.array([[0.0, 0.0], [1.5, -2.25]])
    np.testing.assert_allclose(limits().violation(q), [[0, 0], [0.5, 0.25]])


def test_a_limit_of_which_nothing_is_said_is_assumed():
    assert limits().assumed == dict.fromkeys(("position", "velocity", "acceleration", "jerk"), (0, 1))
    known: LimitSources = {"position": ("model", "model"), "velocity": ("model", "assumed")}
    given = JointLimits(**{name: np.array(value) for name, value in GOOD.items()}, sources=known)
    assert given.assumed == {"velocity": (1,), "acceleration": (0, 1), "jerk": (0, 1)}


def test_sources_for_other_than_every_joint_are_refused():
    with pytest.raises(UserError, match="sources of the joint limits' jerk are 3"):
        JointLimits(**{n: np.array(v) for n, v in GOOD.items()}, sources={"jerk": ("model",) * 3})
