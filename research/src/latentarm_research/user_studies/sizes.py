"""How large a run of a study with simulated people is; none of it belongs to the definition."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm_research.studies.page import SMOKE
from latentarm_research.user_studies.definition import StudyTask
from latentarm_research.user_studies.record import PeopleAre


@final
@dataclass(frozen=True)
class Sizes:
    """Sizes of a run."""

    name: str  # of the preset
    simulated: int = 0  # people who are sent through the study; 0 where people are real
    # a trial that takes longer has failed, s; the task's own limit where it is shorter
    trial_s: float = float("inf")
    most_trials: int = 1000  # of each task in each condition, at most
    demonstrations_share: float = 1.0  # of the minutes of demonstrations that the definition asks for
    # a demonstration is cut off after so long, s; then it counts although it was not done
    demonstration_s: float = float("inf")
    epochs: int = 60  # passes over the training pairs, at most
    batch_size: int = 256  # pairs per step
    hidden: tuple[int, ...] = (64, 64)  # units of each hidden layer
    state_noise_rad: float = 0.01  # SD of the noise on training states, rad
    alignment_steps: int = 400  # of an alignment's training

    @property
    def not_judged(self) -> str:
        """Why no claim is tested in a run of these sizes; empty where claims are."""
        return f"preset {SMOKE}: it only shows that the study runs" if self.name == SMOKE else ""

    def people(self, number: int, people_are: PeopleAre) -> str:
        """So many people in words, with the preset where that is not the whole study."""
        kind = f"{number} {people_are} {'person' if number == 1 else 'people'}"
        return kind + (f" (preset {SMOKE})" if self.not_judged else "")

    def as_run(self, task: StudyTask) -> StudyTask:
        """A task as a run of these sizes does it."""
        return replace(
            task,
            trials=min(task.trials, self.most_trials),
            trial_s=min(task.trial_s, self.trial_s),
            demonstrations_min=task.demonstrations_min * self.demonstrations_share,
        )


PRESETS: Final[Mapping[str, Sizes]] = {
    "paper": Sizes("paper"),
    SMOKE: Sizes(
        SMOKE,
        trial_s=1.0,
        most_trials=1,
        demonstrations_share=0.01,
        demonstration_s=2.0,
        epochs=2,
        hidden=(16,),
        alignment_steps=4,
    ),
}
"""``paper`` is the whole study. ``smoke`` only shows that it runs: one trial of a second at each task."""

FEWEST_PEOPLE: Final = 2


def sizes_of(preset: str, people: int) -> Sizes:
    """The sizes of a preset, for so many simulated people."""
    if preset not in PRESETS:
        raise UserError(f"There is no preset {preset!r}: choose from {', '.join(PRESETS)}.")
    if people < FEWEST_PEOPLE:
        raise UserError(f"A study needs {FEWEST_PEOPLE} people or more, not {people}: see --simulated.")
    return replace(PRESETS[preset], simulated=people)


LEAST_DEMONSTRATIONS: Final = 2  # one to learn from and one for validation


class Stream(IntEnum):
    """The uses of randomness."""

    ORDER = 0
    TRIALS = 1
    DEMONSTRATIONS = 2
    NETWORKS = 3
    QUESTIONS = 4
