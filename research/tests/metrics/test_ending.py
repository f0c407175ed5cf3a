import numpy as np
import pytest

from latentarm.core.types import Command, Pose, StepRecord, Stop
from latentarm_research.metrics.ending import STUCK_S, why_it_timed_out

TARGET = Pose(position=np.array([1.0, 0.0, 0.0]), rotation=np.eye(3))
TIMES_S = np.arange(0.0, 60.0, 0.5)


def records(x, u=1.0, velocity=0.1, stop=None, limited_by=()):
    """A drive along x; the inputs ask for 0.1 rad/s throughout."""
    return [
        StepRecord(
            time_s=float(time_s),
            state=np.array([place, 0.0, 0.0]),
            input=np.array([u]),
            latent=np.array([u]),
            action_human=np.array([0.1 * u, 0.0, 0.0]),
            action_assist=np.zeros(3),
            alpha=0.0,
            belief=np.zeros(0),
            mode=0,
            command=Command(np.array([velocity, 0.0, 0.0]), 0.1, stop, limited_by),
        )
        for time_s, place in zip(TIMES_S, np.broadcast_to(x, TIMES_S.shape), strict=True)
    ]


def reason(gantry, drive, since_s=0.0):
    return why_it_timed_out(drive, gantry, TARGET, since_s).reason


def test_a_drive_that_comes_nearer_ran_out_of_time(gantry):
    assert reason(gantry, records(TIMES_S / 100)) == "time_limit"


def test_a_new_waypoint_is_progress(gantry):
    assert reason(gantry, records(0.5), since_s=TIMES_S[-1] - STUCK_S + 1) == "time_limit"


def test_an_operator_without_a_helpful_input_is_stuck(gantry):
    assert reason(gantry, records(0.5, u=0.0, velocity=0.0)) == "operator_stuck"


def test_to_and_fro_is_stuck_too(gantry):
    assert reason(gantry, records(0.5 + 0.1 * np.sin(TIMES_S))) == "operator_stuck"


def test_coming_back_to_where_it_was_is_no_progress(gantry):
    assert reason(gantry, records(np.where(TIMES_S < 20, 0.6, TIMES_S / 100))) == "operator_stuck"


def test_inputs_that_the_filters_do_not_let_through_hold_the_arm_back(gantry):
    ending = why_it_timed_out(records(0.5, velocity=0.0, limited_by=("joint position",)), gantry, TARGET, 0.0)
    assert ending.reason == "held_back"
    assert "joint position" in ending.detail


def test_a_stop_by_safety_is_said_with_its_reason(gantry):
    ending = why_it_timed_out(records(0.5, stop=Stop("The stick is gone.")), gantry, TARGET, 0.0)
    assert ending.reason == "safety_stop"
    assert "The stick is gone" in ending.detail


@pytest.mark.parametrize("since_s", [0.0, 30.0])
def test_a_turn_towards_the_waypoint_is_progress(gantry, since_s):
    class Turning(type(gantry)):
        def forward(self, q, tool=0):
            angle = q[..., 0]
            cos, sin, zero, one = np.cos(angle), np.sin(angle), 0 * angle, 1 + 0 * angle
            rotation = np.stack([cos, -sin, zero, sin, cos, zero, zero, zero, one], -1)
            return Pose(np.zeros((*angle.shape, 3)), rotation.reshape(*angle.shape, 3, 3))

    upright = Pose(np.zeros(3), np.eye(3))
    ending = why_it_timed_out(records(1.0 - TIMES_S / 100), Turning(), upright, since_s)
    assert ending.reason == "time_limit"
