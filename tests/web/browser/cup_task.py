"""A task with things as another distribution has it: a cup between the open fingers of a Panda."""

import numpy as np

from latentarm.core.types import Pose
from latentarm.robots.catalogue import load_robot
from latentarm.robots.scene.containers import cup
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Thing
from latentarm.tasks.inverse_kinematics import solve
from latentarm.tasks.scene_task import Beginning, SceneTask

CUP_AT = np.array([0.5, 0.0, 0.0])
GRIP = np.array([0.0, 0.0, 0.07])
DOWN = np.diag([1.0, -1.0, -1.0])


class CupAtHand(SceneTask):
    """Lift the cup, and set it down again."""

    name = "cup_at_hand"
    robot = load_robot("panda")
    choices = ("the cup",)
    obstacles = (Scene().table,)
    time_limit_s = 60.0

    def begin(self, choice, rng):
        """The hand is about the cup already."""
        state = solve(self.robot, Pose(CUP_AT + GRIP, DOWN), self.robot.home)
        thing = Thing("cup", cup(radius_m=0.025).parts, mass_kg=0.08, pose=Pose(CUP_AT, np.eye(3)))
        return Beginning(state, Scene((thing,)), (), (), (), ("cup",), "lift the cup")
