"""The help of HARMONIC: between the person's action and the robot's, at a fixed weight.

Newman, Aronson, Srinivasa, Kitani and Admoni, "HARMONIC: A multimodal dataset of assistive human-robot
collaboration", 2022.
"""

from typing import Final, Literal, final

from latentarm.assistance.assistance import Contribution
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot
from latentarm_research.assistance.expected_help import ExpectedHelp
from latentarm_research.assistance.goal_poses import PosesOf, that_pose

Level = Literal["no", "low", "high", "full"]

WEIGHTS: Final[dict[Level, float]] = {"no": 0.0, "low": 1 / 3, "high": 2 / 3, "full": 1.0}
"""The weight on assistance at each of HARMONIC's levels. Losey et al. say that High gives assistance twice
the weight, which is 2/3; the others are read from that."""


@final
class Interpolation(ExpectedHelp):
    """``a = (1 - w) a_h + w Σ_g b(g) a_g``, where a_g is the robot's best action towards a goal.

    The robot's action and the belief are those of hindsight optimisation; only how they join the person's
    action differs. At weight 1 the person's input moves nothing, and still says which goal they want.

    Args:
        goals: (G, n), rad.
        robot: the arm.
        weight: w in [0, 1], see `WEIGHTS`.
        poses_of: at which poses a goal is reached.

    Raises:
        UserError: the weight is out of its range, or a goal has too many poses.
    """

    def __init__(self, goals: FloatArray, robot: Robot, weight: float, poses_of: PosesOf = that_pose) -> None:
        if not 0.0 <= weight <= 1.0:
            raise UserError(f"The weight on assistance must be in [0, 1], not {weight}.")
        super().__init__(goals, robot, poses_of)
        self._weight = weight

    @property
    def acts_at_rest(self) -> bool:
        """Wherever the robot has any weight."""
        return self._weight > 0.0

    def contribution(
        self, u: FloatArray, action_human: FloatArray, state: FloatArray, belief: FloatArray
    ) -> Contribution:
        """The robot's action, at its weight."""
        return Contribution(self.action(action_human, state, belief), alpha=self._weight)
