"""Writes the drives of a served study as LeRobot datasets, one for each task."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from latentarm.core.types import Demonstrations, Episode, Provenance
from latentarm.demonstrations.dataset import write_dataset
from latentarm.recordings.dataset_export import demonstrations_of
from latentarm.recordings.journal_reader import JournalEpisode
from latentarm.recordings.journal_writer import EpisodeHeader
from latentarm.robots.kinematics.pose_rows import thing_rows
from latentarm.tasks.scene_task import SceneTask
from latentarm_research.drives.drive import RATE_HZ
from latentarm_research.user_studies.definition import StudyTask
from latentarm_research.user_studies.drive_record import DriveRecord
from latentarm_research.user_studies.drive_steps import begin, read_steps
from latentarm_research.user_studies.scenes import scene_of

FOLDER: Final = "drives"


def write_drives(folder: Path, task: StudyTask, drives: Sequence[tuple[DriveRecord, Path]]) -> None:
    """Write drives at a task, each given with the file of its steps, as episodes in this order.

    Raises a `UserError` where a file holds no steps of a drive.
    """
    scene = scene_of(task.scene)
    read = [_demonstrations(scene, record, path) for record, path in drives]
    episodes = tuple(_with_added(one.episodes[0]) for one in read)
    write_dataset(replace(read[0], episodes=episodes), folder / FOLDER / task.name)


def _demonstrations(scene: SceneTask, record: DriveRecord, path: Path) -> Demonstrations:
    """One drive as a dataset of one episode."""
    seed, steps = read_steps(path)
    begun = begin(scene, record.choice, seed)
    things = tuple(sorted(begun.scene.names))
    records = tuple(replace(step, things=thing_rows(state.poses, things)) for state, step, _ in steps)
    robot = scene.robot
    header = EpisodeHeader(
        robot=robot.name,
        joint_names=robot.joint_names,
        joint_limits=robot.limits,
        rate_hz=RATE_HZ,
        task=begun.text,
        provenance=Provenance(person=str(record.person), controller=record.condition, task_name=record.task),
        end_effector=robot.end_effector,
        limits=robot.stated_limits,
        things=things,
        objects=begun.objects,
    )
    return demonstrations_of([JournalEpisode(header, records, complete=True)], source=str(path))


def _with_added(episode: Episode) -> Episode:
    """The episode with how much help was added: all of a dataset have the same features."""
    none = np.zeros((len(episode.timestamp), 1))
    return replace(episode, extras={"assist.added": none, **episode.extras})
