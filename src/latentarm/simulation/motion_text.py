"""A motion in words and as a small figure of letters, for a terminal."""

from typing import Final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.kinematics.chain import Chain
from latentarm.kinematics.rotations import rotation_vector
from latentarm.types import Pose

CELLS: Final = 4
"""Cells of the figure from its middle to each edge."""

STILL_M: Final = 5e-4
STILL_DEG: Final = 0.5
"""Less than this is rounded to nothing."""


def moved(chain: Chain, motion: Motions) -> list[tuple[str, Pose, Pose]]:
    """Name and poses, before and after, of every tool that moves; of the first where none does."""
    tools = [
        (frame.name, chain.forward(motion.start[0], tool), chain.forward(motion.end[0], tool))
        for tool, frame in enumerate(chain.tools)
    ]
    return [tool for tool in tools if _moves(tool[1], tool[2])] or tools[:1]


def said(name: str, before: Pose, after: Pose) -> str:
    """A tool's motion in words: mm along the axes of the base frame, degrees about which axis of it."""
    x, y, z = 1000 * (after.position - before.position)
    turn = rotation_vector(after.rotation @ before.rotation.T)
    angle = float(np.linalg.norm(turn))
    words = f"{name} moves x {x:+.0f}, y {y:+.0f}, z {z:+.0f} mm"
    if np.rad2deg(angle) < STILL_DEG:
        return f"{words} and does not turn"
    axis = ", ".join(f"{value:+.1f}" for value in turn / angle)
    return f"{words} and turns by {np.rad2deg(angle):.0f}° about ({axis})"


def draw(before: Pose, after: Pose, reach_m: float) -> str:
    """A tool's path from above, and its height: from o to *.

    Args:
        before: where it starts, in the middle of the figure.
        after: where it ends.
        reach_m: distance from the figure's middle to its edge, m.

    Returns:
        Lines of ASCII.
    """
    step = (after.position - before.position) / max(reach_m, STILL_M) * CELLS
    size = 2 * CELLS + 1
    above = [["."] * size for _ in range(size)]
    height = ["."] * size
    # As seen from behind the arm: up is away from the base (x), left is y.
    for share in np.linspace(0, 1, 4 * size):
        x, y, z = (int(np.clip(np.rint(value), -CELLS, CELLS)) for value in share * step)
        above[CELLS - x][CELLS - y] = height[CELLS - z] = "+"
    x, y, z = (int(np.clip(np.rint(value), -CELLS, CELLS)) for value in step)
    above[CELLS][CELLS] = height[CELLS] = "o"
    above[CELLS - x][CELLS - y] = height[CELLS - z] = "*"
    lines = [f"    {' '.join(row)}      {mark}" for row, mark in zip(above, height, strict=True)]
    return "\n".join(["    from above             height", *lines, "    (up is x, left is y)   (up is z)"])


def _moves(before: Pose, after: Pose) -> bool:
    turn = np.linalg.norm(rotation_vector(after.rotation @ before.rotation.T))
    way = np.linalg.norm(after.position - before.position)
    return bool(way > STILL_M or np.rad2deg(turn) > STILL_DEG)
