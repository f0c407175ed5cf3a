"""Recording the drives of `latentarm drive`: a journal next to the results, then a dataset."""

from collections.abc import Callable, Sequence
from pathlib import Path

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.errors import UserError
from latentarm.core.parallel import counting_bar
from latentarm.core.types import Provenance, StepRecord
from latentarm.demonstrations.folders import check_vacant
from latentarm.demonstrations.provenance import provenance_now
from latentarm.recordings.dataset_export import demonstrations_of
from latentarm.recordings.journal_reader import read_journal
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder
from latentarm.robots.robot import Robot
from latentarm.runs.folder import weights_fingerprint
from latentarm.surroundings.catalogue import SCENE
from latentarm.tasks.scene_task import Beginning
from latentarm_research.commands.drive_options import DriveOptions
from latentarm_research.drives.drive import RATE_HZ
from latentarm_research.drives.drives import Planned
from latentarm_research.drives.trace import Trace


def check_recordable(config: DriveOptions) -> None:
    """Fail before anything is computed where a recording would overwrite something."""
    if config.record is None:
        return
    check_vacant(config.record)
    if _journal(config).exists():
        raise UserError(f"{_journal(config)} already exists: choose another folder with --out.")


def record_drives(
    planned: Sequence[Planned], config: DriveOptions, dataset: Path, robot: Robot, controller: Controller
) -> list[Trace]:
    """Drive one after the other, record every step with where the things are, and export a dataset.

    Raises a `UserError` where the journal cannot be written.
    """
    recorder = Recorder(_journal(config))

    def begin(begun: Beginning) -> Callable[[StepRecord], None]:
        recorder.begin_episode(_header(begun, config, robot, controller))
        return recorder.record

    traces: list[Trace] = []
    try:
        with counting_bar(config.bars) as bar:
            for one in bar.track(planned, description="drives"):
                traces.append(one.drive(record=begin))
                recorder.end_episode()
    finally:
        recorder.close()
    # pyarrow is slow to load, and most drives are not recorded.
    from latentarm.demonstrations.dataset import write_dataset

    write_dataset(demonstrations_of(read_journal(_journal(config)), source=str(_journal(config))), dataset)
    return traces


def _header(begun: Beginning, config: DriveOptions, robot: Robot, controller: Controller) -> EpisodeHeader:
    return EpisodeHeader(
        robot=robot.name,
        joint_names=robot.joint_names,
        joint_limits=robot.limits,
        rate_hz=RATE_HZ,
        task=begun.text,
        goals=begun.goals,
        modes=controller.modes,
        provenance=provenance_now(
            Provenance(
                run="" if config.run is None else config.run.name,
                run_fingerprint="" if config.run is None else weights_fingerprint(config.run),
                profile=config.profile or "",
                device="simulated",
                controller=config.driver,
            )
        ),
        end_effector=robot.end_effector,
        limits=robot.stated_limits,
        things=begun.scene.names,
        objects=begun.objects,
        sources=(SCENE,) if begun.scene.names else (),
    )


def _journal(config: DriveOptions) -> Path:
    return config.out / "journal.sqlite"
