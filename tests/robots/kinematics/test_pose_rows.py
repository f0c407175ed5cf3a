"""Poses of things as rows of numbers."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.types import Pose
from latentarm.robots.kinematics.pose_rows import moved_along, pose_rows


def random_poses(rng, *lead):
    turns = np.linalg.qr(rng.normal(size=(*lead, 3, 3)))[0]
    turns[..., 0] *= np.linalg.det(turns)[..., None]
    return Pose(rng.normal(size=(*lead, 3)), turns)


def seen_by(tool, thing):
    """A thing's pose in the tool's frame."""
    to_tool = tool.rotation.mT
    return (to_tool @ (thing.position - tool.position)[..., None])[..., 0], to_tool @ thing.rotation


@given(seed=st.integers(0, 2**32 - 1))
def test_what_a_tool_takes_along_stays_where_it_is_in_the_tool(seed):
    rng = np.random.default_rng(seed)
    things, before, after = random_poses(rng, 4), random_poses(rng), random_poses(rng, 5)
    moved = moved_along(pose_rows(things), before, after)
    assert moved.shape == (5, 4, 9)
    for index in range(4):
        thing = Pose(things.position[index], things.rotation[index])
        first, second = np.moveaxis(moved[:, index, 3:].reshape(5, 3, 2), -1, 0)
        turned = np.stack([first, second, np.cross(first, second)], axis=-1)
        there = Pose(moved[:, index, :3], turned)
        for now, then in zip(seen_by(after, there), seen_by(before, thing), strict=True):
            np.testing.assert_allclose(now, np.broadcast_to(then, now.shape), atol=1e-12)
