"""While attention lapses, nothing is decided and the stick stays where it was."""

import numpy as np
import pytest

from latentarm.core.types import Context, Input, Pose
from latentarm_research.people.contract import Decision, Moment
from latentarm_research.people.lapses import SHORTEST_S, LapseConfig, Lapsing

PERIOD_S = 0.01
SOMEWHERE = Moment(Context(np.zeros(2), np.zeros(0)), 0, Pose(np.zeros(3), np.eye(3)), np.zeros(2))


class Counting(Decision):
    """Pushes differently each time, and asks for a mode each time."""

    def __init__(self):
        self.reset()

    def reset(self):
        self.decided = 0

    @property
    def holding(self):
        return False

    def decide(self, moment, controller, imagination, rng):
        self.decided += 1
        return Input(np.array([1.0 / self.decided, 0.0]), switch_mode=True)


def driven(config, calls, seed=0):
    """Whether each call was in a lapse."""
    inner = Counting()
    lapsing = Lapsing(inner, config, PERIOD_S)
    rng = np.random.default_rng(seed)
    lapses = []
    for _ in range(calls):
        before = inner.decided
        given = lapsing.decide(SOMEWHERE, None, None, rng)
        lapses.append(inner.decided == before)
        # What is given is what was decided last, and a mode is asked for only with a decision.
        assert given.u[0] == 1.0 / inner.decided
        assert given.switch_mode != lapses[-1]
    return np.array(lapses)


def test_a_lapse_means_no_new_decision():
    lapses = driven(LapseConfig(per_minute=20.0, mean_s=0.8), 40_000)
    starts = np.flatnonzero(np.diff(lapses.astype(int)) == 1)
    ends = np.flatnonzero(np.diff(lapses.astype(int)) == -1)
    durations_s = (ends - starts[: len(ends)]) * PERIOD_S
    attentive_min = (~lapses).sum() * PERIOD_S / 60.0
    assert durations_s.min() >= SHORTEST_S
    assert durations_s.mean() == pytest.approx(0.8, rel=0.15)
    assert len(starts) / attentive_min == pytest.approx(20.0, rel=0.25)


def test_the_first_call_of_a_drive_decides():
    assert not driven(LapseConfig(per_minute=1e5, mean_s=1.0), 1).any()
