import numpy as np
import pytest

from latentarm.assistance.annotation import annotate
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode, Goal, Pose

NOWHERE = Pose(np.zeros(3), np.eye(3))
GOALS = np.array([[1.5, 0.0, 0.0], [-1.5, 0.5, 0.0]])


def demonstrations(states, goals=GOALS, rate_hz=20.0):
    episode = Episode(state=states, timestamp=np.arange(len(states)) / rate_hz, extras={"kept": states})
    named = tuple(Goal(f"goal {i}", g, NOWHERE) for i, g in enumerate(goals))
    return Demonstrations((episode,), rate_hz, ("a", "b", "c"), goals=named)


def reach(goal, rate_hz=20.0, seconds=4.0):
    return np.linspace(0, 1, int(seconds * rate_hz) + 1)[:, None] * GOALS[goal]


@pytest.mark.parametrize("goal", [0, 1])
def test_the_belief_begins_unsure_and_ends_at_the_goal_that_was_reached(goal):
    episode = annotate(demonstrations(reach(goal))).episodes[0]
    belief = episode.extras["belief"]
    assert belief.shape == (81, 2)
    assert belief[0] == pytest.approx([0.5, 0.5])
    assert belief[-1, goal] > 0.9
    assert belief.sum(axis=1) == pytest.approx(1.0)
    assert "kept" in episode.extras


def test_the_belief_of_a_sample_rests_on_earlier_samples_only():
    whole = annotate(demonstrations(reach(0))).episodes[0].extras["belief"]
    half = annotate(demonstrations(reach(0)[:40])).episodes[0].extras["belief"]
    assert np.array_equal(whole[:40], half)


def test_the_sampling_rate_hardly_matters():
    ends = [
        annotate(demonstrations(reach(0, rate, 1.0), rate_hz=rate)).episodes[0].extras["belief"][-1]
        for rate in (20.0, 100.0)
    ]
    assert ends[0] == pytest.approx(ends[1], abs=0.02)


def test_standing_still_says_nothing():
    belief = annotate(demonstrations(np.zeros((50, 3)))).episodes[0].extras["belief"]
    assert belief == pytest.approx(0.5)


def test_demonstrations_without_goals_are_refused():
    with pytest.raises(UserError, match="no goals"):
        annotate(demonstrations(reach(0), goals=GOALS[:0]))


def test_a_step_worked_by_hand():
    """Near the first goal, moving past it: the move straight there would stop at the goal."""
    goals, rate_hz, beta, horizon_s = np.array([[0.2, 0.0, 0.0], [0.0, 2.0, 0.0]]), 20.0, 3.0, 0.5
    start, velocity = np.array([0.0, 0.1, 0.0]), np.array([1.0, 0.0, 0.0])
    states = np.stack([start, start + velocity / rate_hz])
    near = (goals[0] - start) / horizon_s  # slower than 1 rad/s: it is only 0.22 rad away
    far = (goals[1] - start) / np.linalg.norm(goals[1] - start)
    likelihood = []
    for goal in goals:
        weight = [
            np.exp(-beta * np.sum((goal - (start + horizon_s * a)) ** 2)) for a in (velocity, near, far)
        ]
        likelihood.append((weight[0] / sum(weight)) ** (1 / rate_hz / horizon_s))
    expected = np.array(likelihood) / sum(likelihood)
    annotated = annotate(
        demonstrations(states, goals, rate_hz),
        lambda goals, period_s: BoltzmannBelief(goals, beta, horizon_s, period_s=period_s),
    )
    np.testing.assert_allclose(annotated.episodes[0].extras["belief"], [[0.5, 0.5], expected], rtol=1e-12)


def test_creeping_is_no_choice():
    """Compliance and noise move a held arm a little, for as long as it is held."""
    creep = np.arange(400)[:, None] / 20.0 * 0.015 * GOALS[0] / np.linalg.norm(GOALS[0])
    belief = annotate(demonstrations(creep)).episodes[0].extras["belief"]
    assert belief == pytest.approx(0.5)


@pytest.mark.parametrize("goal", [0, 1])
def test_any_rule_will_do(rule, goal):
    belief = annotate(demonstrations(reach(goal)), rule).episodes[0].extras["belief"]
    assert belief[0] == pytest.approx([0.5, 0.5])
    assert belief[-1, goal] > 0.9
    assert belief.sum(axis=1) == pytest.approx(1.0)


def test_the_rule_is_told_the_goals_and_the_rate():
    told = []

    def rule(goals, *, period_s):
        told.append((goals, period_s))
        return BoltzmannBelief(goals, period_s=period_s)

    annotate(demonstrations(reach(0), rate_hz=40.0), rule)
    np.testing.assert_array_equal(told[0][0], GOALS)
    assert told[0][1] == pytest.approx(1 / 40)
