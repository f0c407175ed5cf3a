"""Tasks whose things stand where the demonstrations never had them, as in the paper's second user study."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final, final

from latentarm.tasks.catalogue import SCENE_TASKS, make_scene_task
from latentarm.tasks.eating.marshmallows import Marshmallows
from latentarm.tasks.scene_task import SceneTask
from latentarm.tasks.serving.reach_and_pour import ReachAndPour
from latentarm_research.studies.tasks.preset import Stream


@final
@dataclass(frozen=True)
class Moved:
    """A task in two places."""

    seen: Callable[[], SceneTask]  # where it is demonstrated
    unseen: Callable[[], SceneTask]  # where it is driven
    about: str  # where the things stand in either, in words


MOVED: Final[Mapping[str, Moved]] = {
    "moved_marshmallows": Moved(
        partial(Marshmallows, ((0.47, 0.53), (-0.10, 0.0))),
        partial(Marshmallows, ((0.47, 0.53), (0.0, 0.10))),
        "the plate's middle is up to 10 cm to the right of the arm's middle in demonstrations, and up to"
        " 10 cm to the left of it in the runs",
    ),
    "moved_reach_and_pour": Moved(
        partial(ReachAndPour, ((0.53, 0.62), (-0.28, -0.18)), ((0.54, 0.60), (0.12, 0.18))),
        partial(ReachAndPour, ((0.53, 0.62), (-0.18, -0.08)), ((0.54, 0.60), (0.18, 0.24))),
        "the cup stands 18 to 28 cm to the right of the arm's middle in demonstrations, and 8 to 18 cm in the"
        " runs; the bowl 12 to 18 cm to the left, and 18 to 24 cm",
    ),
}

TASKS: Final = (*SCENE_TASKS, *MOVED)  # names of all tasks of the study


def task_of(name: str, stream: Stream) -> SceneTask:
    """The task of that name, where it is demonstrated to models or where it is driven."""
    if name not in MOVED:
        return make_scene_task(name)
    moved = MOVED[name]
    return moved.seen() if stream is Stream.DEMONSTRATIONS else moved.unseen()
