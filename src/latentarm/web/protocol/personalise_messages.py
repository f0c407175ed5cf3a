"""Messages between pages and the server about a person's alignment: asking, trying, keeping."""

from typing import Annotated, Final, Literal, final

from pydantic import Field

from latentarm.web.protocol.notice import Message, Notice
from latentarm.web.protocol.report import Point

MOST_QUESTIONS: Final = 30

PersonalisePhase = Literal["preparing", "asking", "thinking", "learning", "learned", "kept", "failed"]
QuestionId = Annotated[int, Field(ge=0, le=2**31)]
Deflection = Annotated[float, Field(ge=-1.0, le=1.0)]


@final
class BeginPersonalise(Message):
    """Ask a person what they mean by their stick; from the page that drives, while the arm is not enabled.

    Attributes:
        questions: maximum number of answers.
    """

    type: Literal["personalise"]
    name: Annotated[str, Field(max_length=200)]
    questions: Annotated[int, Field(ge=1, le=MOST_QUESTIONS)]


@final
class AnswerQuestion(Message):
    """The input with which the person would ask for the shown motion; from the page that drives.

    Attributes:
        question: of `Personalise`; an answer to another one is ignored.
        u: entries in [-1, 1], right and up positive; axes that are not named are zero.
    """

    type: Literal["answer"]
    question: QuestionId
    u: Annotated[tuple[Deflection, ...], Field(min_length=1, max_length=8)]


@final
class SkipQuestion(Message):
    """Skip the question; from the page that drives."""

    type: Literal["skip_question"]
    question: QuestionId


@final
class QuestionBefore(Message):
    """Go back to the previous question; from the page that drives."""

    type: Literal["question_before"]
    question: QuestionId


@final
class CancelPersonalise(Message):
    """Stop asking, and discard the answers; from the page that drives."""

    type: Literal["cancel_personalise"]


@final
class TryAlignment(Message):
    """Try the new alignment; from the page that drives, while the arm is not enabled."""

    type: Literal["try_alignment"]


@final
class KeepAlignment(Message):
    """Keep the new alignment under the person's name; from the page that drives."""

    type: Literal["keep_alignment"]


@final
class DiscardAlignment(Message):
    """Discard the new alignment, and drive as before; from the page that drives."""

    type: Literal["discard_alignment"]


PersonaliseMessage = (
    BeginPersonalise
    | AnswerQuestion
    | SkipQuestion
    | QuestionBefore
    | CancelPersonalise
    | TryAlignment
    | KeepAlignment
    | DiscardAlignment
)


@final
class ShownMotion(Message):
    """A motion that a person is asked about.

    Attributes:
        frames: the poses of all bodies along it, each as in `State`, evenly in time.
        tools: the paths of the tools that move, m.
    """

    duration_s: float
    frames: tuple[tuple[tuple[float, ...], ...], ...]
    tools: tuple[tuple[Point, ...], ...]


@final
class Personalise(Message):
    """Progress of a person's alignment.

    Attributes:
        phase: ``thinking`` is between two questions.
        question: number for answers to name.
        number: answers so far, including this one.
        of: maximum number of answers.
        motion: the motion asked about, or null.
        share: progress of the thinking or learning, from 0 to 1.
        answers: how many it was learned from.
        error: relative alignment error about the answers themselves, as learned.
        error_without: the same with z = u.
    """

    phase: PersonalisePhase
    name: str
    question: int = 0
    number: int = 0
    of: int = 0
    back: bool = False
    motion: ShownMotion | None = None
    share: float = 0.0
    answers: int = 0
    error: float | None = None
    error_without: float | None = None
    why: Notice | None = None
