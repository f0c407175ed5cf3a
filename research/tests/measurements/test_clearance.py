"""Distances as MuJoCo measures them on the robots' own geoms: no capsule and no distance code of ours."""

import numpy as np
import pytest

from latentarm.control.step import Step
from latentarm.robots.assemble import assemble
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere
from latentarm.robots.kinematics.reader import read
from latentarm.robots.limits import JointLimits
from latentarm_research.measurements import held_things
from latentarm_research.measurements.clearance import ARMS, PERIODS_S, ROUNDING_M, arm, drive
from latentarm_research.measurements.geom_distances import Judge, outside, solid_geoms
from latentarm_research.measurements.pushing import HARMS, scene


@pytest.mark.parametrize("name", ARMS)
def test_every_geom_lies_in_the_capsule_that_stands_for_it(name):
    robot = arm(name)
    model = robot.model()
    reading = read(model, [tool.name for tool in robot.chain.tools])
    stood_for = 0
    for geom in solid_geoms(model):
        gaps, mine = outside(robot, model, reading, geom)
        if mine:
            stood_for += 1
            assert gaps.max(axis=1).min() < 1e-6
    assert stood_for >= robot.dof


@pytest.mark.parametrize(
    ("thing", "expected"),
    [
        (HalfSpace("wall", np.array([0.5, 0.0, 0.0]), np.array([-0.6, 0.0, 0.8])), 0.3 - 0.05),
        (Sphere("ball", np.array([0.0, 0.3, 0.0]), 0.1), 0.3 - 0.15),
        (Capsule("rod", np.array([-1.0, 0.0, 0.2]), np.array([1.0, 0.0, 0.2]), 0.02), 0.2 - 0.07),
        (Box("box", np.array([0.3, 0.0, 0.0]), np.eye(3), np.array([0.1, 0.2, 0.3])), 0.2 - 0.05),
    ],
)
def test_the_judge_knows_these_distances(thing, expected):
    """A ball that slides, at its origin."""
    text = """<mujoco><worldbody><body name="ball">
      <joint name="x" type="slide" axis="1 0.5 0.3" range="-1 1"/><geom size="0.05"/><site name="tip"/>
      </body></worldbody></mujoco>"""
    one = np.ones(1)
    robot = assemble("ball", text, ["tip"], JointLimits(-one, one, one, one, one), 0 * one, 1.0)
    judge = Judge(robot, (thing,))
    assert judge.distances(np.zeros(1), 1.0) == pytest.approx([expected], abs=1e-6)


def test_the_judge_does_not_depend_on_how_far_it_looks():
    """With the Jaco's own settings MuJoCo answers 30 mm or -65 mm, by the largest distance asked for."""
    rng = np.random.default_rng([0, 19])
    _obstacles, judge, q, _push = scene(arm("jaco"), "rod", rng)
    for _ in range(5):
        state = q + rng.normal(size=6) * 0.1
        near, far = judge.distances(state, 0.06), judge.distances(state, 1.0)
        np.testing.assert_allclose(near, np.minimum(far, 0.06), rtol=0, atol=1e-5)


@pytest.mark.parametrize(
    ("name", "harm"),
    [(name, HARMS[(row + shift) % 5]) for row, name in enumerate(ARMS) for shift in (0, 1, 3)],
)
def test_no_arm_comes_nearer_than_it_may(name, harm):
    rng = np.random.default_rng([7, ARMS.index(name)])
    assert drive(arm(name), harm, 0.01, rng) >= 0.02 - ROUNDING_M


@pytest.mark.parametrize("number", range(3, 15, 2))
def test_a_held_spoon_is_kept_clear_and_slow(number):
    assert held_things.drive((1, number))[-1] == 0


def test_that_is_no_chance(monkeypatch):
    monkeypatch.setattr(Step, "hold", lambda step, *things: None)
    assert sum(held_things.drive((1, number))[-1] > 0 for number in range(3, 15, 2)) >= 2


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_nor_in_many_more_drives(name):
    nearest = []
    for seed in range(60):
        rng = np.random.default_rng([11, seed])
        harm, period_s = HARMS[seed % 5], PERIODS_S[seed // 5 % 3]
        nearest.append(drive(arm(name), harm, period_s, rng))
    assert min(nearest) >= 0.02 - ROUNDING_M
    # They are not safe for want of trying.
    assert np.median(nearest) < 0.04
