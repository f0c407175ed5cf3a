"""The Panda as it is drawn: smooth links in white and grey, each the hull of discs. Nothing collides."""

from collections.abc import Mapping
from typing import Final

import mujoco
import numpy as np

from latentarm.core.types import FloatArray

VISUAL_GROUP: Final = 2
SHELL_GROUP: Final = 3  # not drawn by MuJoCo's viewers, nor by the page

_CORNERS: Final = 20  # of a disc
_WHITE: Final = (0.95, 0.95, 0.96, 1.0)
_GREY: Final = (0.27, 0.29, 0.31, 1.0)

_AXES: Final = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}

Disc = tuple[float, float, float, str, float]
"""Its middle in the body's frame, m, the axis that it faces, and its radius, m."""

_HULLS: Final[tuple[tuple[str, tuple[float, ...], tuple[Disc, ...]], ...]] = (
    (
        "link0",
        _WHITE,
        (
            (-0.045, 0.0, 0.0, "z", 0.09),
            (-0.02, 0.0, 0.05, "z", 0.085),
            (0.0, 0.0, 0.11, "z", 0.06),
            (0.0, 0.0, 0.0, "z", 0.085),
        ),
    ),
    ("link0", _GREY, ((0.0, 0.0, 0.1, "z", 0.056), (0.0, 0.0, 0.145, "z", 0.056))),
    (
        "link1",
        _WHITE,
        (
            (0.0, 0.0, -0.19, "z", 0.055),
            (0.0, 0.0, -0.17, "z", 0.06),
            (0.0, -0.055, 0.0, "y", 0.055),
            (0.0, 0.045, 0.0, "y", 0.055),
        ),
    ),
    (
        "link2",
        _WHITE,
        (
            (0.0, 0.0, -0.055, "z", 0.057),
            (0.0, 0.0, 0.06, "z", 0.057),
            (0.0, -0.105, 0.0, "y", 0.058),
            (0.0, -0.125, 0.0, "y", 0.052),
        ),
    ),
    ("link2", _GREY, ((0.0, 0.0, -0.062, "z", 0.046), (0.0, 0.0, 0.067, "z", 0.046))),
    (
        "link3",
        _WHITE,
        (
            (0.0, 0.0, -0.185, "z", 0.052),
            (0.0, 0.0, -0.165, "z", 0.058),
            (0.0, 0.0, -0.09, "z", 0.058),
            (0.0825, -0.05, 0.0, "y", 0.05),
            (0.0825, 0.05, 0.0, "y", 0.05),
        ),
    ),
    (
        "link4",
        _WHITE,
        (
            (0.0, 0.0, -0.052, "z", 0.053),
            (0.0, 0.0, 0.052, "z", 0.053),
            (-0.0825, 0.08, 0.0, "y", 0.058),
            (-0.0825, 0.1, 0.0, "y", 0.052),
        ),
    ),
    ("link4", _GREY, ((0.0, 0.0, -0.059, "z", 0.043), (0.0, 0.0, 0.059, "z", 0.043))),
    (
        "link5",
        _WHITE,
        (
            (0.0, 0.0, -0.278, "z", 0.052),
            (0.0, 0.0, -0.258, "z", 0.057),
            (0.0, 0.01, -0.2, "z", 0.055),
            (0.0, 0.075, -0.1, "z", 0.04),
        ),
    ),
    (
        "link5",
        _WHITE,
        (
            (0.0, 0.04, -0.14, "z", 0.04),
            (0.0, 0.075, -0.1, "z", 0.04),
            (0.0, 0.06, 0.0, "y", 0.05),
            (0.0, 0.105, 0.0, "y", 0.045),
        ),
    ),
    ("link5", _GREY, ((0.0, 0.05, 0.0, "y", 0.043), (0.0, 0.111, 0.0, "y", 0.036))),
    (
        "link6",
        _WHITE,
        (
            (0.0, 0.0, -0.05, "z", 0.05),
            (0.0, 0.0, 0.03, "z", 0.05),
            (0.088, -0.02, 0.0, "y", 0.05),
            (0.088, 0.045, 0.0, "y", 0.047),
        ),
    ),
    ("link7", _GREY, ((0.0, 0.0, 0.015, "z", 0.045), (0.0, 0.0, 0.06, "z", 0.045))),
    (
        "link7",
        _WHITE,
        ((0.0, 0.0, 0.05, "z", 0.051), (0.0, 0.0, 0.09, "z", 0.051), (0.045, 0.045, 0.085, "z", 0.026)),
    ),
    ("link7", _GREY, ((0.0, 0.0, 0.09, "z", 0.042), (0.0, 0.0, 0.107, "z", 0.042))),
    (
        "hand",
        _WHITE,
        (
            (0.0, -0.068, 0.012, "y", 0.012),
            (0.0, 0.068, 0.012, "y", 0.012),
            (0.0, -0.07, 0.03, "z", 0.03),
            (0.0, 0.07, 0.03, "z", 0.03),
            (0.0, -0.075, 0.05, "z", 0.025),
            (0.0, 0.075, 0.05, "z", 0.025),
        ),
    ),
    ("hand", _GREY, ((0.0, -0.075, 0.045, "z", 0.021), (0.0, 0.075, 0.064, "z", 0.021))),
)


def add_look(spec: mujoco.MjSpec, bodies: Mapping[str, mujoco.MjsBody]) -> None:
    """Give the bodies of a Panda what is seen of them."""
    for number, (body, colour, discs) in enumerate(_HULLS):
        mesh = spec.add_mesh(name=f"look{number}")
        mesh.uservert = np.concatenate([_edge(*disc) for disc in discs]).ravel()
        bodies[body].add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=mesh.name,
            rgba=colour,
            group=VISUAL_GROUP,
            contype=0,
            conaffinity=0,
        )


def _edge(x: float, y: float, z: float, axis: str, radius: float) -> FloatArray:
    """Corners of a disc (K, 3), m."""
    turn = np.linspace(0.0, 2.0 * np.pi, _CORNERS, endpoint=False)
    across, along, _ = _AXES[axis]
    corners = np.tile([x, y, z], (_CORNERS, 1))
    corners[:, across] += radius * np.cos(turn)
    corners[:, along] += radius * np.sin(turn)
    return corners
