"""One simulated person's way through one condition of a study."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from threadpoolctl import threadpool_limits

from latentarm.alignment.contract import identity
from latentarm.tasks.scene_task import SceneTask
from latentarm_research.drives.drive import Setup, drive
from latentarm_research.people.person import Person
from latentarm_research.people.traits import Traits
from latentarm_research.studies.streams import generator
from latentarm_research.user_studies.conditions import assistance_of, belief_of, controller_of
from latentarm_research.user_studies.definition import Condition, Definition, StudyTask
from latentarm_research.user_studies.drive_record import DriveContext, DriveRecord, record_of, trial_of
from latentarm_research.user_studies.record import Trial
from latentarm_research.user_studies.scenes import scene_of
from latentarm_research.user_studies.sizes import Sizes, Stream
from latentarm_research.user_studies.trace import Trace
from latentarm_research.user_studies.training import Trained

LEAST_S: Final = 1.0  # people begin no attempt for which less time than this is left, s


@final
@dataclass(frozen=True, eq=False)
class SessionCell:
    """A person with one condition at one task."""

    definition: Definition  # of the study
    condition: Condition  # that they drive with
    task: StudyTask  # what they do
    traits: Traits  # of the person
    order: int  # place of the condition in the person's order
    trained: Trained | None  # models of the task; None where the condition has none
    sizes: Sizes  # of the run
    seed: int  # of the run


@final
@dataclass(frozen=True, eq=False)
class Session:
    """The result of a `SessionCell`."""

    trials: tuple[Trial, ...]  # in order
    traces: tuple[Trace, ...]  # of each, for figures


def go_through(cell: SessionCell) -> Session:
    """Let the person do all trials of the task.

    The scene, start and chances of an attempt depend on the seed, the person, the task and the numbers of
    trial and attempt alone: they are the same in every condition.
    """
    trials: list[Trial] = []
    traces: list[Trace] = []
    with threadpool_limits(limits=1):
        for number in range(min(cell.task.trials, cell.sizes.most_trials)):
            driven = [
                drive
                for choice in choices_of(cell.task, cell.traits.number, number)
                for drive in _attempts(cell, number, choice)
            ]
            trials.append(trial_of(cell.definition.measures, driven))
            traces += [drive.trace for drive in driven]
    return Session(tuple(trials), tuple(traces))


def choices_of(task: StudyTask, person: int, number: int) -> tuple[int, ...]:
    """What a trial is for: all choices one after the other, or the next in turn.

    People begin with different ones.
    """
    if task.all_choices:
        return task.choices
    return (task.choices[(person + number) % len(task.choices)],)


def _attempts(cell: SessionCell, number: int, choice: int) -> list[DriveRecord]:
    """One drive, and where the trial's time allows it another one after each that failed."""
    task = scene_of(cell.task.scene)
    driven: list[DriveRecord] = []
    while (left_s := left_for(cell.task, cell.sizes, task, driven)) is not None:
        driven.append(_drive(cell, task, left_s, number, choice, len(driven)))
    return driven


def left_for(task: StudyTask, sizes: Sizes, scene: SceneTask, driven: Sequence[DriveRecord]) -> float | None:
    """Time for the next drive at a choice after those so far, s; None where there is to be no other one."""
    if driven and (driven[-1].trace.success or not task.trial_s):
        return None
    left_s = min(task.trial_s or scene.time_limit_s, sizes.trial_s)
    for one in driven:
        left_s -= one.measures["time_s"]
    return None if driven and left_s < LEAST_S else left_s


def _drive(
    cell: SessionCell, task: SceneTask, left_s: float, number: int, choice: int, attempt: int
) -> DriveRecord:
    person = cell.traits.number
    condition, trained, robot = cell.condition, cell.trained, task.robot
    decoder = None if trained is None else trained.decoder(condition)
    alignment = identity if trained is None else trained.alignment(condition, person)
    controller = controller_of(condition, robot, decoder, alignment)
    helped, rule = assistance_of(condition, robot), belief_of(condition, robot)
    setup = Setup(task, controller, _person(cell, number), helped, rule=rule)
    use = (Stream.TRIALS, person, number, attempt)
    rng = generator(cell.seed, f"{cell.definition.name} {cell.task.name}", *use)
    driven = drive(setup, choice, rng, time_limit_s=left_s)
    where = DriveContext("simulated", person, condition.name, cell.order, number, attempt)
    return record_of(where, cell.task, driven)


def _person(cell: SessionCell, number: int) -> Person:
    """Who they are in this trial: a newcomer where the study is about what they mean by the stick."""
    practice_s = 60.0 * cell.definition.practice_min
    if cell.trained is not None and cell.trained.aligned is not None:
        return cell.traits.newcomer(cell.trained.aligned.usual, number, practice_s)
    return cell.traits.person(number, practice_s)
