"""Measure what each level of help is worth, and what it costs, at the table with three items.

A homogeneous model learns from demonstrations. Simulated people with a reaction time and tremor drive it
with every level of help on the page: to items that the robot knows, and to one that it does not know, so that
its help pulls elsewhere.
"""

from typing import Any, Final, final

import numpy as np

from latentarm.assistance.controllers.latent import LatentController
from latentarm.assistance.goal_blending import blending
from latentarm.core.types import Demonstrations, FloatArray, Goal, Pose
from latentarm.models.decoder import Decoder
from latentarm.models.estimators import MODELS
from latentarm.robots.robot import Robot
from latentarm.tasks.goal_task import GoalTask
from latentarm.tasks.table_top import TableTop
from latentarm.tasks.task import REACHED_DISTANCE, Task
from latentarm.web.arm_process.help import LEVELS
from latentarm_research.drives.drive import Setup
from latentarm_research.drives.drives import Planned, drive_all, plan_drives
from latentarm_research.measurements.catalogue import Help
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.people.catalogue import PEOPLE

TABLE: Final = TableTop()


def measure(options: Help, work: Work) -> Outcome:
    """How many arrive at items that the robot knows or not; times of all drives, failed ones too."""
    demonstrations = TABLE.demonstrate(options.episodes, np.random.default_rng(work.seed))
    few: dict[str, Any] = {} if options.epochs is None else {"epochs": options.epochs}
    model = MODELS["homogeneous"](seed=work.seed, **few).fit(demonstrations)
    controller = LatentController(Decoder(model.trained_))
    rows = []
    for level, arbitration in LEVELS.items():
        way = None if level == "off" else blending(arbitration)
        for place, hidden in (("known", [None]), ("not known", range(len(TABLE.goals)))):
            planned = list[Planned]()
            for item in hidden:
                task = GoalTask(Hover(item), "hover", options.limit_s)
                setup = Setup(task, controller, PEOPLE["unsteady"], way)
                plan = plan_drives([[setup]], options.drives, work.seed + (item or 0))
                # A hidden item is the aim whichever goal is named: those of one goal are enough.
                planned += plan if item is None else plan[: options.drives]
            (traces,) = drive_all([planned], work.jobs, bars=work.bars)
            drives = [trace.figures for trace in traces]
            times = [one.time_s for one in drives]
            figures = {
                "reached": sum(one.success for one in drives),
                "time_median_s": np.median(times),
                "time_mean_s": np.mean(times),
            }
            rows += line("help", level, len(drives), figures, f"item {place}")
    return Outcome(rows)


@final
class Hover(Task):
    """To be above an item, of which the robot may not know."""

    name = "hover"
    manners = ("hover",)
    obstacles = TABLE.obstacles

    def __init__(
        self,
        hidden: int | None,  # index of the item that the robot does not know; None for none
    ) -> None:
        self._hidden = hidden

    @property
    def robot(self) -> Robot:
        """See the base class."""
        return TABLE.robot

    @property
    def goals(self) -> tuple[Goal, ...]:
        """Those that the robot knows."""
        return tuple(goal for number, goal in enumerate(TABLE.goals) if number != self._hidden)

    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        """See the base class."""
        return TABLE.sample_start(goal, rng)

    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        """The item's own place, known to the robot or not."""
        return (TABLE.goals[goal if self._hidden is None else self._hidden].pose,)

    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        """Return whether the tool is within `REACHED_DISTANCE`, in any orientation."""
        return bool(np.linalg.norm(pose.position - waypoint.position) <= REACHED_DISTANCE)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """See the base class."""
        return TABLE.demonstrate(episodes, rng)
