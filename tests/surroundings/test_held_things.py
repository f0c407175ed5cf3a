"""Which things count as held."""

from dataclasses import replace

import numpy as np

from latentarm.core.types import GripperReading, Pose
from latentarm.robots.held import Held
from latentarm.robots.kinematics.obstacles import Box
from latentarm.robots.scene.thing import Part, Thing
from latentarm.surroundings.held_things import HeldThings

OPEN, HOLDS = GripperReading(0.08), GripperReading(0.05, holding=True)
STOOD = Pose(np.zeros(3), np.eye(3))
TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
CUP = Thing("cup", (Part("cylinder", (0.03, 0.05), (0.0, 0.0, 0.05)),), 0.2, STOOD)
BOX = Box("spoon", np.zeros(3), np.eye(3), np.full(3, 0.1))


def names(held):
    return [one.box.name for one in held.now]


def test_a_known_thing_counts_from_the_grasp_to_the_release_where_it_was_taken():
    held = HeldThings([CUP], [])
    assert not held.update({}, OPEN)
    assert held.update({"cup": Pose(np.array([0.1, 0.0, 0.0]), TURN), "bowl": STOOD}, HOLDS)
    (cup,) = held.now
    np.testing.assert_allclose(cup.box.centre, [0.1, 0.0, 0.05])
    np.testing.assert_allclose(cup.box.half_extents, [0.03, 0.03, 0.05])
    assert cup.mass_kg == 0.2
    assert not held.update({}, HOLDS)  # the fingers lose contact for a moment
    assert not held.update({"cup": STOOD}, HOLDS)
    assert held.now == (cup,)
    assert held.update({}, OPEN)
    assert held.now == ()


def test_food_on_a_fork_counts_without_a_gripper():
    held = HeldThings([CUP], [])
    assert held.update({"cup": STOOD}, None)
    assert names(held) == ["cup"]
    assert held.update({}, None)


def test_what_is_mounted_counts_always_and_what_is_said_of_the_gripper_for_unknown_things():
    mounted, said = Held(BOX, 0.05, mounted=True), Held(replace(BOX, name="mug"), 0.3)
    held = HeldThings([CUP], [said, mounted])
    assert held.update({}, OPEN)
    assert held.now == (mounted,)
    assert held.update({}, HOLDS)
    assert held.now == (mounted, said)
    assert held.update({"cup": STOOD}, HOLDS)
    assert names(held) == ["spoon", "cup"]
    assert held.update({}, OPEN)
    assert held.now == (mounted,)
