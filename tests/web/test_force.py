"""An arm that presses on something slows down, and the page says why; in simulated time."""

import numpy as np

from latentarm.arms.kinematic import KinematicArm
from latentarm.safety.config import SafetyConfig


def way(desk):
    """From the start to where full pushes lead the tool, (3,), m."""
    desk.push(0.8)
    return np.subtract(desk.reports[-1].tool, desk.reports[0].tool)


def test_an_arm_that_presses_on_something_says_so_and_slows_down(setup, desk_of, monkeypatch):
    with desk_of(setup) as desk:
        free = way(desk)
        assert {report.held_back for report in desk.reports} == {None}
    force = -0.65 * SafetyConfig().tool_force * free / np.linalg.norm(free)
    chain = setup.task.robot.chain

    def felt(arm):
        return chain.jacobian(arm._measure()[0])[:3].T @ force

    monkeypatch.setattr(KinematicArm, "_external_torque", felt)
    with desk_of(setup) as desk:
        pressed = way(desk)
        moving = [report for report in desk.reports if report.phase == "moving"]
        assert {report.held_back for report in moving[5:]} == {"force"}
    assert 0.3 < np.linalg.norm(pressed) / np.linalg.norm(free) < 0.7
