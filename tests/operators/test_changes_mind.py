import numpy as np
import pytest

from latentarm.errors import UserError
from latentarm.operators.boltzmann import BoltzmannConfig, BoltzmannOperator
from latentarm.operators.changes_mind import ChangesMind
from latentarm.types import Context

PERFECT = BoltzmannConfig(beta=np.inf, decision_s=0.05)


@pytest.fixture
def here(planar):
    return Context(planar.home + np.linspace(0.2, 0.6, planar.dof), np.zeros(0))


def pose_after(planar, here, *moves):
    return planar.chain.forward(here.state + np.pad(np.array(moves), (0, planar.dof - len(moves))))


def inputs(person, here, controller, target, calls):
    rng = np.random.default_rng(0)
    return np.array([person.act(here, controller, 0, target, rng).u for _ in range(calls)])


@pytest.mark.parametrize("after_s", [0.0, 0.05, 0.5])
def test_wants_the_first_target_for_so_long_and_the_true_one_after(planar, one_mode, here, after_s):
    first, target = pose_after(planar, here, 0.25), pose_after(planar, here, -0.25)
    inner = BoltzmannOperator(planar, PERFECT)
    person = ChangesMind(inner, first, after_s)
    given = inputs(person, here, one_mode, target, 20)
    before = round(after_s / 0.05)
    to_first = inputs(inner, here, one_mode, first, 1)[0]
    to_target = inputs(inner, here, one_mode, target, 1)[0]
    assert not np.allclose(to_first, to_target)
    np.testing.assert_array_equal(given[:before], np.tile(to_first, (before, 1)))
    np.testing.assert_array_equal(given[before:], np.tile(to_target, (20 - before, 1)))


def test_a_new_drive_begins_with_the_first_target(planar, one_mode, here):
    first, target = pose_after(planar, here, 0.25), pose_after(planar, here, -0.25)
    person = ChangesMind(BoltzmannOperator(planar, PERFECT), first, 0.2)
    before = inputs(person, here, one_mode, target, 10)
    person.reset()
    np.testing.assert_array_equal(inputs(person, here, one_mode, target, 10), before)


@pytest.mark.parametrize(
    "wrong", [{"after_s": -1.0}, {"after_s": np.inf}, {"after_s": np.nan}, {"period_s": 0.0}]
)
def test_times_that_cannot_be(planar, here, wrong):
    inner = BoltzmannOperator(planar, PERFECT)
    with pytest.raises(UserError, match=r"seconds|time"):
        ChangesMind(inner, pose_after(planar, here, 0.1), **{"after_s": 1.0, **wrong})
