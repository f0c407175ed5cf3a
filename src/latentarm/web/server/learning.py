"""Recordings, trainings and runs, and their state for pages."""

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Final, final

from latentarm.control.journal import list_journal
from latentarm.core.errors import UserError
from latentarm.runs.folder import read_run
from latentarm.web.jobs.training import TrainingJob, TrainingPlan
from latentarm.web.protocol.learning_messages import LearningState, Recorded, Train, Training
from latentarm.web.protocol.notice import Notice, NoticeError, notice_of
from latentarm.web.protocol.orders import ChooseRun
from latentarm.web.server.loaded_run import RunList
from latentarm.web.server.personalising import Driven, Personalising
from latentarm.web.server.run_check import WITHIN_S, why_not_drivable
from latentarm.web.server.states import States

if TYPE_CHECKING:
    from latentarm.web.arm_process.process import ControlProcess

LOOK_S: Final = 0.2  # how often jobs and recordings are checked, s


@final
class Learning:
    """Recordings, trainings, runs, and people's alignments. ``out`` holds ``datasets`` and ``runs``."""

    def __init__(self, control: "ControlProcess", states: States, run_list: RunList, out: Path) -> None:
        self._control = control
        self._states = states
        self._run_list = run_list
        self._out = out
        self._job: TrainingJob | None = None
        self._training: Training | None = None
        self._recordings: tuple[Recorded, ...] = ()
        self._listed: tuple[str, int] | None = None
        self._cancelling: asyncio.Task[None] | None = None
        self._choosing: asyncio.Task[None] | None = None
        self.personalising = Personalising(self._driven, control)
        self.text = ""  # the state as JSON, for pages
        self.number = 0  # changes with every change of `text`
        self._tell(run_list.runs())

    @property
    def at_rest(self) -> bool:
        """Whether the arm stands disengaged."""
        return self._driven().at_rest

    async def follow(self) -> None:
        """Update the state, until cancelled."""
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
        report = self._states.report
        journal = None if report is None or report.recording is None else Path(report.recording.journal)
        try:
            if journal is None:
                raise NoticeError("nothing_recorded")
            run = self._states.loaded.spec.run
            plan = TrainingPlan(
                journal=journal,
                episodes=wish.episodes,
                name=wish.name.strip(),
                model=wish.model,
                latent_dim=wish.latent_dim,
                out=self._out,
                end_effector=None if run is None else read_run(run).end_effector,
            )
            self._job = TrainingJob(plan)
            self._training = self._job.look()
        except UserError as error:
            self._job = None
            self._training = Training(phase="failed", run=wish.name.strip()[:80], why=(notice_of(error),))

    def cancel(self) -> None:
        """End the training under way."""
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
        """End what is under way."""
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

    def _driven(self) -> Driven:
        loaded = self._states.loaded
        return Driven(loaded.spec.run, loaded.latent_dim, self._states.report)

    async def _list_recordings(self) -> None:
        report = self._states.report
        recording = None if report is None else report.recording
        if recording is None or recording.episodes == 0:
            return
        listed = (recording.journal, recording.episodes)
        if listed == self._listed:
            return
        try:
            entries = await asyncio.to_thread(list_journal, Path(recording.journal))
        except UserError:
            return  # it is being written: try again soon
        self._listed = listed
        self._recordings = tuple(
            Recorded(number=entry.number, task=entry.header.task, seconds=round(entry.duration_s, 1))
            for entry in entries
            if entry.complete
        )

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
