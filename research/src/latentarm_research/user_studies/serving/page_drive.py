"""One drive of a study on the Drive page: what is driven, and its record, written by the arm's process.

That process begins with every drive, so nothing is imported here that takes seconds.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Literal, final

from latentarm.arms.contract import SceneArm
from latentarm.assistance.assistance import AssistanceRule
from latentarm.assistance.belief import Rule
from latentarm.assistance.controllers.contract import Controller
from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.types import StepRecord
from latentarm.models.decoder import Decoder
from latentarm.models.saving import read_model
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm.web.arm_process.fixed_drive import FixedDrive
from latentarm_research.user_studies.conditions import assistance_of, belief_of, controller_of
from latentarm_research.user_studies.definition import Condition, Definition, StudyTask
from latentarm_research.user_studies.drive_record import DriveContext
from latentarm_research.user_studies.drive_steps import Measuring, StepLog, begin
from latentarm_research.user_studies.scenes import scene_of

RECORD: Final = "drive.json"  # appears whole in the folder of a drive once it has ended
STEPS: Final = "drive.safetensors"  # there before it


def check_served(definition: Definition) -> None:
    """Raise a `UserError` where a condition cannot be driven on the page."""
    for one in definition.conditions:
        why = ""
        if one.controls == "two_sticks":
            why = "needs two sticks, and the page has one"
        elif one.assists == "interpolation":
            why = "moves the arm while the stick is let go, which the page forbids"
        elif one.aligns != "none":
            why = "needs answers about each person's own directions, which are not asked yet"
        if why:
            raise UserError(f"{definition.name} cannot be served: its condition {one.name} {why}.")


@final
@dataclass(frozen=True)
class ToDrive:
    """A drive that is due, for practice or as part of a trial."""

    kind: Literal["practice", "trial"]
    condition: Condition
    order: int  # place of the condition in the person's order
    task: StudyTask
    trial: int
    choice: int
    attempt: int
    limit_s: float  # for how long it may last, s
    seed: int  # of the scene and the start


@final
@dataclass(frozen=True)
class PageDrive(FixedDrive):
    """A drive of a trial, or of practice, as plain values."""

    due: ToDrive  # what is driven, and for how long
    person: int  # their number
    model: Path | None  # folder of the condition's model; None where it has none
    folder: Path  # for the record

    @property
    def task(self) -> SceneTask:
        """That of the scene."""
        return scene_of(self.due.task.scene)

    def begin(self) -> Beginning:
        """The same scene and start for a person, a trial and an attempt in every condition."""
        return begin(self.task, self.due.choice, self.due.seed)

    @property
    def latent(self) -> bool:
        """True if the condition drives with a trained model."""
        return self.model is not None

    def controller(self) -> Controller:
        """That of the condition, as for simulated people."""
        decoder = None if self.model is None else Decoder(read_model(self.model), 0)
        return controller_of(self.due.condition, self.task.robot, decoder)

    @property
    def rule(self) -> Rule:
        """That of the condition."""
        return belief_of(self.due.condition, self.task.robot)

    @property
    def assistance(self) -> AssistanceRule | None:
        """That of the condition."""
        return assistance_of(self.due.condition, self.task.robot)

    def watch(self, arm: SceneArm, device: Callable[[], str]) -> Callable[[StepRecord], None]:
        """Measure the drive as a simulated one is measured, and write its record when it ends."""
        return _Watch(self, arm, device)


@final
class _Watch:
    """Follows a drive from when the arm is first enabled until it has ended or its time is over."""

    def __init__(self, drive: PageDrive, arm: SceneArm, device: Callable[[], str]) -> None:
        due = drive.due
        self._drive = drive
        self._arm = arm
        self._device = device
        limit_s = min(due.limit_s, drive.task.time_limit_s)
        self._measuring = Measuring(drive.task, due.choice, due.seed, limit_s)
        self._log = StepLog()
        self._over = False

    def __call__(self, record: StepRecord) -> None:
        if self._over or not (self._log.rows or record.command.stop is None):
            return
        state = replace(self._arm.scene_state(), time_s=record.time_s)
        device = self._device()
        self._log.add(state, record, device)
        self._over = self._measuring.sees(state, record, device) or self._log.full
        if self._over:
            self._write()

    def _write(self) -> None:
        due, folder = self._drive.due, self._drive.folder
        where = DriveContext(
            "real", self._drive.person, due.condition.name, due.order, due.trial, due.attempt
        )
        found = self._measuring.record(where, due.task, full=self._log.full)
        self._log.write(folder / STEPS, due.seed)
        write_text(folder / RECORD, found.model_dump_json())
