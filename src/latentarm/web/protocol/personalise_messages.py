"""Messages between pages and the server about a person's alignment: asking, trying, keeping."""

from typing import Annotated, Final, Literal

from pydantic import Field

from latentarm.alignment.contract import Seat
from latentarm.web.protocol.notice import Message, Notice
from latentarm.web.protocol.orders import Deflection
from latentarm.web.protocol.report import Point

MOST_QUESTIONS: Final = 30

# ``refused``: what was learned is no better than before, and is gone; ``why`` says how it was judged
PersonalisePhase = Literal[
    "preparing", "asking", "thinking", "learning", "learned", "refused", "kept", "failed"
]
QuestionId = Annotated[int, Field(ge=0, le=2**31)]


class BeginPersonalise(Message):
    """Ask a person what they mean by their stick; from the page that drives, while the arm is not enabled."""

    type: Literal["personalise"]
    name: Annotated[str, Field(max_length=200)]
    questions: Annotated[int, Field(ge=1, le=MOST_QUESTIONS)]  # maximum number of answers
    seat: Seat | None = None  # where the person sits, as in `ChooseProfile`


class AnswerQuestion(Message):
    """The input with which the person would ask for the shown motion; from the page that drives."""

    type: Literal["answer"]
    question: QuestionId  # of `Personalise`; an answer to another one is ignored
    # entries in [-1, 1], right and up positive; axes that are not named are zero
    u: Annotated[tuple[Deflection, ...], Field(min_length=1, max_length=8)]


class LeaveQuestion(Message):
    """Skip the question, or go back to the previous one; from the page that drives."""

    type: Literal["skip_question", "question_before"]
    question: QuestionId


class PressPersonalise(Message):
    """A press on the Personalise page; from the page that drives.

    ``cancel_personalise`` stops asking, and discards the answers. ``try_alignment`` tries the new alignment,
    while the arm is not enabled; ``keep_alignment`` keeps it under the person's name; ``discard_alignment``
    discards it, and the person drives as before.
    """

    type: Literal["cancel_personalise", "try_alignment", "keep_alignment", "discard_alignment"]


QuestionReply = AnswerQuestion | LeaveQuestion
PersonaliseMessage = BeginPersonalise | QuestionReply | PressPersonalise


class ShownMotion(Message):
    """A motion that a person is asked about."""

    duration_s: float
    # the poses of all bodies along it, each as in `State`, evenly in time
    frames: tuple[tuple[tuple[float, ...], ...], ...]
    tools: tuple[tuple[Point, ...], ...]  # the paths of the tools that move, m


class Personalise(Message):
    """Progress of a person's alignment."""

    phase: PersonalisePhase  # ``thinking`` is between two questions
    name: str
    question: int = 0  # number for answers to name
    number: int = 0  # answers so far, including this one
    of: int = 0  # maximum number of answers
    back: bool = False
    motion: ShownMotion | None = None  # the motion asked about, or null
    share: float = 0.0  # progress of the thinking or learning, from 0 to 1
    answers: int = 0  # how many it was learned from
    # relative alignment error about each answer, as learned from the others
    error: float | None = None
    error_without: float | None = None  # the same with the directions of before
    why: Notice | None = None
