"""Drives to the goals of the demo's table by a simulated person whose stick does not do what they expect.

The person answers the questions of `latentarm align` by their expectation and drives by it: at each decision
they choose by equation 24, with the motion that they expect in place of the decoder's. The same person drives
in every condition but one: in `KNOWS` the person predicts exactly what z = u does, like the simulated
operator of the demo. That is the best this decoder can do.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from latentarm.assistance.blending import FixedAlpha
from latentarm.assistance.controllers.latent import LatentController
from latentarm.assistance.goal_blending import blending
from latentarm.core.types import FloatArray, StepRecord
from latentarm.tasks.goal_task import GoalTask
from latentarm.tasks.table_top import TableTop
from latentarm.tasks.task import Task
from latentarm_research.drives.drive import RATE_HZ, Setup
from latentarm_research.drives.drives import Planned, plan_drives
from latentarm_research.people.person import Person
from latentarm_research.studies.alignment.drives_learning import AlignedDriveCell, Learned, learn
from latentarm_research.studies.alignment.preset import (
    ALL_PRIORS,
    IDEAL,
    NO_ALIGN,
    TOOL_SPACE,
    WITHOUT_PRIORS,
)

HELPED: Final = f"{TOOL_SPACE}, shared autonomy"
KNOWS: Final = "knows the arm"
DRIVEN: Final = (NO_ALIGN, WITHOUT_PRIORS, ALL_PRIORS, TOOL_SPACE, HELPED, IDEAL, KNOWS)
"""All conditions, as tables and figures order them."""

PATH_HZ: Final = 10.0  # rate at which paths are kept


@dataclass(frozen=True, eq=False)
class AlignedDrive:
    """One drive."""

    goal: int  # index of the goal
    model_seed: int  # whose decoder
    reached_s: float | None  # when the tool came to the goal, or None where it never did, s
    done: bool  # whether it went on to stab or scoop before the time was over
    path: FloatArray  # (T, 3), the tool until it came to the goal, or all along, m


@dataclass(frozen=True, eq=False)
class DrivesResult:
    """Results of one cell."""

    cell: AlignedDriveCell
    # condition -> all drives, from the same starts in the same order everywhere
    drives: Mapping[str, tuple[AlignedDrive, ...]]
    errors: Mapping[str, FloatArray]  # condition -> (S,), see `Learned`
    directions: FloatArray  # (2, 3), that the person expects of the stick, in the base frame
    speed_m_s: float  # of the tool, that they expect of a full push along one axis, m/s


def measure_drives(cell: AlignedDriveCell) -> DrivesResult:
    """Learn, and drive in every condition. Raises a `UserError` where the preset's sizes make no sense."""
    learned = learn(cell)
    drives = {condition: drive_all(cell, learned, condition) for condition in DRIVEN}
    return DrivesResult(
        cell=cell,
        drives=drives,
        errors=learned.errors,
        directions=learned.person.directions,
        speed_m_s=learned.person.speed_m_s,
    )


def drive_all(cell: AlignedDriveCell, learned: Learned, condition: str) -> tuple[AlignedDrive, ...]:
    """All drives of one condition of `DRIVEN`; models take turns.

    Starts and the simulated person's random choices depend only on the study's seed, the goal and the drive's
    number.
    """
    sizes, task = cell.preset.drives, TableTop()
    setups = [
        [
            _setup(GoalTask(task, manner, sizes.limit_s), learned, seed, condition)
            for seed in range(sizes.seeds)
        ]
        for manner in task.manners
    ]
    plan = plan_drives(setups, sizes.to_each_goal, cell.seed)
    return tuple(drive(task, planned, number % sizes.seeds) for number, planned in enumerate(plan))


def drive(task: Task, planned: Planned, model_seed: int) -> AlignedDrive:
    """One drive: to the goal, and on to stab or scoop there."""
    goal, records = planned.choice, list[StepRecord]()
    trace = planned.drive(record=lambda _: records.append)
    # A drive that ends at the goal has no record there.
    at_the_end = trace.figures.time_s if trace.figures.success else None
    reached_s = next((record.time_s for record in records if _there(task, goal, record)), at_the_end)
    until = trace.time_s <= (np.inf if reached_s is None else reached_s)
    return AlignedDrive(
        goal=goal,
        model_seed=model_seed,
        reached_s=reached_s,
        done=trace.figures.success,
        path=trace.position[until][:: round(RATE_HZ / PATH_HZ)],
    )


def _there(task: Task, goal: int, record: StepRecord) -> bool:
    return task.reached(task.robot.chain.forward(record.state), task.goals[goal].pose)


def _setup(task: GoalTask, learned: Learned, seed: int, condition: str) -> Setup:
    alignment = {KNOWS: NO_ALIGN, HELPED: TOOL_SPACE}.get(condition, condition)
    return Setup(
        task,
        LatentController(learned.model.decoder(seed), learned.alignments[seed][alignment]),
        Person(imagines=None if condition == KNOWS else learned.person),
        blending(FixedAlpha()) if condition == HELPED else None,
    )
