"""A person shows where things are with the tool, and the tool carries them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from latentarm.core.types import GripperReading, Pose
from latentarm.robots.scene.thing import Food, Part, Thing
from latentarm.surroundings.surroundings import Surroundings

OPEN, HOLDS = GripperReading(0.08), GripperReading(0.05, holding=True)
CUP = Thing(
    "cup", (Part("cylinder", (0.03, 0.04), (0.0, 0.0, 0.04)),), 0.1, Pose(np.array([0, 0, 0.28]), np.eye(3))
)


def over(x, y, z=0.34):
    """A tool that points down, over a place."""
    return Pose(np.array([x, y, z]), Rotation.from_euler("x", np.pi).as_matrix())


def room_of(*things):
    return Surroundings(things, stand=True, sightings=None)


@given(
    st.floats(0.3, 0.7), st.floats(-0.3, 0.3), st.floats(0.0, 0.5), st.floats(-3.1, 3.1), st.floats(0.04, 0.2)
)
def test_a_thing_stands_below_the_tool_and_faces_its_front(x, y, z, heading_rad, away_m):
    room = room_of(CUP)
    room.update(over(x, y, z), OPEN, 0.0)
    assert room.touch("cup", "place", 0.0)
    pose = room.tracker.look("cup", 1.0).pose
    np.testing.assert_allclose(pose.position, [x, y, 0.28])
    front = over(x + away_m * np.cos(heading_rad), y + away_m * np.sin(heading_rad))
    room.update(front, OPEN, 1.0)
    assert room.touch("cup", "front", 1.0)
    turned = room.tracker.look("cup", 2.0).pose
    np.testing.assert_allclose(turned.position, pose.position)
    np.testing.assert_allclose(
        turned.rotation[:, 0], [np.cos(heading_rad), np.sin(heading_rad), 0.0], atol=1e-9
    )
    assert room.touch("cup", "undo", 2.0)
    np.testing.assert_allclose(room.tracker.look("cup", 2.0).pose.rotation, pose.rotation)


def test_a_front_at_the_middle_and_a_thing_that_is_not_there_are_refused():
    room = room_of(CUP)
    assert not room.touch("cup", "place", 0.0)  # nobody knows where the tool is
    room.update(over(0.5, 0.0), OPEN, 0.0)
    assert not room.touch("cup", "front", 0.0)
    assert room.touch("cup", "place", 0.0)
    assert not room.touch("cup", "front", 0.0)
    assert not room.touch("spoon", "place", 0.0)


def test_a_cup_in_the_fingers_moves_with_them_and_stays_where_it_is_let_go():
    room = room_of(CUP)
    room.update(over(0.5, 0.1), OPEN, 0.0)
    room.touch("cup", "place", 0.0)
    room.update(over(0.5, 0.1), HOLDS, 0.1)
    room.update(over(0.6, -0.1, 0.5), HOLDS, 1.0)
    carried = room.tracker.look("cup", 1.0)
    assert carried.seen == "carried"
    np.testing.assert_allclose(carried.pose.position, [0.6, -0.1, 0.44])
    for now_s in (1.1, 1.2, 1.5, 1.6):
        room.update(over(0.6, -0.1, 0.34), OPEN, now_s)
    room.update(over(0.3, 0.3), OPEN, 2.0)
    here = room.tracker.look("cup", 2.0)
    assert here.seen == "seen"
    np.testing.assert_allclose(here.pose.position, [0.6, -0.1, 0.28])


def test_fingers_that_close_elsewhere_take_nothing_along():
    room = room_of(CUP)
    room.update(over(0.5, 0.1), OPEN, 0.0)
    room.touch("cup", "place", 0.0)
    room.update(over(0.4, -0.2), HOLDS, 0.1)
    room.update(over(0.6, -0.2), HOLDS, 0.2)
    np.testing.assert_allclose(room.tracker.look("cup", 0.2).pose.position[:2], [0.5, 0.1])


def test_food_that_a_fork_enters_comes_along():
    soft = (Part("cylinder", (0.014, 0.014)),)
    food = Thing("food", soft, 0.01, Pose(np.array([0, 0, 0.07]), np.eye(3)), food=Food(1.0, 0.01, 4.0))
    room = room_of(food)
    room.update(over(0.5, 0.0), None, 0.0)
    room.touch("food", "place", 0.0)
    room.update(over(0.5, 0.0, 0.1), None, 0.1)
    assert room.tracker.look("food", 0.1).seen == "seen"
    room.update(over(0.5, 0.0, 0.075), None, 0.2)
    room.update(over(0.5, 0.1, 0.2), None, 0.3)
    np.testing.assert_allclose(room.tracker.look("food", 0.3).pose.position, [0.5, 0.1, 0.195])
