"""Measure what help at the steps of a task is worth: goals that stay or move, a way back or none."""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from statistics import fmean
from typing import Any, Final, final

from threadpoolctl import threadpool_limits

from latentarm.assistance.assistance import AssistanceRule
from latentarm.assistance.belief import Rule
from latentarm.assistance.blending import ConfidenceAlpha, FixedAlpha
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.controllers.latent import LatentController
from latentarm.assistance.goal_blending import blending
from latentarm.core.types import Demonstrations
from latentarm.models.catalogue import DEFAULT_MODEL
from latentarm.models.decoder import Decoder
from latentarm.models.kind import TrainedModel
from latentarm.models.way_back.training import NoWayBackWarning
from latentarm.robots.robot import Robot
from latentarm.tasks.catalogue import make_scene_task
from latentarm.tasks.scene_task import Beginning, SceneTask
from latentarm_research.drives.demonstrate import demonstrate
from latentarm_research.drives.drive import Setup
from latentarm_research.drives.drives import Planned, drive_all, plan_drives
from latentarm_research.measurements.catalogue import StepHelp
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.people.catalogue import PEOPLE
from latentarm_research.people.names import OperatorName
from latentarm_research.studies.fitting import fit_model, validation_episodes
from latentarm_research.user_studies.scenes import AdaptedTask

WAY_BACK_M: Final = 0.06
MODELS: Final[Mapping[str, tuple[str, tuple[str, ...]]]] = {
    "cvae": ("cvae", ("joints",)),
    DEFAULT_MODEL: (DEFAULT_MODEL, ("joints", "objects_in_tool")),
}
"""Kind and context by name."""

CONFIDENT: Final = blending(ConfidenceAlpha(0.3))
WAYS: Final[Mapping[str, tuple[AssistanceRule | None, bool, Rule]]] = {
    "no help": (None, True, BoltzmannBelief),
    "goals stay, alpha 0.15": (blending(FixedAlpha()), False, BoltzmannBelief),
    "goals move on, alpha 0.15": (blending(FixedAlpha()), True, BoltzmannBelief),
    "goals move on, confidence": (CONFIDENT, True, BoltzmannBelief),
    "goals move on, confidence, memory 2 s": (CONFIDENT, True, partial(BoltzmannBelief, memory_s=2.0)),
}
"""Help, whether the goals move on, and how inputs change the belief."""


def staying(begun: Beginning) -> Beginning:
    """The same start with goals that stay, because nothing in the scene has their names."""
    return replace(begun, goals=tuple(replace(goal, name=f"over {goal.name}") for goal in begun.goals))


@final
@dataclass(frozen=True, eq=False)
class _Fit:
    name: str
    way_back: bool
    demonstrations: Demonstrations
    robot: Robot
    seed: int
    few: Mapping[str, Any]

    def __str__(self) -> str:
        return f"{self.name}{' + way back' if self.way_back else ''}"


def measure(options: StepHelp, work: Work) -> Outcome:
    """How many drives finish the task; times of all drives, failed ones too."""
    rows = []
    for name in options.tasks:
        task = make_scene_task(name)
        shown, _ = demonstrate(task, options.episodes, work.seed, work.jobs, bars=work.bars)
        few = {} if options.epochs is None else {"epochs": options.epochs}
        fits = [
            _Fit(model, way_back, shown, task.robot, work.seed, few)
            for model in MODELS
            for way_back in (False, True)
        ]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NoWayBackWarning)  # the condition says so
            fitted = work.each(_fitted, fits)
        models = {
            f"{fit}{' (refused)' if fit.way_back and not model.dimensions.way_back else ''}": model
            for fit, model in zip(fits, fitted, strict=True)
        }
        planned = dict(_planned(options, task, models, work.seed))
        traces = drive_all(list(planned.values()), work.jobs, bars=work.bars)
        for (condition, person), drives in zip(planned, traces, strict=True):
            figures = {
                "done": sum(one.figures.success for one in drives),
                "steps_done": fmean(one.figures.steps_done for one in drives),
                "time_mean_s": fmean(one.figures.time_s for one in drives),
            }
            rows += line("step-help", f"{condition}, {person}", len(drives), figures, name)
    return Outcome(rows)


def _planned(
    options: StepHelp, task: SceneTask, models: Mapping[str, TrainedModel], seed: int
) -> Iterator[tuple[tuple[str, OperatorName], list[Planned]]]:
    for model, trained in models.items():
        controller = LatentController(Decoder(trained))
        for way, (assistance, move_on, rule) in WAYS.items():
            place = AdaptedTask(task, options.limit_s, None if move_on else staying)
            for person in options.people:
                setup = Setup(place, controller, PEOPLE[person], assistance, rule=rule)
                yield (f"{model}, {way}", person), plan_drives([[setup]], options.drives, seed)


def _fitted(cell: _Fit) -> TrainedModel:
    kind, context = MODELS[cell.name]
    with threadpool_limits(limits=1):
        return fit_model(
            kind,
            cell.demonstrations,
            validation=validation_episodes(cell.demonstrations),
            fit={"chain": cell.robot.chain},
            latent_dim=2,
            context=context,
            seed=cell.seed,
            state_noise_rad=0.01,
            way_back_m=WAY_BACK_M if cell.way_back else 0.0,
            **cell.few,
        ).trained_
