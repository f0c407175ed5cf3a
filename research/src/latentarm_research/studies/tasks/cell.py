"""The study's cells: demonstrations, models that learn from them, and drives with these."""

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import final

from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Episode
from latentarm.demonstrations.validation import validate
from latentarm.models.kind import TrainedModel
from latentarm_research.drives import drive as drives
from latentarm_research.drives.demonstrate import dataset_of, demonstrate_once
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.people.names import OperatorName
from latentarm_research.studies.fitting import fit_model, validation_episodes
from latentarm_research.studies.streams import generator, integer, sequence
from latentarm_research.studies.tasks.moved import task_of
from latentarm_research.studies.tasks.preset import CONTEXTS, Condition, Preset, Stream
from latentarm_research.studies.tasks.runs import Driver, Run, choice_of, decoders_of, driven_run, shown_run


@final
@dataclass(frozen=True)
class ShownCell:
    """A run of the scripted demonstrator."""

    task: str  # a name of `latentarm_research.studies.tasks.moved.TASKS`
    stream: Stream  # what the run is for: `Stream.RUNS` or `Stream.DEMONSTRATIONS`
    number: int  # of the run
    seed: int  # of the study


@final
@dataclass(frozen=True, eq=False)
class DemonstratedRun:
    """The result of a `ShownCell`."""

    cell: ShownCell
    run: Run  # how it went
    episode: Episode | None  # the demonstration; None where it failed
    objects: tuple[str, ...]  # names of the things whose poses the episode holds


def show(cell: ShownCell) -> DemonstratedRun:
    """Let the scripted demonstrator do the task. Raises a `UserError` where the arm cannot be used."""
    task = task_of(cell.task, cell.stream)
    rng = generator(cell.seed, cell.task, cell.stream, cell.number)
    shown = demonstrate_once(task, choice_of(task, cell.number), rng)
    run = shown_run(task, cell.number, shown)
    return DemonstratedRun(cell, run, shown.episode if run.success else None, shown.objects)


@final
@dataclass(frozen=True, eq=False)
class ModelCell:
    """Models of one kind, or the orientations that demonstrations had."""

    task: str  # a name of `latentarm_research.studies.tasks.moved.TASKS`
    # which kind of model, what its decoder sees, and whether it has a way back; or `ORIENTED`
    condition: Condition
    demonstrations: Demonstrations  # to learn from
    preset: Preset  # sizes of the study
    seed: int  # of the study


@final
@dataclass(frozen=True, eq=False)
class FittedModel:
    """The result of a `ModelCell`."""

    task: str  # a name of `latentarm_research.studies.tasks.moved.TASKS`
    condition: Condition  # see `ModelCell`
    model: TrainedModel  # with all its seeds
    fit_s: float  # how long the fit took, s

    @property
    def driver(self) -> Driver:
        """What a person steers with."""
        return Driver(self.condition, decoders_of(self.model))

    @property
    def refused(self) -> bool:
        """Whether a way back was asked for that is no better than none."""
        return self.condition.way_back and not self.model.dimensions.way_back


def train(cell: ModelCell) -> FittedModel:
    """Fit the models. Raises a `UserError` where the preset's sizes make no sense."""
    preset, condition = cell.preset, cell.condition
    began = perf_counter()
    model = fit_model(
        condition.model or "",
        cell.demonstrations,
        validation=validation_episodes(cell.demonstrations),
        fit={"chain": task_of(cell.task, Stream.DEMONSTRATIONS).robot.chain},
        latent_dim=2,
        context=CONTEXTS[condition.name],
        seeds=preset.seeds,
        seed=integer(sequence(cell.seed, cell.task, Stream.NETWORKS)),
        epochs=preset.epochs,
        batch_size=preset.batch_size,
        hidden=preset.hidden,
        state_noise_rad=preset.state_noise_rad,
        way_back_m=preset.way_back_m if condition.way_back else 0.0,
    )
    return FittedModel(cell.task, condition, model.trained_, perf_counter() - began)


@final
@dataclass(frozen=True, eq=False)
class TaskRunCell:
    """A run of a simulated person who drives."""

    task: str  # a name of `latentarm_research.studies.tasks.moved.TASKS`
    driver: Driver  # what they steer with
    person: OperatorName  # who they are
    number: int  # of the run
    seed: int  # of the study

    @property
    def condition(self) -> Condition:
        """What they steer with, and who they are."""
        return self.driver.condition.by(self.person)


def drive(cell: TaskRunCell) -> Run:
    """Let the simulated person do the task."""
    task = task_of(cell.task, Stream.RUNS)
    setup = drives.Setup(task, cell.driver.controller(task.robot, cell.number), PEOPLE[cell.person])
    # The same number gives the same scene and start to the demonstrator and in every condition.
    rng = generator(cell.seed, cell.task, Stream.RUNS, cell.number)
    return driven_run(task, cell.number, drives.drive(setup, choice_of(task, cell.number), rng))


def training_set(
    task: str,  # a name of `latentarm_research.studies.tasks.moved.TASKS`
    shown: Sequence[DemonstratedRun],
) -> Demonstrations:
    """The demonstrations of a task that succeeded, as a dataset."""
    episodes = [one.episode for one in shown if one.episode is not None]
    if len(episodes) < 2:
        raise UserError(
            f"{len(episodes)} demonstrations of the task {task} succeeded, and a model needs two or more:"
            " take a preset with more demonstrations."
        )
    dataset = dataset_of(task_of(task, Stream.DEMONSTRATIONS), episodes, shown[0].objects)
    validate(dataset, f"The demonstrations of the task {task}")
    return dataset
