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
    """The record of a drive, sampled at the loop's rate.

    Attributes:
        figures: what is measured of it.
        choice: index into the task's choices, such as the goal.
        text: what was to be done, in words.
        steps: the same, in order.
        done_s: when each of the steps that were done was done, s.
        target: (3,), where the tool was to go first, m.
        ending: why it ended.
        time_s: (T,), s.
        position: (T, 3), the tool, m.
        input: (T, d).
        mode: (T,), index of the controller's mode.
        belief: (T, G).
        aligned: *Preference Alignment* in each step that was begun, in order.
        states: how things stood, ten times per second, for film.
    """

    figures: Drive
    choice: int
    text: str
    steps: tuple[TaskStep, ...]
    done_s: tuple[float, ...]
    target: FloatArray
    ending: Ending
    time_s: FloatArray
    position: FloatArray
    input: FloatArray
    mode: FloatArray
    belief: FloatArray
    aligned: tuple[StepAlignment, ...]
    states: tuple[SceneState, ...]

    @property
    def ended_in(self) -> str:
        """The step that was not done, in words; "" where all were."""
        done = len(self.done_s)
        return self.steps[done].name if done < len(self.steps) else ""
