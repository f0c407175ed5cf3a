"""The page's arm is no faster than it was asked to be, and its arrows show that; in simulated time."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.control.stick_ring import STRETCHES
from latentarm.core.errors import UserError
from latentarm.core.types import Context
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.arm_process.ghosts import GhostPaths
from latentarm.web.arm_process.initial_state import RobotOptions
from latentarm.web.arm_process.speed_limits import Speeds


def with_speeds(setup, **speeds):
    return replace(setup, spec=replace(setup.spec, speeds=Speeds(**speeds)))


def driven(desk):
    """The fastest joint, rad/s, and the fastest tool, m/s, of a drive."""
    desk.push(2.0)
    joints = np.array([report.q for report in desk.reports])
    tools = np.array([report.tool for report in desk.reports])
    return np.abs(np.diff(joints, axis=0)).max() / 0.01, np.linalg.norm(
        np.diff(tools, axis=0), axis=1
    ).max() / 0.01


@pytest.mark.parametrize(("what", "limit", "place"), [("joint", 0.1, 0), ("link", 0.03, 1)])
def test_the_arm_is_as_slow_as_asked(setup, desk_of, what, limit, place):
    with desk_of(setup) as desk:
        usual = driven(desk)[place]
    with desk_of(with_speeds(setup, **{what: limit})) as desk:
        slow = driven(desk)[place]
    assert 0.5 * limit < slow <= limit + 1e-9 < usual


def test_arrows_are_as_short_as_the_arm_is_slow(setup):
    context = Context(setup.start, np.full(len(setup.task.goals), 1.0 / len(setup.task.goals)))
    tool = setup.task.robot.chain.forward(setup.start).position
    lengths = []
    for one in (setup, with_speeds(setup, link=0.03)):
        ghosts = GhostPaths(one.task, one.controller, one.help, one.step().safety)
        mode = setup.mode_index("end_effector", 0)
        for _ in range(STRETCHES):
            ghosts.look(context, mode)
        lengths.append(np.linalg.norm(np.array(ghosts.newest(mode).right)[-1] - tool))
    assert lengths[1] <= 0.03 + 1e-6 < lengths[0]


@pytest.mark.parametrize("speeds", [{"joint": 0.6}, {"link": 0.3}, {"joint": 0.0}, {"link": np.nan}])
def test_a_speed_that_is_no_limit_is_refused(speeds):
    option = "--joint-speed" if "joint" in speeds else "--link-speed"
    with pytest.raises(UserError, match=f"{option} is .*: it must be from 0.01 to"):
        Speeds(**speeds)


def test_an_arm_that_can_do_less_is_driven_more_slowly(tmp_path):
    limits = tmp_path / "limits.toml"
    limits.write_text("[joints.joint1]\nvelocity_rad_per_s = 0.3\n")
    robot = RobotOptions("panda", limits=limits)
    with pytest.raises(UserError, match=r"set it lower \(teleop: --joint-speed\)"):
        load_setup(Spec(task="reach", robot=robot)).step()
    step = load_setup(Spec(task="reach", robot=robot, speeds=Speeds(joint=0.3))).step()
    assert step.joint_speed.max() == 0.3
