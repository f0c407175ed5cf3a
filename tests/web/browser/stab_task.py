"""A task with things as another distribution has it: the fork is over a marshmallow, or over the plate."""

import numpy as np

from latentarm.robots.catalogue import load_robot
from latentarm.robots.scene.scene import Scene
from latentarm.tasks.eating.stabbing import above, stab
from latentarm.tasks.eating.table import fork, marshmallow, plate
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.predicates import Pressed
from latentarm.tasks.scene_task import Beginning, SceneTask

PLATE_AT = np.array([0.5, 0.0])
SPREAD_M = 0.02
OVER_M = 0.08
BESIDE_M = np.array([0.0, 0.06, 0.0])
HARD_N = 3.0


class StabBelow(SceneTask):
    """Stab what is under the fork. With the second choice that is the plate, which must not be pressed."""

    name = "stab_below"
    robot = load_robot("panda_fork")
    choices = ("marshmallow", "plate")
    obstacles = (Scene().table,)
    time_limit_s = 60.0

    def begin(self, choice, rng):
        """The marshmallow anywhere about the middle of the plate, the fork over it or next to it."""
        x, y = PLATE_AT + rng.uniform(-SPREAD_M, SPREAD_M, 2)
        food = marshmallow("marshmallow", float(x), float(y))
        over = food.pose.position + choice * BESIDE_M
        return Beginning(
            state=solve(self.robot, fork(over, OVER_M), self.robot.home),
            scene=Scene((plate("plate", *PLATE_AT), food)),
            steps=(above("marshmallow"), stab("marshmallow")),
            failures=(Pressed("plate", HARD_N),),
            goals=(),
            objects=("marshmallow",),
            text="stab what is below",
        )
