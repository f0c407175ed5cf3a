"""A task and a measure for studies: one marshmallow to stab, and how fast the fork moved."""

import numpy as np

from latentarm.evaluation.measures import Measure
from latentarm.robots.scene.scene import Scene
from latentarm.tasks.eating.fork_task import ForkTask, fallen
from latentarm.tasks.eating.stabbing import above, stab
from latentarm.tasks.eating.table import marshmallow, plate
from latentarm.tasks.scene_task import Beginning
from latentarm_research.drives.trace import Trace
from latentarm_research.user_studies.own.measures import OwnMeasure

PLATE_AT_M = (0.5, 0.0)
SPREAD_M = 0.05


class OneBite(ForkTask):
    """Stab the marshmallow."""

    name = "one_bite"
    choices = ("marshmallow",)
    time_limit_s = 60.0

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        x, y = PLATE_AT_M + rng.uniform(-SPREAD_M, SPREAD_M, 2)
        food = marshmallow("marshmallow", float(x), float(y))
        return Beginning(
            state=self.start(rng),
            scene=Scene((plate("plate", *PLATE_AT_M), food)),
            steps=(above("marshmallow"), stab("marshmallow")),
            failures=fallen("marshmallow"),
            goals=self.goals((food,)),
            objects=("marshmallow",),
            text="stab the marshmallow",
        )


def highest_speed(drive: Trace) -> float:
    """That of the tool between two samples, m/s; NaN for a drive of one sample."""
    way_m = np.linalg.norm(np.diff(drive.position, axis=0), axis=1)
    return float((way_m / np.diff(drive.time_s)).max()) if len(way_m) else float("nan")


HIGHEST_SPEED = OwnMeasure(
    Measure("m/s", "highest speed", None, "highest speed of the tool between two samples of a drive"),
    highest_speed,
)
