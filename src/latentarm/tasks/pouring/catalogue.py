"""The tasks of section 8.3 by name."""

from collections.abc import Callable
from typing import Final

from latentarm.tasks.pouring.plane import Plane
from latentarm.tasks.pouring.pour import Pour
from latentarm.tasks.pouring.reach_and_pour import ReachAndPour
from latentarm.tasks.pouring.task import PouringTask

POURING_TASKS: Final[dict[str, Callable[[], PouringTask]]] = {
    "plane": Plane,
    "pour": Pour,
    "reach_and_pour": ReachAndPour,
}
