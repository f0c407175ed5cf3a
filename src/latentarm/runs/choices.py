"""Types of options whose choices are the names in a catalogue, plug-ins included."""

from typing import TYPE_CHECKING, Literal

from latentarm.assistance.catalogue import BELIEFS
from latentarm.models.catalogue import KINDS
from latentarm.tasks.catalogue import HELD_OUT, SCENE_TASKS, TASKS

if TYPE_CHECKING:
    BeliefName = str
    ModelName = str
    TaskName = str
else:
    BeliefName = Literal[tuple(BELIEFS)]
    ModelName = Literal[tuple(KINDS)]
    TaskName = Literal[(*TASKS, *SCENE_TASKS, HELD_OUT)]
