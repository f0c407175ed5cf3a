"""The simulated people by name."""

from typing import Final

from latentarm_research.people.linear_guess import LinearGuessConfig
from latentarm_research.people.motor_noise import REACTION_S, UNSTEADY, HandConfig
from latentarm_research.people.names import OperatorName
from latentarm_research.people.own_directions import OwnSpeed
from latentarm_research.people.page_rates import SLOW
from latentarm_research.people.person import Person
from latentarm_research.people.planning import PlanningConfig
from latentarm_research.people.ring_reading import RingReadingConfig

PEOPLE: Final[dict[OperatorName, Person]] = {
    "greedy": Person(),
    "learning": Person(imagines=LinearGuessConfig(), speed=OwnSpeed(SLOW)),
    "reading": Person(
        imagines=RingReadingConfig(), hand=HandConfig(reaction_s=REACTION_S), speed=OwnSpeed(SLOW)
    ),
    "unsteady": Person(hand=UNSTEADY),
    "planning": Person(plans=PlanningConfig()),
}
"""``greedy`` knows exactly what each input does and looks one step ahead (equation 24). ``learning`` decides
alike, but has only a linear guess of that, learned while driving. ``reading`` knows no more at first, and
reads it off the ring that the page draws, late and with errors. Both are new, so the page lets them go half
as fast. ``unsteady`` is greedy with a reaction time
and tremor. ``planning`` is greedy and plans up to 4 s ahead where one step leads no nearer."""


def usual_operator(task: str) -> OperatorName:
    """The operator for a task where none is named.

    Along held-out episodes the greedy operator ends in local dead ends after a few waypoints, whatever the
    model can do, so there the operator plans. Elsewhere it is the paper's.
    """
    return "planning" if task == "held_out" else "greedy"
