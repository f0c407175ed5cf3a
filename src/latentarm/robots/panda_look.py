"""The Panda as it is drawn: smooth links in white and grey, each the hull of discs. Nothing collides."""

from collections.abc import Mapping
from typing import Final

import mujoco
import numpy as np

from latentarm.core.types import FloatArray

VISUAL_GROUP: Final = 2
SHELL_GROUP: Final = 3  # not drawn by MuJoCo's viewers, nor by the page

_CORNERS: Final = 20  # of a disc
_COLOURS: Final = {"white": (0.95, 0.95, 0.96, 1.0), "grey": (0.27, 0.29, 0.31, 1.0)}
_ACROSS: Final = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}  # the axes that lie in a disc

# A hull per line: its body, its colour, and its discs. Of each disc its middle in the body's frame, mm, the
# axis that it faces, and its radius, mm.
_HULLS: Final = """
link0 white  -45 0 0 z 90, -20 0 50 z 85, 0 0 110 z 60, 0 0 0 z 85
link0 grey   0 0 100 z 56, 0 0 145 z 56
link1 white  0 0 -190 z 55, 0 0 -170 z 60, 0 -55 0 y 55, 0 45 0 y 55
link2 white  0 0 -55 z 57, 0 0 60 z 57, 0 -105 0 y 58, 0 -125 0 y 52
link2 grey   0 0 -62 z 46, 0 0 67 z 46
link3 white  0 0 -185 z 52, 0 0 -165 z 58, 0 0 -90 z 58, 82.5 -50 0 y 50, 82.5 50 0 y 50
link4 white  0 0 -52 z 53, 0 0 52 z 53, -82.5 80 0 y 58, -82.5 100 0 y 52
link4 grey   0 0 -59 z 43, 0 0 59 z 43
link5 white  0 0 -278 z 52, 0 0 -258 z 57, 0 10 -200 z 55, 0 75 -100 z 40
link5 white  0 40 -140 z 40, 0 75 -100 z 40, 0 60 0 y 50, 0 105 0 y 45
link5 grey   0 50 0 y 43, 0 111 0 y 36
link6 white  0 0 -50 z 50, 0 0 30 z 50, 88 -20 0 y 50, 88 45 0 y 47
link7 grey   0 0 15 z 45, 0 0 60 z 45
link7 white  0 0 50 z 51, 0 0 90 z 51, 45 45 85 z 26
link7 grey   0 0 90 z 42, 0 0 107 z 42
hand  white  0 -68 12 y 12, 0 68 12 y 12, 0 -70 30 z 30, 0 70 30 z 30, 0 -75 50 z 25, 0 75 50 z 25
hand  grey   0 -75 45 z 21, 0 75 64 z 21
"""


def add_look(spec: mujoco.MjSpec, bodies: Mapping[str, mujoco.MjsBody]) -> None:
    """Give the bodies of a Panda what is seen of them."""
    for number, hull in enumerate(_HULLS.strip().splitlines()):
        body, colour, discs = hull.split(maxsplit=2)
        mesh = spec.add_mesh(name=f"look{number}")
        mesh.uservert = np.concatenate([_edge(*disc.split()) for disc in discs.split(",")]).ravel()
        bodies[body].add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=mesh.name,
            rgba=_COLOURS[colour],
            group=VISUAL_GROUP,
            contype=0,
            conaffinity=0,
        )


def _edge(x: str, y: str, z: str, axis: str, radius: str) -> FloatArray:
    """Corners of a disc (K, 3), m."""
    turn = np.linspace(0.0, 2.0 * np.pi, _CORNERS, endpoint=False)
    across, along = _ACROSS[axis]
    corners = np.tile([float(x) / 1000, float(y) / 1000, float(z) / 1000], (_CORNERS, 1))
    corners[:, across] += float(radius) / 1000 * np.cos(turn)
    corners[:, along] += float(radius) / 1000 * np.sin(turn)
    return corners
