import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.core.types import Pose
from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.rotations import pose_error
from latentarm.tasks.inverse_kinematics import solve


@pytest.mark.parametrize("seed", range(5))
def test_the_tool_is_put_where_it_is_asked_for(seed):
    panda = load_robot("panda")
    target = panda.chain.forward(panda.home + np.random.default_rng(seed).uniform(-0.4, 0.4, 7))
    found = solve(panda, target, panda.home)
    assert np.linalg.norm(pose_error(panda.chain.forward(found), target)) < 2e-4
    assert not panda.limits.violation(found).any()
    assert np.linalg.norm(found - panda.home) < 2.0


def test_a_pose_out_of_reach_is_said_so():
    panda = load_robot("panda")
    with pytest.raises(UserError, match=r"does not bring its tool to \(2.00, 0.00, 0.50\) m"):
        solve(panda, Pose(np.array([2.0, 0.0, 0.5]), np.diag([1.0, -1.0, -1.0])), panda.home)
