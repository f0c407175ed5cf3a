import numpy as np
import pytest

from latentarm_research.tasks.two_cups import SPEED_RAD_S, TWO_CUPS


@pytest.fixture(params=sorted(TWO_CUPS), scope="module")
def task(request):
    return TWO_CUPS[request.param]()


def test_the_cups_are_equally_far_from_the_start_and_one_radian_apart(task):
    left, right = (goal.configuration for goal in task.goals)
    assert np.linalg.norm(left - right) == pytest.approx(1.0, abs=1e-3)
    assert np.linalg.norm(left - task.start) == pytest.approx(np.linalg.norm(right - task.start), rel=0.02)
    places = [task.robot.chain.forward(state).position for state in (left, right, task.start)]
    assert np.linalg.norm(places[0] - places[2]) == pytest.approx(
        np.linalg.norm(places[1] - places[2]), rel=0.03
    )


def test_grasps_part_to_opposite_sides_and_end_nearer_to_their_goal_than_the_other_cup_is(task):
    for index, goal in enumerate(task.goals):
        side, top = (task.waypoints(index, manner)[1] for manner in task.manners)
        out = side.position - goal.pose.position, top.position - goal.pose.position
        assert np.linalg.norm(out[0] - out[1]) > 0.05
        for manner in task.manners:
            end = task._strokes[index, manner][-1]
            assert 0.3 < np.linalg.norm(end - goal.configuration) < 1.0


def test_the_simulated_person_moves_at_one_speed_and_passes_the_goal(task):
    shown = task.demonstrate(8, np.random.default_rng(0))
    for index, episode in enumerate(shown.episodes):
        speed = np.linalg.norm(episode.action[:-1], axis=-1)
        assert np.median(speed) == pytest.approx(SPEED_RAD_S, rel=1e-3)
        assert speed.max() < 1.01 * SPEED_RAD_S  # less where the way turns sharply
        assert not episode.action[-1].any()
        moved = episode.state[:-1] + episode.action[:-1] / shown.rate_hz
        assert moved == pytest.approx(episode.state[1:])
        away = np.linalg.norm(episode.state - task.goals[index % 2].configuration, axis=-1)
        assert away.min() < 0.1


def test_cups_and_manners_take_turns(task):
    names = [episode.task for episode in task.demonstrate(4, np.random.default_rng(0)).episodes]
    assert len(set(names)) == 4
