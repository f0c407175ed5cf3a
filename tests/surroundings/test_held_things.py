"""Which things count as held."""

import numpy as np

from latentarm.core.types import GripperReading, Pose
from latentarm.robots.kinematics.obstacles import Box
from latentarm.robots.scene.thing import Part, Thing
from latentarm.surroundings.held_things import HeldThings

OPEN, HOLDS = GripperReading(0.08), GripperReading(0.05, holding=True)
STOOD = Pose(np.zeros(3), np.eye(3))
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
CUP = Thing("cup", (Part("cylinder", (0.03, 0.05), (0.0, 0.0, 0.05)),), 0.2, STOOD)
MUG = Box("mug", np.zeros(3), np.eye(3), np.full(3, 0.05))


def names(held):
    return [box.name for box in held.now]


def test_a_known_thing_counts_from_the_grasp_to_the_release_where_it_was_taken():
    held = HeldThings([CUP], ())
    assert not held.update({}, OPEN)
    assert held.update({"cup": Pose(np.array([0.1, 0.0, 0.0]), TURN), "bowl": STOOD}, HOLDS)
    (cup,) = held.now
    np.testing.assert_allclose(cup.centre, [0.1, 0.0, 0.05])
    np.testing.assert_allclose(cup.half_extents, [0.03, 0.03, 0.05])
    assert not held.update({}, HOLDS)  # the fingers lose contact for a moment
    assert not held.update({"cup": STOOD}, HOLDS)
    assert held.now[0] is cup
    assert held.update({}, OPEN)
    assert held.now == ()


def test_food_on_a_fork_counts_without_a_gripper():
    held = HeldThings([CUP], ())
    assert held.update({"cup": STOOD}, None)
    assert names(held) == ["cup"]
    assert held.update({}, None)


def test_what_a_person_says_of_the_gripper_stands_for_unknown_things():
    held = HeldThings([CUP], (MUG,))
    assert not held.update({}, OPEN)
    assert held.update({}, HOLDS)
    assert held.now == (MUG,)
    assert held.update({"cup": STOOD}, HOLDS)
    assert names(held) == ["cup"]
    assert held.update({}, OPEN)
    assert held.now == ()
