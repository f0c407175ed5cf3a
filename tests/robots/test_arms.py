"""Arms as other people describe them; `make arms` fetches what the dev extra does not ship."""

import os
import tomllib
from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np
import pytest

from latentarm.arms.own_pose import OwnPose, misfits
from latentarm.core.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.reader import reference_positions

DOCUMENT = tomllib.loads((Path(__file__).parents[2] / "scripts" / "arms.toml").read_text(encoding="utf-8"))
CACHE = Path(os.environ.get("LATENTARM_ARMS") or Path.home() / ".cache" / "latentarm" / "arms")
INSTALLED = ("airo-models", "dm-control")
"""Packages of the dev extra."""


def arms(*, refused):
    return [
        pytest.param(arm, id=arm["name"], marks=() if arm["package"] in INSTALLED else pytest.mark.slow)
        for arm in DOCUMENT["arm"]
        if ("refused" in arm) == refused
    ]


def file_of(arm):
    if arm["package"] in INSTALLED:
        package, _, rest = arm["file"].partition("/")
        spec = find_spec(package)
        assert spec is not None
        assert spec.submodule_search_locations
        return Path(next(iter(spec.submodule_search_locations))) / rest
    path = CACHE / f"{arm['package']}-{DOCUMENT['packages'][arm['package']]['version']}" / arm["file"]
    if not path.is_file():
        pytest.skip(f"{arm['package']} is not in {CACHE}: `make arms` fetches it")
    return path


@pytest.mark.parametrize("arm", arms(refused=False))
def test_the_tool_is_where_mujoco_puts_it_and_an_arm_that_says_so_is_accepted(arm):
    robot = load_robot(str(file_of(arm)), arm.get("end_effector"))
    assert robot.dof == arm["joints"]
    # Nobody has told of accelerations and jerks, whatever the file.
    assert {"acceleration", "jerk"} <= set(robot.limits.assumed)
    model = robot.model()
    data = mujoco.MjData(model)
    addresses = [int(model.joint(name).qposadr[0]) for name in robot.joint_names]
    tool = robot.chain.tools[0].name
    is_site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, tool) >= 0
    told = []
    for q in np.random.default_rng(0).uniform(robot.limits.lower, robot.limits.upper, (20, robot.dof)):
        data.qpos[:] = reference_positions(model)
        data.qpos[addresses] = q
        mujoco.mj_kinematics(model, data)
        placed = data.site(tool) if is_site else data.body(tool)
        pose = robot.chain.forward(q)
        np.testing.assert_allclose(pose.position, placed.xpos, atol=1e-9)
        np.testing.assert_allclose(pose.rotation, placed.xmat.reshape(3, 3), atol=1e-9)
        frame = np.eye(4)
        frame[:3, :3], frame[:3, 3] = placed.xmat.reshape(3, 3), placed.xpos
        told.append(OwnPose(q, frame))
    assert misfits(told, robot) == ()


@pytest.mark.parametrize("arm", arms(refused=True))
def test_what_cannot_be_driven_is_refused_in_one_sentence(arm):
    with pytest.raises(UserError, match=arm["refused"]) as raised:
        load_robot(str(file_of(arm)))
    assert "\n" not in str(raised.value)
