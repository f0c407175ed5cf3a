import sys
import types
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.robots.catalogue import ROBOTS, load_robot


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_of_the_catalogue_is_whole(name):
    robot = load_robot(name)
    assert robot.name == name
    assert robot.home.shape == (robot.dof,) == robot.limits.lower.shape
    assert not robot.limits.violation(robot.home).any()
    assert robot.tool_speed_limit > 0
    assert np.linalg.matrix_rank(robot.chain.jacobian(robot.home)) >= 3
    fingers = () if robot.gripper is None else robot.gripper.joints
    assert robot.model().njnt == robot.dof + len(fingers)


def test_an_unknown_name_is_answered_with_the_known_ones():
    with pytest.raises(UserError, match=r"no robot named 'pandas'.*panda, planar, planar2.*path"):
        load_robot("pandas")


def test_a_missing_file_is_said():
    with pytest.raises(UserError, match=r"nowhere\.xml cannot be read: No such file"):
        load_robot("nowhere.xml")


def test_a_named_robot_keeps_its_own_end_effector():
    with pytest.raises(UserError, match="its own end-effector"):
        load_robot("panda", "link3")


class FakeMenagerieError(Exception):
    pass


def fake_menagerie(monkeypatch, folder: Path | None):
    """The optional package, with one robot in its cache or none."""

    def path(progress):
        assert progress is None
        if folder is None:
            raise FakeMenagerieError("no network\nat all")
        return folder

    robot = types.SimpleNamespace(
        path=path, default_model="arm", entry=lambda name: types.SimpleNamespace(file=f"{name}.xml")
    )
    module = types.ModuleType("mujoco_menagerie")
    module.names = lambda: ["some_arm"]
    module.get = {"some_arm": robot}.__getitem__
    module.MenagerieError = FakeMenagerieError
    monkeypatch.setitem(sys.modules, "mujoco_menagerie", module)


def test_a_menagerie_robot_loads_by_name(monkeypatch, tmp_path):
    (tmp_path / "arm.xml").write_text(
        "<mujoco><worldbody><body name='a'><joint axis='0 1 0'/><geom size='0.1'/>"
        "<site name='hand' pos='1 0 0'/></body></worldbody></mujoco>"
    )
    fake_menagerie(monkeypatch, tmp_path)
    assert load_robot("some_arm").chain.tools[0].name == "hand"
    with pytest.raises(UserError, match="no robot named 'another_arm'"):
        load_robot("another_arm")


def test_a_menagerie_robot_that_cannot_be_had_is_said(monkeypatch):
    fake_menagerie(monkeypatch, None)
    with pytest.raises(
        UserError, match=r"'some_arm' is not in .* cache and cannot be downloaded \(no network at all\)"
    ):
        load_robot("some_arm")
