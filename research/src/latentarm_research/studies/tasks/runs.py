"""One run of a task with things, by the scripted demonstrator or by a simulated person who drives."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import final

from latentarm.assistance.controllers.contract import Controller
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.joined import JoinedController
from latentarm.assistance.controllers.latent import LatentController
from latentarm.models.decoder import Decoder
from latentarm.models.kind import TrainedModel
from latentarm.robots.robot import Robot
from latentarm.tasks.scene_task import SceneTask
from latentarm.tasks.steps import TaskStep
from latentarm_research.baselines.learned_orientation import LearnedOrientationController, OrientationMap
from latentarm_research.drives.demonstrate import Demonstration
from latentarm_research.drives.trace import Trace
from latentarm_research.metrics.drives import Drive
from latentarm_research.studies.tasks.preset import Condition


@final
@dataclass(frozen=True, eq=False)
class Driver:
    """What a simulated person steers with."""

    condition: Condition  # what it is called
    decoders: tuple[Decoder, ...] = ()  # of the models, which take turns
    # of the tool, where the person only moves it. Without either they switch modes
    orientation: OrientationMap | None = None

    def controller(self, robot: Robot, number: int) -> Controller:
        """The controller of one run."""
        if self.orientation is not None:
            return LearnedOrientationController(robot, self.orientation)
        if not self.decoders:
            return EndEffectorController(robot)
        latent = LatentController(self.decoders[number % len(self.decoders)])
        return JoinedController([latent, EndEffectorController(robot)]) if self.condition.beside else latent


@final
@dataclass(frozen=True, eq=False)
class Run:
    """How one run went."""

    number: int  # of the run; the same number is the same scene and the same start in every condition
    choice: str  # what was to be done, in the task's words
    steps: tuple[str, ...]  # kinds of the task's steps, in order
    done: int  # how many of them were done
    success: bool  # all of them, and nothing went wrong
    ended_in: str  # the step that was not done, in words; "" where all were
    why: str  # why the run ended, in a few words
    time_s: float  # how long it took, s
    figures: Drive | None = None  # what is measured of a drive; None for the demonstrator, who has no stick

    def as_json(self) -> dict[str, object]:
        """Plain mapping; what has no value is None."""
        entries = asdict(self)
        del entries["figures"]
        return (self.figures.as_json() if self.figures else {}) | entries


def decoders_of(model: TrainedModel) -> tuple[Decoder, ...]:
    """The decoders of all seeds of a model."""
    return tuple(Decoder(model, seed) for seed in range(model.dimensions.seeds))


def kept_in(task: str, condition: Condition) -> str:
    """The folder of a condition's model, among those of the study's models."""
    return f"{task}/{condition.folder}"


def time_ratios(runs: Sequence[Run], beside: Sequence[Run]) -> list[float]:
    """Times of runs, compared with others of the same scenes and starts, where both succeeded."""
    others = {run.number: run.time_s for run in beside if run.success}
    return [run.time_s / others[run.number] for run in runs if run.success and run.number in others]


def choice_of(task: SceneTask, number: int) -> int:
    """What a run is for: the task's choices in turn."""
    return number % len(task.choices)


def shown_run(task: SceneTask, number: int, shown: Demonstration) -> Run:
    """A run of the scripted demonstrator."""
    progress = shown.progress
    return Run(
        number=number,
        choice=task.choices[choice_of(task, number)],
        steps=_kinds(progress.steps),
        done=progress.done,
        success=progress.succeeded,
        ended_in="" if progress.step is None else progress.step.name,
        why=progress.failure.text if progress.failure else ("done" if progress.succeeded else "out of time"),
        time_s=shown.seconds,
    )


def driven_run(task: SceneTask, number: int, trace: Trace) -> Run:
    """A run in which a simulated person drove."""
    return Run(
        number=number,
        choice=task.choices[trace.choice],
        steps=_kinds(trace.steps),
        done=len(trace.done_s),
        success=trace.figures.success,
        ended_in=trace.ended_in,
        why=trace.ending.detail,
        time_s=trace.figures.time_s,
        figures=trace.figures,
    )


def step_names(runs: Sequence[Run]) -> list[str]:
    """The kind of each step, in order; several where they differ from run to run."""
    most = max(len(run.steps) for run in runs)
    return [
        " or ".join(dict.fromkeys(run.steps[index] for run in runs if index < len(run.steps)))
        for index in range(most)
    ]


def _kinds(steps: Sequence[TaskStep]) -> tuple[str, ...]:
    return tuple(step.kind for step in steps)
