"""What can be true of things, looked up in states made by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.robots.scene.scene import TABLE, TOOL
from latentarm.robots.scene.thing import Interior
from latentarm.tasks import predicates as p
from latentarm.tasks.mishap import Mishap
from scene_states import at, standing

BOWL = Interior(radius_m=0.05, bottom_m=0.0, top_m=0.04)
ON_ITS_SIDE = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def leaning(angle_deg):
    angle = np.deg2rad(angle_deg)
    return np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])


def held(*names, by="gripped", **poses):
    return standing(poses=poses, **{by: frozenset(names)})


CUP_UP = {"cup": at(z=0.2)}
ABOVE = p.Above("cup", aside_m=0.02, lowest_m=0.05, highest_m=0.2)
OVER = p.CarriedOver("cup", "bowl", aside_m=0.03)
PLACED = p.Placed("cup", np.array([0.5, 0.0, 0.1]), np.array([0.05, 0.02, 0.01]), let_go=True)
LAID = p.Placed("cup", np.array([0.5, 0.0, 0.1]), np.array([0.05, 0.02, 0.01]), let_go=False)
WITHIN = p.Within("cup", "bowl", BOWL)


@pytest.mark.parametrize(
    ("predicate", "state", "holds"),
    [
        (ABOVE, standing(tool=at(x=0.012, y=0.012, z=0.1)), True),
        (ABOVE, standing(tool=at(x=0.016, y=0.016, z=0.1)), False),
        (ABOVE, standing(tool=at(z=0.04)), False),
        (ABOVE, standing(tool=at(z=0.21)), False),
        (p.Lifted("cup", 0.1), held("cup", by="stabbed", **CUP_UP), True),
        (p.Lifted("cup", 0.1), held("cup", by="stabbed", cup=at(z=0.09)), False),
        (p.Lifted("cup", 0.1), held("cup", **CUP_UP), True),
        (p.Lifted("cup", 0.1), held(**CUP_UP), False),
        (p.Lifted("cup", 0.1), held("cup", cup=at(z=0.09)), False),
        (OVER, held("cup", cup=at(x=1.02, z=0.3), bowl=at(x=1.0)), True),
        (OVER, held("cup", by="stabbed", cup=at(x=1.02, z=0.3), bowl=at(x=1.0)), True),
        (OVER, held("cup", cup=at(x=1.04, z=0.3), bowl=at(x=1.0)), False),
        (OVER, held(cup=at(x=1.0, z=0.3), bowl=at(x=1.0)), False),
        (p.Apart("tofu", "slice"), standing(bonds=frozenset({("tofu", "slice")})), False),
        (p.Apart("tofu", "slice"), standing(bonds=frozenset({("tofu", "skin")})), True),
        (WITHIN, held(cup=at(x=0.04, z=0.02), bowl=at()), True),
        (WITHIN, held(cup=at(x=0.06, z=0.02), bowl=at()), False),
        (WITHIN, held(cup=at(z=0.05), bowl=at()), False),
        (WITHIN, held(cup=at(y=-0.02, z=0.04), bowl=at(rotation=ON_ITS_SIDE)), True),
        (PLACED, held(cup=at(0.54, 0.01, 0.105)), True),
        (PLACED, held(cup=at(0.54, 0.03, 0.105)), False),
        (PLACED, held("cup", cup=at(0.5, 0.0, 0.1)), False),
        (LAID, held("cup", by="stabbed", cup=at(0.5, 0.0, 0.1)), True),
        (LAID, standing(poses={"cup": at(0.5, 0.0, 0.1)}, speed_m_s={"cup": 0.1}), False),
    ],
)
def test_steps_know_what_they_wait_for(predicate, state, holds):
    assert predicate(state) == holds


@pytest.mark.parametrize(
    ("failure", "state", "said"),
    [
        (p.Dropped("cup", 0.0), standing(poses={"cup": at(z=-0.01)}), "dropped the cup"),
        (p.Dropped("cup", 0.0), standing(poses={"cup": at(z=0.01)}), None),
        (p.KnockedOver("cup"), held(cup=at(rotation=leaning(70))), "knocked over the cup"),
        (p.KnockedOver("cup"), held(cup=at(rotation=leaning(50))), None),
        (p.KnockedOver("cup"), held("cup", cup=at(rotation=leaning(70))), None),
        (p.Pressed("bowl", 9.0), standing(force_n={("bowl", TOOL): 10.0}), "pressed too hard on the bowl"),
        (p.Pressed(TABLE, 9.0), standing(force_n={(TABLE, TOOL): 10.0}), "pressed too hard on the table"),
        (p.Pressed("vase", 9.0), standing(force_n={(TOOL, "vase"): 10.0}), "pressed too hard on the vase"),
        (p.Pressed("vase", 9.0), standing(force_n={(TOOL, "vase"): 8.0, ("cup", "vase"): 99.0}), None),
    ],
)
def test_failures_say_what_went_wrong(failure, state, said):
    found = failure(state)
    assert (None if found is None else found.text) == said


def rice(*places):
    return standing(poses={"bowl": at(x=1.0)}, grains={"rice": np.array(places, dtype=float)})


def test_grains_are_poured_where_enough_of_them_are_inside():
    state = rice((1.0, 0.0, 0.01), (1.04, 0.0, 0.03), (1.0, 0.0, 0.05), (0.0, 0.0, 0.01))
    assert p.Poured("rice", "bowl", BOWL, share=0.5)(state)
    assert not p.Poured("rice", "bowl", BOWL, share=0.6)(state)


def test_grains_in_the_air_or_in_a_bowl_are_not_spilled():
    spilled = p.Spilled("rice", below_m=0.1, containers=(("bowl", BOWL),), share=0.5)
    two = rice((1.0, 0.0, 0.01), (0.0, 0.0, 0.2), (0.0, 0.0, 0.01), (0.0, 0.0, -1.0))
    three = rice((1.0, 0.0, 0.01), (0.0, 0.0, 0.09), (0.0, 0.0, 0.01), (0.0, 0.0, -1.0))
    assert (spilled.count(two), spilled(two)) == (2, None)
    assert (spilled.count(three), spilled(three)) == (3, Mishap("spilled", "rice"))


def test_only_the_way_through_the_icing_counts():
    swept = p.Swept("cup", "bowl", BOWL, length_m=0.05)

    def at_x(x, z=0.02):
        return swept(held(cup=at(x=x, z=z), bowl=at()))

    assert not at_x(-0.03)
    assert not at_x(0.01)  # 40 mm inside
    assert not at_x(0.01, z=0.5)  # straight up
    assert not at_x(-0.04)  # back in elsewhere: the way through the air does not count
    assert at_x(-0.03)  # 10 mm more


@given(st.integers(0, 1000), st.booleans())
def test_stirring_counts_whole_turns_in_either_direction(seed, clockwise):
    rng = np.random.default_rng(seed)
    stirred = p.Stirred("spoon", "cup", BOWL, turns=1.5)
    steps = rng.uniform(0.05, 1.0, 60)
    turned, start = 0.0, rng.uniform(0, 2 * np.pi)
    for step in (0.0, *steps):
        turned += step
        angle = start + (-turned if clockwise else turned)
        place = at(x=0.03 * np.cos(angle), y=0.03 * np.sin(angle), z=0.02)
        assert stirred(standing(poses={"spoon": place})) == (turned >= 3 * np.pi)


def test_going_round_above_the_bowl_is_not_stirring():
    stirred = p.Stirred("spoon", "cup", BOWL, turns=1.0)
    for angle in np.linspace(0.0, 6 * np.pi, 60):
        over = at(x=0.03 * np.cos(angle), y=0.03 * np.sin(angle), z=0.1)
        assert not stirred(standing(poses={"spoon": over}))
