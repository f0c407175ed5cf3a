"""One cell of the study: one model for one arm, with entropy or without, all its seeds and their drives."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Final

import numpy as np

from latentarm.assistance.annotation import annotate
from latentarm.assistance.blending import Arbitration
from latentarm.core.types import Demonstrations, FloatArray
from latentarm.models.goal_entropy import GoalEntropy
from latentarm.models.model import LatentActionModel
from latentarm_research.studies.fitting import fit_model, validation_episodes
from latentarm_research.studies.shared_autonomy.drive import (
    HELP,
    NO_HELP,
    RULE,
    STEP_S,
    Scene,
    drive,
    steps_of,
)
from latentarm_research.studies.shared_autonomy.measures import measure, state_error, true_belief
from latentarm_research.studies.shared_autonomy.preset import Person, Preset
from latentarm_research.studies.streams import generator, integer, sequence
from latentarm_research.tasks.two_cups import TWO_CUPS, TwoCups

WITHOUT_HELP: Final = "LA"
WITH_HELP: Final = "LA+SA"
WITH_ENTROPY: Final = "LA+SA+Entropy"
METHODS: Final[dict[str, Arbitration]] = {WITHOUT_HELP: NO_HELP, WITH_HELP: HELP, WITH_ENTROPY: HELP}
"""The paper's conditions, and how much the robot helps in each."""

ROWS: Final = 100
"""Drives per batch: few enough for the processor's caches, many enough to amortise NumPy's calls."""

TASKS: Final = {make().name: make for make in TWO_CUPS.values()}
"""Two cups before each arm, by the task's name."""


class Stream(IntEnum):
    """Streams of randomness: one per use, so that none depends on another's draws."""

    TRAINING = 0
    NETWORKS = 2
    STATE_NOISE = 3
    STARTS = 4
    CHANCES = 5


@dataclass(frozen=True)
class AutonomyCell:
    """What is to be measured."""

    task: str  # a name of `TASKS`
    model: str  # a name of `MODELS`
    entropy: bool  # whether the entropy over goals is added to the model's own loss
    preset: Preset  # sizes of the study
    # of the whole study; demonstrations, starts and chances come from it and are the same for every model
    seed: int

    @property
    def methods(self) -> tuple[str, ...]:
        """Names of `METHODS` that it is driven by."""
        return (WITH_ENTROPY,) if self.entropy else (WITHOUT_HELP, WITH_HELP)


@dataclass(frozen=True, eq=False)
class Outcome:
    """Results of one kind of person with one method."""

    method: str  # a name of `METHODS`
    person: Person  # who drove
    figures: Mapping[str, FloatArray]  # measure -> (S, P), of each seed's drives
    error: FloatArray  # (S, T + 1), state error over time, mean over a seed's drives
    belief: FloatArray  # (S, T + 1), in the goal that is wanted in the end


@dataclass(frozen=True, eq=False)
class AutonomyResult:
    """Results of one cell."""

    cell: AutonomyCell
    outcomes: tuple[Outcome, ...]  # of every method and person


def measure_cell(cell: AutonomyCell) -> AutonomyResult:
    """Demonstrate, fit all seeds in one fit, drive, measure."""
    task, preset = TASKS[cell.task](), cell.preset
    training = annotate(
        task.demonstrate(preset.demonstrations, generator(cell.seed, cell.task, Stream.TRAINING)), RULE
    )
    model = _fit(cell, task, training)
    goals = np.stack([goal.configuration for goal in task.goals])
    scene = Scene(task.robot.chain, RULE(goals, period_s=STEP_S))
    outcomes = tuple(
        outcome
        for method in cell.methods
        for people in _together(cell)
        for outcome in _outcomes(cell, task, scene, model, method, people)
    )
    return AutonomyResult(cell, outcomes)


def _fit(cell: AutonomyCell, task: TwoCups, training: Demonstrations) -> LatentActionModel:
    preset = cell.preset
    return fit_model(
        cell.model,
        training,
        validation=validation_episodes(training),
        latent_dim=1,
        context="state_belief",
        actions="recorded",
        state_noise_rad=preset.state_noise_rad,
        data_seed=integer(sequence(cell.seed, cell.task, Stream.STATE_NOISE)),
        seeds=preset.seeds,
        seed=integer(sequence(cell.seed, cell.task, Stream.NETWORKS)),
        hidden=preset.hidden,
        epochs=preset.epochs,
        batch_size=preset.batch_size,
        patience=preset.epochs,
        kl_weight=preset.kl_weight,
        fit={"chain": task.robot.chain, "term": _term(preset, task) if cell.entropy else None},
    )


def _term(preset: Preset, task: TwoCups) -> GoalEntropy:
    goals = np.stack([goal.configuration for goal in task.goals])
    return GoalEntropy(
        goals, weight=preset.entropy_weight, sharpness=preset.sharpness, chain=task.robot.chain
    )


def _together(cell: AutonomyCell) -> list[list[Person]]:
    """The cell's people in groups that drive in one go: for the same time, and about `ROWS` drives."""
    groups: list[list[Person]] = []
    for person in cell.preset.people:
        last = groups[-1] if groups else []
        alike = bool(last) and last[0].drive_s == person.drive_s
        if alike and (len(last) + 1) * cell.preset.drives <= ROWS:
            last.append(person)
        else:
            groups.append([person])
    return groups


def _outcomes(
    cell: AutonomyCell,
    task: TwoCups,
    scene: Scene,
    model: LatentActionModel,
    method: str,
    people: Sequence[Person],
) -> list[Outcome]:
    """Results of people who drive in one batch."""
    target = np.arange(cell.preset.drives) % len(scene.goals)
    figures: list[dict[str, FloatArray]] = []
    courses: list[tuple[FloatArray, FloatArray]] = []
    for seed in range(cell.preset.seeds):
        starts = generator(cell.seed, cell.task, Stream.STARTS, seed)
        start = np.stack([task.sample_start(int(goal), starts) for goal in target])
        decoder = model.decoder(seed)
        drives = drive(
            decoder,
            scene,
            [person for person in people for _ in target],
            METHODS[method],
            np.tile(start, (len(people), 1)),
            np.tile(target, len(people)),
            np.concatenate([_chances(cell, seed, person) for person in people]),
        )
        figures.append(measure(drives, scene, decoder))
        courses.append((state_error(drives, scene), true_belief(drives)))
    outcomes: list[Outcome] = []
    for index, person in enumerate(people):
        own = slice(index * cell.preset.drives, (index + 1) * cell.preset.drives)
        own_figures = {name: np.stack([one[name][own] for one in figures]) for name in figures[0]}
        error, belief = (
            np.stack([course[own].mean(axis=0) for course in of_seeds])
            for of_seeds in zip(*courses, strict=True)
        )
        outcomes.append(Outcome(method, person, own_figures, error, belief))
    return outcomes


def _chances(cell: AutonomyCell, seed: int, person: Person) -> FloatArray:
    """Random numbers (P, T) for one person's drives with one seed, independent of who else drives."""
    chances = generator(cell.seed, cell.task, Stream.CHANCES, seed, int.from_bytes(person.label.encode()))
    return chances.random((cell.preset.drives, steps_of(person)))
