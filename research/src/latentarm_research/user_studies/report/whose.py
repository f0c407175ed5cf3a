"""What a report says of the people: simulated ones, of whom nobody was asked, or real ones."""

from dataclasses import dataclass
from typing import Final, final


@final
@dataclass(frozen=True)
class PeopleWords:
    """People in words."""

    notice: str  # over everything
    unasked: str  # of a questionnaire without answers


SIMULATED: Final = PeopleWords(
    notice="Everything here is simulated: the arm, the things, the demonstrator and the people who drive. No"
    " person took part.",
    unasked="Simulated people have no opinions: nobody was asked, and every claim about ratings could not be"
    " tested.",
)

REAL: Final = PeopleWords(
    notice="The trials are those of real people.",
    unasked="No answers were given to this analysis: every claim about ratings could not be tested.",
)

QUOTED: Final = "Figures of the paper are quoted as the paper's and come from the paper's own people."
