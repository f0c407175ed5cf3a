"""How long the hand rests, and how often it turns round."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm_research.metrics.stick import idle_time, turned_round_share

TIME_S = 0.1 * np.arange(41)


def held(*pushes):
    """(41, d): each push for as many of the 0.1 s."""
    u = [np.asarray(push, dtype=float) for push, ticks in pushes for _ in range(ticks)]
    return np.array([*u, u[-1]])[: len(TIME_S)]


def test_only_an_input_of_zero_is_idle():
    u = held(((0.0, 0.0), 10), ((0.01, 0.0), 10), ((0.0, 0.0), 5), ((1.0, 0.0), 15))
    assert idle_time(TIME_S, u) == pytest.approx(1.5)


def test_the_last_input_has_no_length():
    u = held(((1.0, 0.0), 40))
    u[-1] = 0.0
    assert idle_time(TIME_S, u) == 0.0


def test_who_turns_round_undoes_for_half_a_second():
    u = held(((1.0, 0.0), 20), ((-1.0, 0.2), 20))
    assert turned_round_share(TIME_S, u) == pytest.approx(0.5 / 4.0)


def test_a_pause_of_half_a_second_forgets_the_direction():
    short = held(((1.0, 0.0), 20), ((0.0, 0.0), 3), ((-1.0, 0.0), 17))
    long = held(((1.0, 0.0), 20), ((0.0, 0.0), 5), ((-1.0, 0.0), 15))
    assert turned_round_share(TIME_S, short) == pytest.approx(0.2 / 4.0)
    assert turned_round_share(TIME_S, long) == 0.0


@pytest.mark.parametrize("to", [(0.0, 1.0), (1.0, 0.5), (0.1, 0.0)])
def test_a_right_angle_or_less_is_not_turning_round(to):
    assert turned_round_share(TIME_S, held(((1.0, 0.0), 20), (to, 20))) == 0.0


def test_to_and_fro_is_undone_all_the_time_once_it_has_begun():
    u = held(*[((sign,), 2) for _ in range(10) for sign in (1.0, -1.0)])
    assert turned_round_share(TIME_S, u) == pytest.approx(3.8 / 4.0)


@given(st.integers(0, 1000), st.integers(1, 3), st.floats(0.01, 10.0))
def test_neither_depends_on_how_hard_the_stick_is_pushed(seed, axes, scale):
    rng = np.random.default_rng(seed)
    u = rng.normal(size=(41, axes)) * (rng.uniform(size=(41, 1)) < 0.8)
    assert turned_round_share(TIME_S, u) == turned_round_share(TIME_S, scale * u)
    assert idle_time(TIME_S, u) == idle_time(TIME_S, scale * u)
    assert 0.0 <= turned_round_share(TIME_S, u) <= 1.0
    assert 0.0 <= idle_time(TIME_S, u) <= 4.0
