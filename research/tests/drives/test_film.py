"""Film strips of drives at tasks with things; that MuJoCo renders is tried where it can."""

from types import SimpleNamespace

import numpy as np
import pytest

from figure_faults import faults
from latentarm.arms.kinematic import KinematicArm
from latentarm.core.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm_research.drives.film import ACROSS, Camera, Film, strip


def trace_of(*steps, done_s=()):
    return SimpleNamespace(steps=[SimpleNamespace(name=name) for name in steps], done_s=done_s)


@pytest.mark.parametrize("count", [ACROSS, 2 * ACROSS])
def test_a_strip_says_under_each_picture_when_it_was_and_what_was_to_be_done(count):
    times = np.linspace(0.0, 9.0, count)
    pictures = [np.full((36, 48, 3), 200, dtype=np.uint8)] * count
    trace = trace_of("above the left marshmallow", "the left marshmallow on the fork", done_s=(3.0, 9.0))
    figure = strip("a drive, simulated", times, pictures, trace)
    assert faults(figure) == []
    said = [" ".join(axes.get_xlabel().split()) for axes in figure.axes]
    assert said[0] == "0.0 s: above the left marshmallow"
    assert said[count // 2].endswith("the left marshmallow on the fork")
    assert said[-1] == "9.0 s: done"


def test_only_an_arm_in_mujoco_can_be_filmed():
    robot = load_robot("panda")
    with pytest.raises(UserError, match="take the arm mujoco"):
        Film().sees(KinematicArm(robot, robot.home, lambda: 0.0))
    with pytest.raises(UserError, match="no drive was watched"):
        Film().frames(Camera())
