"""The person that `latentarm align` asks: at the terminal, or simulated."""

from collections.abc import Callable
from typing import Final, final

import numpy as np

from latentarm.errors import UserError
from latentarm.operators.preference import Preference
from latentarm.runs.person import Kind, Person, Question, Say
from latentarm.simulation.motion_text import draw, moved, said
from latentarm.simulation.stick_line import parse
from latentarm.types import FloatArray

FASTEST: Final = 0.99
"""Share of the motions that the simulated person can ask for without pushing beyond 1."""


@final
class SimulatedPerson(Person):
    """Answers by a stated preference, and says so.

    Args:
        preference: what they mean.
        say: shows a line.
    """

    def __init__(self, preference: Preference, say: Say) -> None:
        self._preference = preference
        self._say = say

    @property
    def kind(self) -> Kind:
        """``simulated person``."""
        return "simulated person"

    def answer(self, question: Question) -> FloatArray:
        """What the preference makes of the motion."""
        u = self._preference.inputs(question.motion)[0]
        self._say(
            f"Question {question.number} of at most {question.total}: "
            f"{'; '.join(said(*tool) for tool in moved(question.chain, question.motion))}. "
            f"The simulated person answers ({', '.join(f'{value:+.2f}' for value in u)})."
        )
        return u


@final
class PersonAtTerminal(Person):
    """Is shown each motion as numbers and as a small figure, and answers with a line or the arrow keys.

    Args:
        say: shows text.
        read: the next line, as `parse` takes it.
    """

    def __init__(self, say: Say, read: Callable[[int], str]) -> None:
        self._say = say
        self._read = read

    @property
    def kind(self) -> Kind:
        """``person``."""
        return "person"

    def answer(self, question: Question) -> FloatArray | None:
        """Ask until the answer is one.

        Raises:
            UserError: the input has ended.
        """
        tools = moved(question.chain, question.motion)
        self._say(
            f"\nQuestion {question.number} of at most {question.total}, {question.motion.duration_s:g} s:"
        )
        for tool in tools:
            self._say(f"  {said(*tool)}.")
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
