"""Film strips of drives at tasks with things; that MuJoCo renders is tried where it can."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from figure_faults import faults
from latentarm.arms.kinematic import KinematicArm
from latentarm.core.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.robots.panda_look import SHELL_GROUP
from latentarm_research.drives.film import ACROSS, WHOLE, Camera, Film, strip


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


def test_no_picture_cuts_off_the_arm():
    robot = load_robot("panda")
    model = robot.model()
    data = mujoco.MjData(model)
    data.qpos[:] = model.key_qpos[0]
    mujoco.mj_forward(model, data)
    azimuth, elevation = np.radians([WHOLE.azimuth_deg, WHOLE.elevation_deg])
    ahead = np.array([np.cos(azimuth), np.sin(azimuth), np.tan(elevation)])
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    tall = np.tan(np.radians(model.vis.global_.fovy / 2.0))
    seen = np.flatnonzero(model.geom_group < SHELL_GROUP)
    away = data.geom_xpos[seen] - (np.array(WHOLE.look_at) - WHOLE.distance_m * ahead)
    depth = away @ ahead
    # Of each geom the ball about it is in the picture.
    radius = model.geom_rbound[seen]
    assert (np.abs(away @ up) + radius < tall * depth).all()
    assert (np.abs(away @ right) + radius < tall * depth * WHOLE.width / WHOLE.height).all()
