"""A simulated detector is right until its fault, and then wrong in the way that its name says."""

import numpy as np
import pytest

from latentarm.core.types import Pose
from latentarm.tasks.catalogue import make_scene_task
from latentarm_research.measurements.thing_sources import AGE_TICKS, FAULT_S, SD_M, SOURCES, Detections

TOOL = Pose(np.array([0.4, 0.0, 0.5]), np.eye(3))
NEAR_M = 6.0 * SD_M


@pytest.mark.parametrize("task", ["marshmallows", "reach_and_pour"])
@pytest.mark.parametrize("source", SOURCES[3:])
def test_a_detector_errs_as_its_name_says_and_only_from_its_fault_on(source: str, task: str) -> None:
    begun = make_scene_task(task).begin(0, np.random.default_rng(1))
    poses = {thing.name: thing.pose for thing in begun.scene.things}
    detections = Detections(source, begun, np.random.default_rng(2))
    off_m: list[tuple[float, str, float]] = []
    for tick in range(1200):
        for one in detections.look(0.01 * tick, poses, TOOL):
            away_m = float(np.linalg.norm(one.pose.position - poses[one.name].position))
            off_m.append((0.01 * tick, one.name, away_m))
    assert off_m[0][0] == pytest.approx(0.01 * AGE_TICKS)
    assert all(away_m < NEAR_M for time_s, _, away_m in off_m if time_s < FAULT_S[0])
    after = {
        name: [away_m for time_s, other, away_m in off_m if other == name and time_s > FAULT_S[1]]
        for name in poses
    }
    wrong = {name for name, away_m in after.items() if away_m and min(away_m[len(away_m) // 2 :]) > NEAR_M}
    pauses_s = np.diff(np.unique([time_s for time_s, _, _ in off_m]))
    assert pauses_s.max() == pytest.approx(2.0 if "silent" in source else 0.1, abs=0.11)
    aim = begun.steps[-1].thing
    if "jumps" in source:
        assert wrong == {aim}
        assert np.mean(after[aim]) == pytest.approx(0.1, abs=0.01)
    elif "swaps" in source:
        assert len(wrong) == 2
        assert aim in wrong
    else:
        assert wrong == set()
