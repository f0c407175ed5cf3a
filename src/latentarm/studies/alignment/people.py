"""What the simulated person means by the stick in each task (section 8.3)."""

from latentarm.kinematics.chain import Chain
from latentarm.operators.preference import ByPlace, HeightAndTilt, Preference, ToolAxes
from latentarm.tasks.pouring.tasks import at_bowl
from latentarm.tasks.pouring.tool_path import SPEED_M_S, TURN_RAD_S


def preference_of(task: str, chain: Chain) -> Preference:
    """What is meant in a task: a full push is the fastest motion of the demonstrations.

    Args:
        task: a name of `POURING_TASKS`.
        chain: the arm.
    """
    plane = ToolAxes(chain, 2, SPEED_M_S)
    pour = HeightAndTilt(chain, SPEED_M_S, TURN_RAD_S)
    return {"plane": plane, "pour": pour, "reach_and_pour": ByPlace(chain, at_bowl, pour, plane)}[task]
