"""The cost-to-go with the published constants, against cases worked by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.core.types import Pose
from latentarm.robots.kinematics.rotations import rotation_vector
from latentarm_research.assistance.cost_to_go import ROTATION, TRANSLATION, GoalPoses


def turned(angle, axis=2):
    cos, sin = np.cos(angle), np.sin(angle)
    matrix = np.eye(3)
    i, j = [k for k in range(3) if k != axis]
    matrix[[i, i, j, j], [i, j, i, j]] = cos, -sin, sin, cos
    return matrix


def pose(x=0.0, y=0.0, z=0.0, angle=0.0):
    return Pose(np.array([x, y, z]), turned(angle))


def stacked(*poses):
    parts = ([getattr(one, part) for one in poses] for part in ("position", "rotation"))
    return GoalPoses(Pose(*map(np.stack, parts)))


def to_go(goal, at):
    """V, by hand."""
    shift, turn = goal.position - at.position, rotation_vector(goal.rotation @ at.rotation.T)
    return TRANSLATION.value(np.linalg.norm(shift)) + ROTATION.value(np.linalg.norm(turn))


ORIGIN = pose()


class TestByHand:
    def test_translation(self):
        # 2.45 d - 2.25 * 0.07 / 2 beyond 7 cm; 2.25 / 0.14 d² + 0.2 d within.
        distance = np.array([0.0, 0.01, 0.05, 0.07, 0.1, 0.3])
        value = [0.0, 0.0036071429, 0.0501785714, 0.09275, 0.16625, 0.65625]
        assert TRANSLATION.value(distance) == pytest.approx(value)
        # (2.25 d / 0.07 + 0.2) / 40 within 7 cm, and in proportion to the distance within 2 cm.
        speed = [0.0, 0.0065178571, 0.0451785714, 0.06125, 0.06125, 0.06125]
        assert TRANSLATION.speed(distance) == pytest.approx(speed)

    def test_rotation(self):
        delta = np.pi / 32
        angle = np.array([0.0, delta / 2, delta, np.pi / 12, 1.0, np.pi])
        value = 0.07 * np.array(
            [
                0.0,
                0.20 * delta / 8 + 0.01 * delta / 2,
                0.20 * delta / 2 + 0.01 * delta,
                0.21 * np.pi / 12 - 0.1 * delta,
                0.21 - 0.1 * delta,
                0.21 * np.pi - 0.1 * delta,
            ]
        )
        assert ROTATION.value(angle) == pytest.approx(value)
        # 0.07 * 0.21 / 0.05 from 15 degrees on.
        assert ROTATION.speed(angle[3:]) == pytest.approx([0.294] * 3)
        assert ROTATION.speed(angle[1:2]) == pytest.approx(0.07 * 0.11 / 0.05 * (delta / 2) / (np.pi / 12))

    def test_an_input_that_comes_a_centimetre_nearer(self):
        goals = stacked(pose(0.3), pose(-0.3))
        said = goals.advantage(ORIGIN, pose(0.01))
        # 0.1 s at 30 cm cost 0.245; 1 cm is worth 0.0245 towards the goal, and costs as much away from it.
        # The angle is zero before and after: 0.1 s there cost 0.1 * 0.07 * 0.01.
        assert said == pytest.approx([0.245 - 0.0245 + 0.00007, 0.245 + 0.0245 + 0.00007])

    def test_an_input_that_turns(self):
        goals = stacked(pose(0.3, angle=1.0))
        said = goals.advantage(ORIGIN, pose(angle=0.1))
        assert said == pytest.approx([0.245 + 0.1 * 0.07 * 0.21 - 0.1 * 0.07 * 0.21])

    def test_the_robots_action(self):
        twists = stacked(pose(0.3, angle=1.0), pose(0.0, 0.05)).twists(ORIGIN)
        assert twists[0] == pytest.approx([0.06125, 0, 0, 0, 0, 0.294])
        assert twists[1] == pytest.approx([0, 0.0451785714, 0, 0, 0, 0])


distances = st.floats(0.0, 2.0)


@pytest.mark.parametrize("cost", [TRANSLATION, ROTATION])
@given(distances, st.floats(1e-6, 0.5))
def test_the_cost_to_go_grows_and_its_slope_is_the_rate(cost, distance, further):
    near, far = np.array([distance, distance + further])
    rise = cost.value(far) - cost.value(near)
    # Convex: the mean slope is between those of the ends.
    assert cost.rate(near) * further - 1e-12 <= rise <= cost.rate(far) * further + 1e-12


places = st.tuples(*[st.floats(-1, 1)] * 3, st.floats(-3, 3))


@settings(max_examples=15)
@given(st.lists(places, min_size=1, max_size=4), places)
def test_the_robot_goes_downhill_no_faster_than_the_published_gains(goals, here):
    at, wanted = pose(*here), [pose(*one) for one in goals]
    twists = stacked(*wanted).twists(at)
    assert (np.linalg.norm(twists[:, :3], axis=1) <= 0.2).all()
    assert (np.linalg.norm(twists[:, 3:], axis=1) <= 0.4).all()
    dt = 1e-4
    after = [Pose(at.position + dt * one[:3], turned(dt * one[5]) @ at.rotation) for one in twists]
    for goal, one in zip(wanted, after, strict=True):
        assert to_go(goal, one) <= to_go(goal, at) + 1e-12


def test_leading_axes_are_as_each_alone():
    poses = stacked(pose(0.3), pose(0.0, 0.2), pose(-0.2, 0.1, angle=1.0))
    rng = np.random.default_rng(0)
    position, angle = rng.normal(size=(2, 4, 3)), rng.normal(size=(2, 4))
    rotation = np.array([[turned(one) for one in row] for row in angle])
    at, after = (Pose(position[i], rotation[i]) for i in range(2))
    each = [
        [Pose(part.position[k], part.rotation[k]) for part in (at, after)] for k in range(len(position[0]))
    ]
    assert poses.advantage(at, after) == pytest.approx(np.stack([poses.advantage(*one) for one in each]))
    assert poses.twists(after) == pytest.approx(np.stack([poses.twists(one[1]) for one in each]))
