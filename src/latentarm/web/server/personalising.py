"""A person's alignment, from the first question until the profile is kept or discarded."""

import asyncio
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final, final

from latentarm.alignment import profile as profiles
from latentarm.core.errors import UserError
from latentarm.core.untrusted.names import clean_name
from latentarm.web.jobs.personalise import PersonaliseJob, PersonalisePlan
from latentarm.web.protocol import personalise_messages as messages
from latentarm.web.protocol.notice import Notice, NoticeError, notice_of
from latentarm.web.protocol.orders import ChooseProfile
from latentarm.web.protocol.personalise_messages import Personalise

if TYPE_CHECKING:
    from latentarm.web.arm_process.process import ControlProcess
    from latentarm.web.server.states import States

STICK_AXES: Final = 2


@final
class Personalising:
    """Asks at most one person at a time; their alignment can be tried before it is kept."""

    def __init__(self, states: "States", control: "ControlProcess") -> None:
        self._states = states
        self._control = control
        self._run: Path | None = None
        self._job: PersonaliseJob | None = None
        self._ending: asyncio.Task[None] | None = None
        self._state: Personalise | None = None
        self._tried = False
        self._before: str | None = None

    @property
    def standstill(self) -> Notice | None:
        """Why the arm may not be enabled; None if it may."""
        if self._state is None or not self._under_way:
            return None
        return Notice(code="asking", parameters={"name": self._state.name})

    def look(self) -> Personalise | None:
        """The state to show, or None if nothing is running."""
        if self._run is not None and self._states.loaded.spec.run != self._run:
            # Another run is driven: answers and profile do not apply to it.
            self._forget()
        if self._job is not None and self._under_way:
            self._state = self._job.look()
        return self._state

    def take(self, message: messages.PersonaliseMessage) -> None:
        """Carry out an order of the driver's page, or report in `look` why it cannot be done."""
        try:
            self._obey(message)
        except UserError as error:
            self._why(notice_of(error))

    async def close(self) -> None:
        """End what is under way, and remove what was not kept."""
        self._forget()
        if self._ending is not None:
            await self._ending

    @property
    def _under_way(self) -> bool:
        return self._job is not None and self._job.under_way

    @property
    def _learned(self) -> bool:
        return self._state is not None and self._state.phase == "learned"

    @property
    def _profile(self) -> str | None:
        return None if self._states.report is None else self._states.report.profile

    def _obey(self, message: messages.PersonaliseMessage) -> None:
        match message:
            case messages.BeginPersonalise():
                self._begin(message)
            case messages.PressPersonalise(type="cancel_personalise"):
                if not self._learned:
                    self._forget()
            case messages.PressPersonalise() if not self._learned:
                pass
            case messages.PressPersonalise(type="try_alignment"):
                self._try()
            case messages.PressPersonalise(type="keep_alignment"):
                self._keep()
            case messages.PressPersonalise():
                self._discard()
            case _:
                if self._job is not None:
                    self._job.reply(message)

    def _begin(self, wish: messages.BeginPersonalise) -> None:
        if self._under_way or (self._ending is not None and not self._ending.done()):
            raise NoticeError("asking_already")
        name = wish.name.strip()
        profile = self._before if self._tried else self._profile
        try:
            run = self._alignable()
            name = name if profiles.NAMED.fullmatch(name) else clean_name(name, profiles.MOST_CHARACTERS)
            if profiles.profile_folder(run, name).exists():
                raise NoticeError("profile_exists", name=name)
            self._give_back()
        except UserError as error:
            if self._learned:
                raise
            self._state = Personalise(phase="failed", name=name, of=wish.questions, why=notice_of(error))
            return
        # An Enable from before that has not been carried out counts for nothing after a stop.
        self._control.stop(Notice(code="question_began"))
        self._run = run
        seat = self._states.loaded.spec.seated(wish.seat)
        self._job = PersonaliseJob(
            PersonalisePlan(run, name, wish.questions, profile, seat, profiles.trial_folder(run))
        )
        self._state = self._job.look()

    def _try(self) -> None:
        self._check_at_rest()
        if not self._tried:
            self._before = self._profile
        self._tried = self._control.order(ChooseProfile(name=profiles.TRIAL)) or self._tried
        self._why(None)

    def _keep(self) -> None:
        if self._run is None or self._state is None:
            return
        if self._tried:
            self._check_at_rest()
        profiles.keep_trial(self._run, self._state.name)
        if self._tried:
            self._control.order(ChooseProfile(name=self._state.name))
        self._tried = False
        self._job = self._run = None
        self._state = self._state.model_copy(update={"phase": "kept", "why": None})

    def _discard(self) -> None:
        self._give_back()
        self._job = self._run = self._state = None

    def _give_back(self) -> None:
        """Restore the alignment from before the trial, and discard the trial."""
        if self._tried:
            self._check_at_rest()
            self._control.order(ChooseProfile(name=self._before))
            self._tried = False
        if (run := self._states.loaded.spec.run) is not None:
            profiles.discard_trial(run)

    def _forget(self) -> None:
        job, run = self._job, self._run
        self._job = self._run = self._state = None
        self._tried = False
        if run is not None:
            self._ending = asyncio.create_task(asyncio.to_thread(_clean, job, run))

    def _why(self, why: Notice | None) -> None:
        if self._state is not None:
            self._state = self._state.model_copy(update={"why": why})

    def _alignable(self) -> Path:
        loaded = self._states.loaded
        if loaded.spec.run is None:
            raise NoticeError("no_run")
        if loaded.latent_dim > STICK_AXES:
            raise NoticeError("too_many_axes", count=loaded.latent_dim)
        self._check_at_rest()
        return loaded.spec.run

    def _check_at_rest(self) -> None:
        if not self._states.at_rest:
            raise NoticeError("stop_first")


def _clean(job: PersonaliseJob | None, run: Path) -> None:
    if job is not None:
        job.end()
    with suppress(UserError):  # what cannot be deleted is replaced by the next
        profiles.discard_trial(run)
