"""Training on recordings, in a child process: journals in, a dataset and a run out."""

import math
import re
import shutil
import time
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from latentarm.core.types import Demonstrations
from latentarm.models.catalogue import DEFAULT_MODEL, KINDS
from latentarm.recordings.dataset_export import ImplausibleWarning, demonstrations_of
from latentarm.web.jobs.chosen import Chosen, check_alike, read_chosen
from latentarm.web.jobs.job import Job, Wire
from latentarm.web.jobs.lesson import lesson_of, moving_seconds
from latentarm.web.protocol.learning_messages import Training
from latentarm.web.protocol.notice import Notice, NoticeError, sentence

RATE_HZ: Final = 10.0  # samples per second of motion for training: an action then looks half a second ahead
FEWEST: Final = 3  # episodes: one trains, one stops the training, and one is kept for `latentarm evaluate`
SHORTEST_S: Final = 1.0  # an episode that moves for less than this shows nothing
STATE_NOISE_RAD: Final = 0.01

_FIRST_MODELS: Final = (DEFAULT_MODEL, "homogeneous", "cvae", "cae", "pca")

_NAME: Final = re.compile(r"\w[\w .-]{0,58}\w|\w")
_TELL_EVERY_S: Final = 0.1


def model_names() -> tuple[str, ...]:
    """Names in the catalogue of models, the default first. Loads no model."""
    return tuple(dict.fromkeys((*_FIRST_MODELS, *KINDS)))


@final
@dataclass(frozen=True)
class TrainingPlan:
    """The model to train, and the episodes to train it on.

    Raises NoticeError if the name cannot be a folder's or is taken, or there are too few episodes.
    """

    chosen: tuple[Chosen, ...]
    name: str
    model: str  # a name in the catalogue of models
    latent_dim: int
    out: Path  # folder that holds ``datasets`` and ``runs``

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name):
            raise NoticeError("name_invalid")
        if self.dataset.exists() or self.run.exists():
            raise NoticeError("run_exists", name=self.name)
        if self.model not in model_names():
            raise NoticeError("model_unknown", name=self.model, known=", ".join(model_names()))
        chosen = len(set(self.chosen))
        if chosen < FEWEST:
            raise NoticeError("too_few_episodes", least=FEWEST, count=chosen)

    @property
    def dataset(self) -> Path:
        return self.out / "datasets" / self.name

    @property
    def run(self) -> Path:
        return self.out / "runs" / self.name


@final
class TrainingJob:
    """A training under way, for the page's server."""

    def __init__(self, plan: TrainingPlan) -> None:
        self._job = Job(train_as_planned, (plan,), Training, "training")
        self._state = Training(phase="exporting", run=plan.name)
        self._cancelled = False

    @property
    def under_way(self) -> bool:
        return self._state.phase in ("exporting", "training")

    def look(self) -> Training:
        if not self.under_way:
            return self._state
        alive = self._job.alive  # read before its messages: a child that has ended sends no more
        for state in self._job.heard():
            self._state = state
        if self.under_way and not alive:
            phase = "cancelled" if self._cancelled else "failed"
            why = () if self._job.failure is None else (self._job.failure,)
            self._state = self._state.model_copy(update={"phase": phase, "seconds_left": None, "why": why})
        return self._state

    def cancel(self) -> None:
        """End it, and wait until it has tidied up, two seconds at most."""
        self._cancelled = True
        self._job.end()


def train_as_planned(wire: Wire, plan: TrainingPlan) -> None:
    """The child's work. If it fails or is ended, it leaves nothing behind.

    `demonstrations.pauses` prepares the episodes: motion alone, at `RATE_HZ`. Raises UserError if the
    episodes are unusable, or the disk has no room.
    """
    from latentarm.demonstrations.pauses import without_pauses

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ImplausibleWarning)
        episodes = read_chosen(plan.chosen)
        check_alike(episodes)
        recorded = demonstrations_of(list(episodes.values()), source="The recording")
    cut = [_cut(one.message) for one in caught if isinstance(one.message, ImplausibleWarning)]
    moved_s = {number: moving_seconds(episode, RATE_HZ) for number, episode in episodes.items()}
    too_short = [number for number, seconds in moved_s.items() if seconds < SHORTEST_S]
    if too_short:
        raise NoticeError(
            "episodes_too_short",
            seconds=round(SHORTEST_S),
            count=len(too_short),
            numbers=", ".join(map(str, too_short)),
        )
    demonstrations = without_pauses(recorded, RATE_HZ)
    progress = _Progress(wire, plan.name)
    try:
        warned = _train(progress, plan, demonstrations)
        lesson = lesson_of(plan.run, demonstrations, moved_s)
    except BaseException:
        shutil.rmtree(plan.run, ignore_errors=True)
        shutil.rmtree(plan.dataset, ignore_errors=True)
        raise
    progress.say(phase="done", seconds_left=None, why=(*cut, *warned), lesson=lesson)


def _cut(warning: ImplausibleWarning) -> Notice:
    if warning.kept_s == 0.0:
        return Notice(code="recording_left_out", parameters={"task": warning.task})
    return Notice(code="recording_cut", parameters={"task": warning.task, "kept_s": f"{warning.kept_s:.1f}"})


def _train(progress: "_Progress", plan: TrainingPlan, demonstrations: Demonstrations) -> list[Notice]:
    # pyarrow, and then torch, which take seconds to load: in this process alone.
    from latentarm.demonstrations.dataset import write_dataset

    write_dataset(demonstrations, plan.dataset)
    from latentarm.models.scaling import CollapseWarning
    from latentarm.runs.options import TrainOptions
    from latentarm.runs.training import train_run

    options = TrainOptions(
        demonstrations=(plan.dataset,),
        model=plan.model,
        out=plan.run,
        latent_dim=plan.latent_dim,
        seeds=1,
        state_noise_rad=STATE_NOISE_RAD,
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UserWarning)
        train_run(options, progress)
    # The lesson says which direction does little.
    return [
        sentence(str(one.message))
        for one in caught
        if issubclass(one.category, UserWarning) and not issubclass(one.category, CollapseWarning)
    ]


@final
class _Progress:
    """Tells the parent how far the training is, at most ten times a second."""

    def __init__(self, wire: Wire, run: str) -> None:
        self._wire = wire
        self._state = Training(phase="training", run=run)
        self._begun_s = time.monotonic()
        self._told_s = -math.inf

    def say(self, **fields: object) -> None:
        self._state = self._state.model_copy(update=fields)
        self._wire.say(self._state)

    def __call__(self, epoch: int, epochs: int, loss: float) -> None:
        now_s = time.monotonic()
        if epoch == 0:
            self._begun_s = now_s
        if now_s - self._told_s < _TELL_EVERY_S and epoch < epochs:
            return
        self._told_s = now_s
        left_s = (now_s - self._begun_s) / epoch * (epochs - epoch) if epoch else None
        finite = loss if math.isfinite(loss) else None
        self.say(epoch=epoch, epochs=epochs, loss=finite, seconds_left=left_s)
