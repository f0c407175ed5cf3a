"""Recordings, trainings and runs, and their state for pages."""

import asyncio
import math
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, final

from latentarm.core.errors import UserError
from latentarm.web.jobs.chosen import Chosen
from latentarm.web.jobs.training import TrainingJob, TrainingPlan
from latentarm.web.protocol.learning_messages import LearningState, Recorded, Train, Training
from latentarm.web.protocol.notice import Notice, NoticeError, notice_of
from latentarm.web.protocol.orders import ChooseRun
from latentarm.web.records.recordings import Recordings
from latentarm.web.server.loaded_run import RunList
from latentarm.web.server.personalising import Personalising
from latentarm.web.server.run_check import WITHIN_S, why_not_drivable
from latentarm.web.server.states import States

if TYPE_CHECKING:
    from latentarm.web.arm_process.process import ControlProcess

LOOK_S: Final = 0.2  # how often jobs and recordings are checked, s
LIST_S: Final = 5.0  # how often files of recordings are looked for that somebody added or deleted, s
MOST_LISTED: Final = 100


@final
@dataclass(eq=False)
class Learning:
    """Recordings, trainings, runs, and people's alignments. ``_out`` holds ``datasets`` and ``runs``."""

    _control: "ControlProcess"
    _states: States
    _run_list: RunList
    _journals: Recordings
    _out: Path

    def __post_init__(self) -> None:
        self._job: TrainingJob | None = None
        self._training: Training | None = None
        self._recordings: tuple[Recorded, ...] = ()
        self._listed: int | None = None
        self._list_again_s = -math.inf
        self._cancelling: asyncio.Task[None] | None = None
        self._choosing: asyncio.Task[None] | None = None
        self.personalising = Personalising(self._states, self._control)
        self.text = ""  # the state as JSON, for pages
        self.number = 0  # changes with every change of `text`
        self._tell(self._run_list.runs())

    async def follow(self) -> None:
        while True:
            await self._list_recordings()
            if self._job is not None:
                self._training = self._job.look()
            self._states.standstill = self.personalising.standstill
            self._tell(await asyncio.to_thread(self._run_list.runs))
            await asyncio.sleep(LOOK_S)

    def train(self, wish: Train) -> None:
        """Begin a training, or say why not; ignored while one is under way."""
        if self._job is not None and self._job.under_way:
            return
        numbers = {(one.file, one.episode): one.number for one in self._recordings}
        try:
            if any((one.file, one.episode) not in numbers for one in wish.episodes):
                raise NoticeError("record_unknown")
            plan = TrainingPlan(
                chosen=tuple(
                    Chosen(self._out / one.file, one.episode, numbers[one.file, one.episode])
                    for one in wish.episodes
                ),
                name=wish.name.strip(),
                model=wish.model,
                latent_dim=wish.latent_dim,
                out=self._out,
            )
            self._job = TrainingJob(plan)
            self._training = self._job.look()
        except UserError as error:
            self._job = None
            self._training = Training(phase="failed", run=wish.name.strip()[:80], why=(notice_of(error),))

    def cancel(self) -> None:
        cancelling = self._cancelling is not None and not self._cancelling.done()
        if self._job is not None and self._job.under_way and not cancelling:
            self._cancelling = asyncio.create_task(asyncio.to_thread(self._job.cancel))

    def choose_run(self, name: str) -> None:
        """Try another run, then drive it. Unknown names are ignored."""
        run = self._run_list.runs().get(name)
        report = self._states.report
        if run is None:
            return
        if report is not None and report.phase in ("ready", "moving", "stopping"):
            self._states.say(Notice(code="stop_first"))
            return
        if self._choosing is not None:
            self._choosing.cancel()
        self._choosing = asyncio.create_task(self._try_run(name, run.resolve()))

    async def close(self) -> None:
        if self._choosing is not None:
            self._choosing.cancel()
        await self.personalising.close()
        if self._job is not None:
            await asyncio.to_thread(self._job.cancel)

    async def _try_run(self, name: str, run: Path) -> None:
        self._states.say(Notice(code="checking_run", parameters={"name": name}), WITHIN_S)
        own_task = not self._run_list.is_first(run)
        failure = await why_not_drivable(self._states.loaded.spec.with_run(run, own_task), name)
        if failure is None:
            self._states.say(None)
            self._control.order(ChooseRun(run=str(run), own_task=own_task))
        else:
            self._states.say(failure)

    async def _list_recordings(self) -> None:
        report = self._states.report
        recording = None if report is None else report.recording
        # While an episode is written, only its end is news.
        if recording is not None and recording.on:
            return
        episodes, now_s = 0 if recording is None else recording.episodes, time.monotonic()
        if episodes == self._listed and now_s < self._list_again_s:
            return
        try:
            files = await asyncio.to_thread(self._journals.all)
        except UserError:
            return  # it is being written: try again soon
        self._listed, self._list_again_s = episodes, now_s + LIST_S
        kept = [(file, one) for file in reversed(files) for one in file.episodes if one.complete]
        self._recordings = tuple(
            Recorded(
                number=number,
                file=file.name,
                episode=one.number,
                task=one.task,
                seconds=one.seconds,
                started=one.started,
                earlier=not file.in_use,
            )
            for number, (file, one) in enumerate(kept, 1)
        )[-MOST_LISTED:]

    def _tell(self, runs: dict[str, Path]) -> None:
        text = LearningState(
            training=self._training,
            personalise=self.personalising.look(),
            recordings=self._recordings,
            runs=tuple(runs),
            run=self._states.loaded.name,
            profiles=self._states.loaded.profiles,
        ).model_dump_json()
        if text != self.text:
            self.text = text
            self.number += 1
