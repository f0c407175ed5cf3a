"""Simulated drives along held-out episodes: latent actions of two models, and mode switching.

The loop is that of `latentarm drive` on held-out episodes, with its safety filters; the simulated operator
is the same for all controllers. Looking one step ahead, as in equation 24, it gets stuck within a few
waypoints of latent actions, so here it plans up to 4 s ahead when no single step leads nearer.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.latent import LatentController
from latentarm.core.types import Row
from latentarm.demonstrations.split import select_episodes
from latentarm.evaluation.summary import Subject, summarise
from latentarm.models.decoder import Decoder
from latentarm.robots.catalogue import load_recorded_robot
from latentarm.tasks.goal_task import GoalTask
from latentarm.tasks.replay import Replay, routes_of
from latentarm_research.drives.drive import Setup, drive
from latentarm_research.metrics.drives import Drive, drive_rows
from latentarm_research.metrics.ending import Ending
from latentarm_research.people.catalogue import PEOPLE, usual_operator
from latentarm_research.studies.compare.cell import FoldResult
from latentarm_research.studies.compare.datasets import Dataset
from latentarm_research.studies.compare.preset import BESIDE, Preset, Stream
from latentarm_research.studies.streams import sequence

MODES: Final = "end_effector"  # mode switching, as rows name it


@dataclass(frozen=True, eq=False)
class ModelDriveCell:
    """One drive."""

    dataset: Dataset  # what is driven
    episode: int  # its index in the dataset
    controller: str  # a model's name, or `MODES`
    decoder: Decoder | None  # of that model, trained on the fold; None for `MODES`
    limit_s: float  # a drive that lasts longer has failed, s
    seed: int  # of everything random


@dataclass(frozen=True, eq=False)
class DriveResult:
    """The result of a drive."""

    dataset: str  # its name
    controller: str  # a model's name, or `MODES`
    episode: int  # its index in the dataset
    figures: Drive  # of the drive
    progress: float  # share of the waypoints that were reached
    ending: Ending  # why it ended


def drive_cells(
    datasets: Sequence[Dataset],
    results: Sequence[FoldResult],
    preset: Preset,
    seed: int,
) -> list[ModelDriveCell]:
    """Every held-out episode once with each controller."""
    decoders = {
        (one.place.dataset, one.place.model, one.place.fold): one.decoder
        for one in results
        if one.place.noise_rad == preset.noises_rad[0]
    }
    trained = {model for _, model, _ in decoders}
    models = [name for name in dict.fromkeys((preset.ours, BESIDE)) if name in trained]
    return [
        ModelDriveCell(
            dataset,
            episode,
            controller,
            decoders.get((dataset.name, controller, fold.index)),
            preset.drive_limit_s,
            seed,
        )
        for dataset in datasets
        for controller in (*models, MODES)
        for fold in dataset.folds[: preset.drives]
        for episode in fold.held_out[: preset.drives]
    ]


def measure_drive_cell(cell: ModelDriveCell) -> DriveResult:
    """Drive once; the start and the operator's randomness depend on the episode, not on the controller."""
    robot = load_recorded_robot(cell.dataset.demonstrations)
    task = Replay(robot, routes_of(robot, select_episodes(cell.dataset.demonstrations, [cell.episode])))
    controller: Controller = (
        EndEffectorController(robot) if cell.decoder is None else LatentController(cell.decoder)
    )
    setup = Setup(
        GoalTask(task, task.manners[0], cell.limit_s),
        controller,
        PEOPLE[usual_operator(task.name)],
    )
    streams = sequence(cell.seed, cell.dataset.name, Stream.DRIVES, cell.episode)
    trace = drive(setup, 0, np.random.default_rng(streams))
    return DriveResult(
        dataset=cell.dataset.name,
        controller=cell.controller,
        episode=cell.episode,
        figures=trace.figures,
        progress=trace.figures.steps_done,
        ending=trace.ending,
    )


def drive_label(cell: ModelDriveCell) -> str:
    """What a drive is called when it fails."""
    return f"{cell.dataset.name}, drive of episode {cell.episode} with {cell.controller}"


def rows_of_drives(study: str, condition: str, results: Sequence[DriveResult]) -> list[Row]:
    """Mean and SD over the drives of each dataset and controller."""
    rows: list[Row] = []
    for dataset, controller in dict.fromkeys((one.dataset, one.controller) for one in results):
        here = [one for one in results if (one.dataset, one.controller) == (dataset, controller)]
        subject = Subject(study, task=dataset, model=controller, condition=condition)
        rows += drive_rows(subject, [one.figures for one in here])
        rows.append(summarise(subject, "progress", [one.progress for one in here]))
    return rows
