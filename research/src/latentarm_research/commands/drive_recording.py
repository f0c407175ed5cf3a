"""Recording the drives of `latentarm drive`: a journal next to the results, then a dataset."""

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar, final

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.errors import UserError
from latentarm.core.parallel import counting_bar
from latentarm.core.types import Goal, StepRecord
from latentarm.demonstrations.folders import check_vacant
from latentarm.demonstrations.provenance import provenance_now
from latentarm.recordings.dataset_export import export_journal
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder
from latentarm.robots.robot import Robot
from latentarm.runs.folder import weights_fingerprint
from latentarm.surroundings.catalogue import SCENE
from latentarm_research.commands.drive_options import DriveOptions
from latentarm_research.drives.drive import RATE_HZ

_Call = TypeVar("_Call")


@final
class DriveRecording:
    """Records one drive after the other."""

    def __init__(
        self, config: DriveOptions, robot: Robot, controller: Controller, recorder: Recorder
    ) -> None:
        self._config, self._robot, self._controller = config, robot, controller
        self._recorder = recorder

    def begin(
        self, task: str, goals: Sequence[Goal], things: Sequence[str] = (), objects: Sequence[str] = ()
    ) -> None:
        """Begin a drive. Raises a `UserError` where the journal cannot be written."""
        config, robot = self._config, self._robot
        self._recorder.begin_episode(
            EpisodeHeader(
                robot=robot.name,
                joint_names=robot.joint_names,
                joint_limits=robot.limits,
                rate_hz=RATE_HZ,
                task=task,
                goals=tuple(goals),
                modes=self._controller.modes,
                provenance=provenance_now(
                    run="" if config.run is None else config.run.name,
                    run_fingerprint="" if config.run is None else weights_fingerprint(config.run),
                    profile=config.profile or "",
                    device="simulated",
                    controller=config.driver,
                ),
                end_effector=robot.end_effector,
                limits=robot.stated_limits,
                things=tuple(things),
                objects=tuple(objects),
                sources=(SCENE,) if things else (),
            )
        )

    def step(self, record: StepRecord) -> None:
        """Add a step of the drive. Raises a `UserError` where the journal cannot be written."""
        self._recorder.record(record)

    def end(self) -> None:
        """Complete the drive. Raises a `UserError` where the journal cannot be written."""
        self._recorder.end_episode()


def check_recordable(config: DriveOptions) -> None:
    """Fail before anything is computed where a recording would overwrite something."""
    if config.record is None:
        return
    check_vacant(config.record)
    if _journal(config).exists():
        raise UserError(f"{_journal(config)} already exists: choose another folder with --out.")


@contextmanager
def recording(
    config: DriveOptions, dataset: Path, robot: Robot, controller: Controller
) -> Generator[DriveRecording]:
    """Record drives; export them as a dataset once all are done."""
    recorder = Recorder(_journal(config))
    try:
        yield DriveRecording(config, robot, controller, recorder)
    finally:
        recorder.close()
    export_journal(_journal(config), dataset)


def counted(plan: Sequence[_Call], bars: bool) -> Generator[_Call]:
    """The drives, one after the other, with a bar that counts those that are done."""
    with counting_bar(bars) as bar:
        task = bar.add_task("drives", total=len(plan))
        for call in plan:
            yield call
            bar.advance(task)


def _journal(config: DriveOptions) -> Path:
    return config.out / "journal.sqlite"
