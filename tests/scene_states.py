"""How things stand at one moment, made by hand, for tests without physics."""

import numpy as np

from latentarm.core.types import Pose
from latentarm.robots.scene.scene import SceneState

UPRIGHT = np.eye(3)


def at(x=0.0, y=0.0, z=0.0, rotation=UPRIGHT):
    return Pose(np.array([x, y, z], dtype=float), rotation)


def standing(time_s=0.0, tool=None, **changes):
    """A state of one cup at the origin, with the tool there too; a thing that is placed rests."""
    poses = {"cup": at(), **changes.pop("poses", {})}
    whole = {
        "time_s": time_s,
        "tool": tool or at(),
        "poses": poses,
        "speed_m_s": dict.fromkeys(poses, 0.0) | changes.pop("speed_m_s", {}),
        "stabbed": frozenset(),
        "gripped": frozenset(),
        "bonds": frozenset(),
        "grains": {},
        "force_n": {},
    }
    return SceneState(**(whole | changes))
