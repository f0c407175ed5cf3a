"""What a simulated person sees comes late, and their hand trembles within its band."""

import numpy as np
import pytest

from latentarm.core.types import Context, Input, Pose
from latentarm_research.people.contract import Moment
from latentarm_research.people.motor_noise import UNSTEADY, Hand, HandConfig

NOWHERE = Pose(np.zeros(3), np.eye(3))
PERIOD_S = 0.01


def moment(number):
    return Moment(Context(np.array([float(number)]), np.zeros(0)), 0, NOWHERE, np.zeros(2))


def seen(hand, calls):
    return [float(hand.sees(moment(number)).context.state[0]) for number in range(calls)]


def given(hand, meant, calls, seed=0):
    rng = np.random.default_rng(seed)
    return np.stack([hand.gives(Input(np.array(meant)), rng).u for _ in range(calls)])


def test_what_is_seen_is_a_reaction_time_old():
    assert seen(Hand(HandConfig(reaction_s=0.03), PERIOD_S), 6) == [0, 0, 0, 0, 1, 2]
    assert seen(Hand(HandConfig(), PERIOD_S), 3) == [0, 1, 2]
    assert seen(Hand(UNSTEADY, PERIOD_S), 30)[-1] == 29 - 23


def test_a_new_drive_has_nothing_of_the_last():
    hand = Hand(HandConfig(reaction_s=0.02), PERIOD_S)
    assert seen(hand, 4) == [0, 0, 0, 1]
    hand.reset()
    assert seen(hand, 4) == [0, 0, 0, 1]


def test_a_tremor_has_its_size_and_stays_in_its_band():
    shaken = given(Hand(HandConfig(tremor=0.1), PERIOD_S), [0.3, -0.2], 20000) - [0.3, -0.2]
    assert shaken.std(axis=0) == pytest.approx(0.1, rel=0.05)
    assert np.abs(shaken.mean(axis=0)).max() < 0.002
    assert abs(np.corrcoef(shaken.T)[0, 1]) < 0.2
    power = np.square(np.abs(np.fft.rfft(shaken * np.hanning(len(shaken))[:, None], axis=0)))
    hz = np.fft.rfftfreq(len(shaken), PERIOD_S)
    assert power[(hz > 3.9) & (hz < 12.1)].sum() > 0.999 * power.sum()


def test_a_trembling_hand_stays_within_the_stick_and_a_hand_that_lets_go_is_still():
    hand = Hand(HandConfig(tremor=0.5), PERIOD_S)
    assert np.linalg.norm(given(hand, [0.8, 0.6], 500), axis=1).max() <= 1.0 + 1e-9
    assert not given(hand, [0.0, 0.0], 100).any()


def test_a_push_varies_in_proportion_and_is_held_as_long_as_it_is_meant():
    hand, rng = Hand(HandConfig(variation=0.2), PERIOD_S), np.random.default_rng(0)
    pushes = np.tile([[0.5, 0.0], [0.0, 0.25]], (1000, 1))
    given = np.stack([[hand.gives(Input(u), rng).u for _ in range(2)] for u in pushes])
    np.testing.assert_array_equal(given[:, 0], given[:, 1])
    wrong = given[:, 0] - pushes
    assert wrong[::2].std(axis=0) == pytest.approx(0.1, rel=0.1)
    assert wrong[1::2].std(axis=0) == pytest.approx(0.05, rel=0.1)
    assert not hand.gives(Input(np.zeros(2)), rng).u.any()


def test_a_steady_hand_gives_what_is_meant():
    np.testing.assert_array_equal(given(Hand(HandConfig(), PERIOD_S), [0.3, 0.1], 3), [[0.3, 0.1]] * 3)
