"""How much each level of help is worth, and what it costs, at the table with three items.

Simulated people with a reaction time and tremor drive a trained run under every arbitration: to items
that the robot knows of, and to one that it does not know of, so that its help pulls elsewhere. For example:
python scripts/help_levels.py runs/table
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final, final

import numpy as np

from latentarm.assistance.blending import Arbitration, ConfidenceAlpha, FixedAlpha
from latentarm.assistance.controllers.latent import latent_controller
from latentarm.assistance.goal_blending import blending
from latentarm.core.types import Demonstrations, FloatArray, Goal, Pose
from latentarm.robots.kinematics.obstacles import Obstacle
from latentarm.robots.robot import Robot
from latentarm.tasks.goal_task import GoalTask
from latentarm.tasks.table_top import TableTop
from latentarm.tasks.task import Task
from latentarm_research.drives.drive import Setup
from latentarm_research.drives.drives import plan_drives
from latentarm_research.drives.trace import Trace
from latentarm_research.people.catalogue import PEOPLE, OperatorName

DRIVES: Final = 8
LIMIT_S: Final = 40.0
TABLE: Final = TableTop()
WAYS: Final[dict[str, Arbitration | None]] = {
    "none": None,
    **{f"confidence {most}": ConfidenceAlpha(most) for most in (0.03, 0.05, 0.1, 0.15, 0.3, 0.5)},
    **{f"fixed {value}": FixedAlpha(value) for value in (0.05, 0.1, 0.15, 0.3, 0.5)},
}


@final
class Hover(Task):
    """To be above an item, of which the robot may not know.

    Args:
        hidden: index of the item that the robot does not know; None for none.
    """

    def __init__(self, hidden: int | None) -> None:
        self._hidden = hidden

    @property
    def name(self) -> str:
        """See the base class."""
        return "hover"

    @property
    def robot(self) -> Robot:
        """See the base class."""
        return TABLE.robot

    @property
    def goals(self) -> tuple[Goal, ...]:
        """Those that the robot knows."""
        return tuple(goal for number, goal in enumerate(TABLE.goals) if number != self._hidden)

    @property
    def manners(self) -> tuple[str, ...]:
        """See the base class."""
        return ("hover",)

    @property
    def obstacles(self) -> Sequence[Obstacle]:
        """See the base class."""
        return TABLE.obstacles

    def sample_start(self, goal: int, rng: np.random.Generator) -> FloatArray:
        """See the base class."""
        return TABLE.sample_start(goal, rng)

    def waypoints(self, goal: int, manner: str) -> tuple[Pose, ...]:
        """The item's own place, known to the robot or not."""
        return (TABLE.goals[goal if self._hidden is None else self._hidden].pose,)

    def reached(self, pose: Pose, waypoint: Pose) -> bool:
        """Within 3 cm: what the page calls there."""
        return bool(np.linalg.norm(pose.position - waypoint.position) <= 0.03)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """See the base class."""
        return TABLE.demonstrate(episodes, rng)


def main(run: Path, person: OperatorName) -> None:
    """Drive, and print a line for each arbitration."""
    controller = latent_controller(run, None, TABLE.robot, None)
    for name, arbitration in WAYS.items():
        way = None if arbitration is None else blending(arbitration)
        setups = {
            item: Setup(GoalTask(Hover(item), "hover", LIMIT_S), controller, PEOPLE[person], way)
            for item in (None, *range(len(TABLE.goals)))
        }
        known = [one.drive() for one in plan_drives([[setups[None]]], DRIVES, 0)]
        hidden = [
            one.drive()
            for item in range(len(TABLE.goals))
            for one in plan_drives([[setups[item]]], DRIVES, item)[:DRIVES]
        ]
        print(f"{person}, {name}: known {figures(known)}; not known {figures(hidden)}", flush=True)


def figures(drives: list[Trace]) -> str:
    """How many arrive, and how long they take; those that fail count with the whole time."""
    took = [trace.figures.time_s for trace in drives]
    arrived = sum(trace.figures.success for trace in drives)
    return f"{arrived} of {len(drives)}, median {np.median(took):.1f} s, mean {np.mean(took):.1f} s"


if __name__ == "__main__":
    main(Path(sys.argv[1]), "unsteady")
