"""Movements along one axis: to a near target in time, and Fitts's law through their times."""

import numpy as np
import pytest

from latentarm.assistance.controllers.axis_modes import AxisModes
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.robots.catalogue import load_robot
from latentarm_research.drives.pointing import Pointing, point
from latentarm_research.people.population import draw_people


def test_a_person_comes_to_a_target_no_sooner_than_they_react():
    robot, traits = load_robot("panda_fork"), draw_people(1, 1)[0]
    controller = EndEffectorController(robot, modes=AxisModes(("x-y",), ((0, 1),)))
    movement = Pointing(axis=1, distance_m=0.03, width_m=0.03)
    took_s = [
        point(robot, controller, traits.person(0, 300.0), movement, np.random.default_rng(3))
        for _ in range(2)
    ]
    assert traits.reaction_s < took_s[0] < 4.0
    assert took_s[0] == took_s[1]


def test_difficulty_is_shannons():
    assert Pointing(0, -0.07, 0.01).difficulty == pytest.approx(3.0)
