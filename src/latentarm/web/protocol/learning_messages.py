"""Messages between pages and the server about runs: training and choosing them."""

from typing import Annotated, Literal

from pydantic import Field

from latentarm.web.protocol.notice import Message, Notice
from latentarm.web.protocol.personalise_messages import Personalise

RunName = Annotated[str, Field(min_length=1, max_length=80)]
ModelName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,39}$")]
TrainingPhase = Literal["exporting", "training", "done", "failed", "cancelled"]


class ChosenEpisode(Message):
    """An episode of `LearningState.recordings`."""

    file: Annotated[str, Field(max_length=255)]
    episode: Annotated[int, Field(ge=1, le=2**31)]


class Train(Message):
    """Train a model on recorded episodes; from the page that drives."""

    type: Literal["train"]
    name: Annotated[str, Field(max_length=200)]  # of the new run, and of its dataset
    model: ModelName  # a kind of latent action model
    latent_dim: Literal[1, 2]  # d, axes of the latent actions
    episodes: Annotated[tuple[ChosenEpisode, ...], Field(max_length=300)]


class PickRun(Message):
    """Drive another run of `LearningState.runs`; from the page that drives, while the arm is not enabled."""

    type: Literal["run"]
    run: RunName


class Recorded(Message):
    """A complete episode of this or an earlier start of the server."""

    number: int  # by which people call it: it counts all that are kept, from the oldest on
    file: str
    episode: int  # its number in the file
    task: str  # in words
    seconds: float  # its length
    started: str  # ISO 8601 in UTC; "" where unknown
    earlier: bool  # whether an earlier start of the server recorded it


class Lesson(Message):
    """The result of a training in terms that a person notices."""

    recordings: int  # how many were chosen
    learned_from: int  # how many of them its weights were fitted to; the others checked it
    short: tuple[int, ...]  # numbers of the recordings that are much shorter than the others
    speeds_m_s: tuple[float, ...]  # how fast a full push moves the tool along each axis of the stick, m/s
    weak: tuple[int, ...]  # axes that do little, 0 for left and right, 1 for up and down


class Training(Message):
    """A training under way, or the last one."""

    phase: TrainingPhase
    run: str
    epoch: int = 0  # passes over the episodes so far
    epochs: int = 0
    loss: float | None = None  # validation loss so far, or null
    seconds_left: float | None = None  # estimate, or null
    why: tuple[Notice, ...] = ()  # reasons of a failure, or warnings
    lesson: Lesson | None = None  # null before it is done


class LearningState(Message):
    """Recordings, training and runs; sent after `Welcome` and whenever it changes."""

    type: Literal["learning"] = "learning"
    training: Training | None  # null before the first
    personalise: Personalise | None  # null where nobody was asked
    recordings: tuple[Recorded, ...]  # the newest that are kept, from the oldest on
    runs: tuple[str, ...]
    run: str | None  # the loaded one of ``runs``, or null
    profiles: tuple[str, ...]  # people whose alignment with it can be chosen
