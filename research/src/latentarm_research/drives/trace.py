"""The record of a simulated drive."""

from dataclasses import dataclass
from typing import final

from latentarm.core.types import FloatArray
from latentarm.robots.scene.scene import SceneState
from latentarm.tasks.steps import TaskStep
from latentarm_research.metrics.drives import Drive
from latentarm_research.metrics.ending import Ending
from latentarm_research.metrics.preference_alignment import StepAlignment


@final
@dataclass(frozen=True, eq=False)
class Trace:
    """The record of a drive, sampled at the loop's rate."""

    figures: Drive  # what is measured of it
    choice: int  # index into the task's choices, such as the goal
    text: str  # what was to be done, in words
    steps: tuple[TaskStep, ...]  # the same, in order
    done_s: tuple[float, ...]  # when each of the steps that were done was done, s
    target: FloatArray  # (3,), where the tool was to go first, m
    ending: Ending  # why it ended
    time_s: FloatArray  # (T,), s
    position: FloatArray  # (T, 3), the tool, m
    input: FloatArray  # (T, d)
    delay_s: FloatArray  # (T,), see `StepRecord.delay_s`
    mode: FloatArray  # (T,), index of the controller's mode
    belief: FloatArray  # (T, G)
    aligned: tuple[StepAlignment, ...]  # *Preference Alignment* in each step that was begun, in order
    states: tuple[SceneState, ...]  # how things stood, ten times per second, for film

    @property
    def ended_in(self) -> str:
        """The step that was not done, in words; "" where all were."""
        done = len(self.done_s)
        return self.steps[done].name if done < len(self.steps) else ""
