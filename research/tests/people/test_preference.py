"""What simulated people mean, by hand."""

import numpy as np
import pytest

from latentarm.alignment.answers import Motions
from latentarm.alignment.preference import ToolAxes
from latentarm.core.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.tasks.inverse_kinematics import solve
from latentarm_research.alignment.preferences import ByPlace, HeightAndTilt, Imprecise
from latentarm_research.tasks.pouring.task import HOME_RAD
from latentarm_research.tasks.pouring.tool_path import ToolPath

PANDA = load_robot("panda")
CHAIN = PANDA.chain


def state(x=0.5, y=0.0, z=0.3, tilt=0.0):
    path = ToolPath(np.array([[x, y, z]]), np.array([tilt]))
    return solve(PANDA, path.poses(0), np.array(HOME_RAD))


def motion(start, end, duration_s=0.5):
    return Motions(state(**start)[None], state(**end)[None], duration_s)


def test_who_means_x_and_y_pushes_as_far_as_the_tool_goes():
    plane = ToolAxes(CHAIN, 2, 0.2)
    asked = motion({"x": 0.5}, {"x": 0.55, "y": -0.025, "z": 0.35})
    np.testing.assert_allclose(plane.inputs(asked), [[0.5, -0.25]], atol=2e-3)


def test_who_means_height_and_tilt_pays_no_heed_to_the_rest():
    pour = HeightAndTilt(CHAIN, 0.2, 1.0)
    asked = motion({"tilt": 0.1}, {"z": 0.25, "tilt": 0.35, "y": 0.1})
    np.testing.assert_allclose(pour.inputs(asked), [[-0.5, 0.5]], atol=2e-3)


def test_nobody_pushes_beyond_the_end_of_the_stick():
    asked = motion({"z": 0.2}, {"z": 0.4, "tilt": -0.8})
    np.testing.assert_array_equal(HeightAndTilt(CHAIN, 0.1, 0.5).inputs(asked), [[1.0, -1.0]])


def test_what_is_meant_depends_on_where_a_motion_begins():
    plane, pour = ToolAxes(CHAIN, 2, 0.2), HeightAndTilt(CHAIN, 0.2, 1.0)
    person = ByPlace(CHAIN, lambda place: place[:, 1] > 0.1, there=pour, elsewhere=plane)
    here, there = ({"y": y} for y in (0.0, 0.2))
    starts = np.stack([state(**here), state(**there)])
    ends = np.stack([state(y=0.05, z=0.35), state(y=0.25, z=0.35)])
    np.testing.assert_allclose(person.inputs(Motions(starts, ends, 0.5)), [[0, 0.5], [0.5, 0]], atol=2e-3)


def test_imprecise_answers_spread_about_what_is_meant_by_their_share():
    plane = ToolAxes(CHAIN, 2, 0.4)
    one = motion({"x": 0.5}, {"x": 0.55, "y": -0.025})
    many = one[np.zeros(4000, dtype=int)]
    meant = plane.inputs(one)[0]
    said = Imprecise(plane, 0.1, np.random.default_rng(0)).inputs(many)
    np.testing.assert_allclose(said.mean(axis=0), meant, rtol=0.01)
    np.testing.assert_allclose(said.std(axis=0), 0.1 * np.abs(meant), rtol=0.05)
    exact = Imprecise(plane, 0.0, np.random.default_rng(0))
    np.testing.assert_array_equal(exact.inputs(one), plane.inputs(one))
    wild = Imprecise(plane, 20.0, np.random.default_rng(0)).inputs(many)
    assert np.abs(wild).max() == 1.0


def test_an_answer_is_drawn_anew_each_time_and_the_same_from_the_same_seed():
    plane, one = ToolAxes(CHAIN, 2, 0.2), motion({"x": 0.5}, {"x": 0.55, "y": 0.03})
    person = Imprecise(plane, 0.5, np.random.default_rng(1))
    first, second = person.inputs(one), person.inputs(one)
    assert not np.array_equal(first, second)
    np.testing.assert_array_equal(first, Imprecise(plane, 0.5, np.random.default_rng(1)).inputs(one))


def test_a_speed_that_is_none_is_refused():
    with pytest.raises(UserError, match="speed must be positive"):
        ToolAxes(CHAIN, 2, -1.0)
