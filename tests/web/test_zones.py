"""The page drives slowly in a zone, shows it, and says why it is slow; in simulated time."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.robots.kinematics.obstacles import HalfSpace, Sphere
from latentarm.safety.zones import Zone
from latentarm.web.arm_process.drive_setup import Spec, load_setup
from latentarm.web.server.loaded_run import LoadedRun

SPEED = 0.03


def slow(setup, shape):
    return replace(setup, spec=replace(setup.spec, zones=(Zone(shape, SPEED),)))


def driven(desk, seconds=2.0):
    desk.push(seconds)
    tools = np.array([report.tool for report in desk.reports])
    return np.linalg.norm(np.diff(tools, axis=0), axis=1).max() / 0.01


def test_an_arm_that_is_slow_for_a_zone_says_for_which(setup, desk_of):
    tool = setup.task.robot.chain.forward(setup.start).position
    with desk_of(slow(setup, Sphere("face", tool, 0.3))) as desk:
        assert 0.5 * SPEED < driven(desk) <= SPEED
        moving = [report for report in desk.reports if report.phase == "moving"]
        assert {(report.held_back, report.zone) for report in moving[5:]} == {("zone", "face")}
        assert {report.zone for report in desk.reports if report.phase != "moving"} == {None}


def test_far_from_every_zone_it_is_as_quick_as_without_any(setup, desk_of):
    with desk_of(setup) as desk:
        quickest = driven(desk)
    assert quickest > 2.0 * SPEED
    with desk_of(slow(setup, Sphere("face", np.array([0.0, 0.0, 3.0]), 0.3))) as desk:
        assert driven(desk) == pytest.approx(quickest)
        assert {report.zone for report in desk.reports} == {None}


def test_pages_are_told_where_it_is_slow(setup):
    floor = HalfSpace("table", np.array([0.0, 0.0, 0.1]), np.array([0.0, 0.0, 1.0]))
    run = LoadedRun(slow(setup, floor), None)
    assert [zone.model_dump() for zone in run.welcome("page", "server").zones] == [
        {"name": "table", "speed": SPEED}
    ]
    assert run.scene.description["zones"] == [
        {
            "name": "table",
            "type": "plane",
            "point": [0.0, 0.0, 0.1],
            "normal": [0.0, 0.0, 1.0],
            "speed": SPEED,
        }
    ]


def test_the_arm_keeps_out_of_what_a_person_says_and_pages_are_told(setup, desk_of):
    wall = HalfSpace("wall", np.array([0.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    start = setup.task.robot.chain.forward(setup.start).position
    raised = replace(wall, point=np.array([0.0, 0.0, start[2] - 0.1]))
    kept = replace(setup, spec=replace(setup.spec, keep_out=(raised,)))
    with desk_of(kept) as desk:
        driven(desk, seconds=4.0)
        obstacles = desk.setup.step().safety.obstacles
    assert raised.name in [one.name for one in obstacles]
    lowest = min(report.tool[2] for report in desk.reports)
    assert lowest >= raised.point[2] + 0.02
    run = LoadedRun(kept, None)
    assert run.welcome("page", "server").keep_out == ("wall",)
    assert [one["name"] for one in run.scene.description["obstacles"]][-1] == "wall"


def test_a_zone_that_is_no_slower_is_refused_before_anything_is_served():
    with pytest.raises(UserError, match="The zone 'face' allows"):
        load_setup(Spec(zones=(Zone(Sphere("face", np.zeros(3), 0.1), 1.0),)))
