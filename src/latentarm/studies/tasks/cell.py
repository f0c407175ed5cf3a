"""The study's cells: demonstrations, models that learn from them, and drives with these."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import final

from threadpoolctl import threadpool_limits

from latentarm.errors import UserError
from latentarm.models.kind import TrainedModel
from latentarm.operators.catalogue import PEOPLE, OperatorName
from latentarm.simulation.demonstrate import Demonstration, dataset_of, demonstrate_once
from latentarm.simulation.task_drive import TaskSetup, drive_task
from latentarm.studies.fitting import fit_model, validation_episodes
from latentarm.studies.streams import generator, integer, sequence
from latentarm.studies.tasks.moved import task_of
from latentarm.studies.tasks.preset import CONTEXTS, Preset, Stream
from latentarm.studies.tasks.runs import (
    Condition,
    Driver,
    Run,
    choice_of,
    decoders_of,
    driven_run,
    kept_in,
    shown_run,
)
from latentarm.types import Demonstrations


@final
@dataclass(frozen=True)
class ShownCell:
    """Some runs of the scripted demonstrator.

    Attributes:
        task: a name of `latentarm.studies.tasks.moved.TASKS`.
        stream: what the runs are for: `Stream.RUNS` or `Stream.DEMONSTRATIONS`.
        numbers: of the runs.
        seed: of the study.
    """

    task: str
    stream: Stream
    numbers: range
    seed: int


@final
@dataclass(frozen=True, eq=False)
class Shown:
    """What came of a `ShownCell`.

    Attributes:
        cell: what was asked for.
        runs: in order.
        demonstrations: of these runs, without how things stood in between.
    """

    cell: ShownCell
    runs: tuple[Run, ...]
    demonstrations: tuple[Demonstration, ...]


def show(cell: ShownCell) -> Shown:
    """Let the scripted demonstrator do the task.

    Raises:
        UserError: the arm cannot be used.
    """
    task = task_of(cell.task, cell.stream)
    runs: list[Run] = []
    demonstrations: list[Demonstration] = []
    with threadpool_limits(limits=1):
        for number in cell.numbers:
            choice = choice_of(task, number)
            shown = demonstrate_once(task, choice, generator(cell.seed, cell.task, cell.stream, number))
            runs.append(shown_run(task, number, shown))
            demonstrations.append(replace(shown, states=()))
    return Shown(cell, tuple(runs), tuple(demonstrations))


@final
@dataclass(frozen=True, eq=False)
class TrainingCell:
    """Models of one kind.

    Attributes:
        task: a name of `latentarm.studies.tasks.moved.TASKS`.
        model: a name of `latentarm.models.catalogue.MODELS`.
        context: what its decoder sees, a name of `CONTEXTS`.
        demonstrations: to learn from.
        preset: sizes of the study.
        seed: of the study.
    """

    task: str
    model: str
    context: str
    demonstrations: Demonstrations
    preset: Preset
    seed: int


@final
@dataclass(frozen=True, eq=False)
class Trained:
    """What came of a `TrainingCell`.

    Attributes:
        task: a name of `latentarm.studies.tasks.moved.TASKS`.
        condition: which kind of model, and what its decoder sees.
        model: with all its seeds.
        fit_s: how long the fit took, s.
    """

    task: str
    condition: Condition
    model: TrainedModel
    fit_s: float

    @property
    def driver(self) -> Driver:
        """What a person steers with."""
        return Driver(self.condition, decoders_of(self.model))

    @property
    def folder(self) -> str:
        """Where the study keeps the model, below `latentarm.studies.study.MODELS`."""
        return kept_in(self.task, self.condition)


def train(cell: TrainingCell) -> Trained:
    """Fit the models.

    Raises:
        UserError: the preset's sizes make no sense.
    """
    preset = cell.preset
    with threadpool_limits(limits=1):
        began = perf_counter()
        model = fit_model(
            cell.model,
            cell.demonstrations,
            validation=validation_episodes(cell.demonstrations),
            fit={"chain": task_of(cell.task, Stream.DEMONSTRATIONS).robot.chain},
            latent_dim=2,
            context=CONTEXTS[cell.context],
            seeds=preset.seeds,
            seed=integer(sequence(cell.seed, cell.task, Stream.NETWORKS)),
            epochs=preset.epochs,
            batch_size=preset.batch_size,
            hidden=preset.hidden,
            state_noise_rad=preset.state_noise_rad,
        )
        condition = Condition(cell.context, cell.model)
        return Trained(cell.task, condition, model.trained_, perf_counter() - began)


@final
@dataclass(frozen=True, eq=False)
class DriveCell:
    """Some runs of a simulated person who drives.

    Attributes:
        task: a name of `latentarm.studies.tasks.moved.TASKS`.
        driver: what they steer with.
        person: a name of `PEOPLE`.
        numbers: of the runs.
        seed: of the study.
    """

    task: str
    driver: Driver
    person: OperatorName
    numbers: range
    seed: int


@final
@dataclass(frozen=True, eq=False)
class Driven:
    """What came of a `DriveCell`.

    Attributes:
        task: a name of `latentarm.studies.tasks.moved.TASKS`.
        condition: what the person steered with.
        runs: in order.
        drive_s: how long the simulation took, s.
    """

    task: str
    condition: Condition
    runs: tuple[Run, ...]
    drive_s: float


def drive(cell: DriveCell) -> Driven:
    """Let the simulated person do the task.

    Raises:
        UserError: the arm cannot be used, or the decoder is for another arm.
    """
    task = task_of(cell.task, Stream.RUNS)
    runs: list[Run] = []
    with threadpool_limits(limits=1):
        began = perf_counter()
        for number in cell.numbers:
            choice = choice_of(task, number)
            setup = TaskSetup(task, cell.driver.controller(task.robot, number), PEOPLE[cell.person])
            # The same number gives the same scene and start to the demonstrator and in every condition.
            trace = drive_task(setup, choice, generator(cell.seed, cell.task, Stream.RUNS, number))
            runs.append(driven_run(task, number, trace))
        return Driven(cell.task, cell.driver.condition, tuple(runs), perf_counter() - began)


def training_set(task: str, shown: Sequence[Shown]) -> Demonstrations:
    """The demonstrations of a task that succeeded, as a dataset.

    Args:
        task: a name of `latentarm.studies.tasks.moved.TASKS`.
        shown: of that task.

    Raises:
        UserError: fewer than two succeeded, and a model needs one to learn from and one for validation.
    """
    each = [one for part in shown for one in part.demonstrations]
    succeeded = sum(one.progress.succeeded for one in each)
    if succeeded < 2:
        raise UserError(
            f"{succeeded} demonstrations of the task {task} succeeded, and a model needs two or more: take a"
            " preset with more demonstrations."
        )
    return dataset_of(task_of(task, Stream.DEMONSTRATIONS), each)


def blocks(count: int, size: int) -> list[range]:
    """The numbers 0 to ``count``, in blocks for the cells of a grid."""
    return [range(first, min(first + size, count)) for first in range(0, count, size)]
