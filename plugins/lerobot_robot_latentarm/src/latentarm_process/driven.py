"""What is driven: a run, its robot and where it starts."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final, Self, final

import numpy as np

from latentarm.assistance.controllers.latent import LatentController, latent_controller
from latentarm.control.step import Step
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot
from latentarm.runs.folder import read_run
from latentarm.runs.tasks import task_of_run
from latentarm.safety.config import SafetyConfig
from latentarm.tasks.catalogue import SCENE_TASKS
from latentarm.tasks.place import surroundings_of
from latentarm.tasks.task import Task

PERIOD_S: Final = 0.01
"""Period of the control loop: 100 Hz."""

INPUT_TIMEOUT_S: Final = 0.05
"""How long an action counts, s: one and a half periods of a program that sends 30 a second."""

INPUT_GRACE_S: Final = 0.07
"""For how much longer actions may be missing before the arm has to be enabled again, s."""


@final
@dataclass(frozen=True)
class Wanted:
    """What is to be driven, in plain values.

    Attributes:
        run: folder of a trained run.
        arm: a name of `latentarm.arms.catalogue`, or the address of a real arm.
        profile: the person whose alignment stands between input and latent action; None for z = u.
        seed: of where a simulated arm starts.
    """

    run: str
    arm: str
    profile: str | None
    seed: int

    def message(self) -> dict[str, object]:
        """As a message."""
        return asdict(self)

    @classmethod
    def of_message(cls, message: Mapping[str, Any]) -> Self:
        """From a message."""
        return cls(**message)


@final
@dataclass(frozen=True, eq=False)
class Driven:
    """What a run is driven with, loaded.

    Attributes:
        task: its robot and what the arm must keep clear of.
        controller: the run's latent actions.
        start: (n,), where a simulated arm starts, rad.
    """

    task: Task
    controller: LatentController
    start: FloatArray

    @property
    def robot(self) -> Robot:
        """The arm."""
        return self.task.robot

    def step(self) -> Step:
        """Algorithm 1 with its safety filters, disengaged."""
        return Step(
            self.robot,
            self.controller,
            SafetyConfig(
                input_timeout_s=INPUT_TIMEOUT_S,
                input_grace_s=INPUT_GRACE_S,
                release_fraction=0.8,
                command_periods=5.0,
                obstacles=tuple(self.task.obstacles),
            ),
            goals=self.task.goals,
            dt_s=PERIOD_S,
            surroundings=surroundings_of(self.task.goals, self.controller.objects),
        )


def load(wanted: Wanted) -> Driven:
    """Load what is wanted.

    Raises:
        UserError: the run or the profile cannot be loaded, or the run's task has things in physics.
    """
    run = read_run(Path(wanted.run))
    if run.task in SCENE_TASKS:
        raise UserError(
            f"{wanted.run} was trained for {run.task}, a task with things in physics, which LeRobot's tools"
            " do not show: drive it with `latentarm teleop`."
        )
    task = task_of_run(run, option=False)
    controller = latent_controller(run.folder, wanted.profile, task.robot)
    return Driven(task, controller, task.sample_start(0, np.random.default_rng(wanted.seed)))
