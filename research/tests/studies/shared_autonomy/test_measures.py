import numpy as np
import pytest

from latentarm_research.studies.shared_autonomy.drive import STEP_S, Drives, Moment
from latentarm_research.studies.shared_autonomy.measures import (
    ARRIVED,
    measure,
    state_error,
    true_belief,
)


def along(scene, shares, target):
    """Drives whose states lie on the line from the first goal (share 0) to the second (share 1)."""
    shares = np.asarray(shares, dtype=float)
    one, other = scene.goals
    state = one + shares[..., None] * (other - one)
    count, steps = shares.shape[0], shares.shape[1] - 1
    belief = np.tile([0.25, 0.75], (count, steps, 1))
    moments = Moment(
        state=state[:, :-1],
        belief=belief,
        wanted=np.tile(np.array(target)[:, None], (1, steps)),
        alpha=np.zeros((count, steps)),
        u=np.zeros((count, steps)),
        action=np.zeros((count, steps, len(one))),
    )
    return Drives(moments, state[:, -1], belief[:, -1], np.array(target))


def test_figures_by_hand(scene, straight):
    drives = along(scene, [[0.5, 0.3, 0.1, 0.3, 0.25], [0.5, 0.5, 0.5, 0.6, 0.7]], [0, 0])
    figures = measure(drives, scene, straight)
    np.testing.assert_allclose(figures["final_state_error"], [0.25, 0.7])
    np.testing.assert_allclose(figures["time_s"], [2 * STEP_S, 4 * STEP_S])  # 0.1 is the first below 0.2
    np.testing.assert_array_equal(figures["arrival_rate"], [1.0, 0.0])


def test_errors_are_those_to_the_goal_that_was_wanted(scene, straight):
    drives = along(scene, [[0.0, 0.5, 1.0], [0.0, 0.5, 1.0]], [0, 1])
    np.testing.assert_allclose(state_error(drives, scene), [[0.0, 0.5, 1.0], [1.0, 0.5, 0.0]], atol=1e-12)
    np.testing.assert_allclose(true_belief(drives), [[0.25] * 3, [0.75] * 3])
    figures = measure(drives, scene, straight)
    np.testing.assert_allclose(figures["time_s"], [0.0, 2 * STEP_S])


@pytest.mark.parametrize("share", [0.0, ARRIVED - 1e-9, ARRIVED + 1e-9, 1.0])
def test_arriving_is_coming_within_a_fifth(scene, straight, share):
    arrived = measure(along(scene, [[1.0, share]], [0]), scene, straight)["arrival_rate"]
    assert arrived[0] == (share < ARRIVED)
