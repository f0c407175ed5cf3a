"""The person that `latentarm align` asks: at the terminal, or simulated."""

from collections.abc import Callable
from typing import ClassVar, Final, final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.alignment.preference import Preference
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.rotations import rotation_vector
from latentarm.runs.person import Kind, Question, Respondent, Say
from latentarm.runs.stick_line import parse

CELLS: Final = 4  # cells of the figure from its middle to each edge
STILL_M: Final = 5e-4
STILL_DEG: Final = 0.5  # smaller motions count as none


def moved(chain: Chain, motion: Motions) -> list[tuple[str, Pose, Pose]]:
    """Name and poses, before and after, of every tool that moves; of the first where none does."""
    tools = [
        (frame.name, chain.forward(motion.start[0], tool), chain.forward(motion.end[0], tool))
        for tool, frame in enumerate(chain.tools)
    ]
    return [tool for tool in tools if _moves(tool[1], tool[2])] or tools[:1]


def describe(name: str, before: Pose, after: Pose) -> str:
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
    """A tool's path from above, and its height, from o to * in lines of ASCII.

    The path starts in the middle of the figure, whose edges are ``reach_m`` away.
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


FASTEST: Final = 0.99  # share of the motions that the simulated person can ask for without pushing beyond 1


@final
class SimulatedRespondent(Respondent):
    """Answers by a stated preference, and prints that."""

    kind: ClassVar[Kind] = "simulated person"

    def __init__(self, preference: Preference, say: Say) -> None:
        self._preference, self._say = preference, say

    def answer(self, question: Question) -> FloatArray:
        """The preference's input for the motion."""
        u = self._preference.inputs(question.motion)[0]
        self._say(
            f"Question {question.number} of at most {question.total}: "
            f"{'; '.join(describe(*tool) for tool in moved(question.chain, question.motion))}. "
            f"The simulated person answers ({', '.join(f'{value:+.2f}' for value in u)})."
        )
        return u


@final
class PersonAtTerminal(Respondent):
    """Sees each motion as numbers and as a small figure, and answers with a line or the arrow keys."""

    kind: ClassVar[Kind] = "person"

    def __init__(self, say: Say, read: Callable[[int], str]) -> None:
        self._say, self._read = say, read

    def answer(self, question: Question) -> FloatArray | None:
        """Ask until the answer is valid; UserError where the input has ended."""
        tools = moved(question.chain, question.motion)
        self._say(
            f"\nQuestion {question.number} of at most {question.total}, {question.motion.duration_s:g} s:"
        )
        for tool in tools:
            self._say(f"  {describe(*tool)}.")
        farthest = max(tools, key=lambda tool: float(np.linalg.norm(tool[2].position - tool[1].position)))
        self._say(draw(farthest[1], farthest[2], question.reach_m))
        self._say(f"How would you push for this? {_way(question.axes)} Enter alone skips.")
        while True:
            try:
                return parse(self._read(question.axes), question.axes)
            except EOFError as error:
                raise UserError("The input has ended before all questions were answered.") from error
            except ValueError as error:
                self._say(f"  {error} Once more:")


def _way(axes: int) -> str:
    numbers = "One number" if axes == 1 else f"{axes} numbers"
    keys = ", or arrow keys and Enter." if axes <= 2 else "."
    return f"{numbers} from -1 to 1{keys}"
