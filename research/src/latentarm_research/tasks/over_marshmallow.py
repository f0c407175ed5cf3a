"""The fork over one of three marshmallows: what people did in HARMONIC, where the arm stabbed by itself."""

from dataclasses import dataclass, field, replace
from typing import final

import numpy as np

from latentarm.tasks.eating.fork_task import ForkTask
from latentarm.tasks.eating.marshmallows import Marshmallows
from latentarm.tasks.scene_task import Beginning


@final
@dataclass(frozen=True, eq=False)
class OverMarshmallow(ForkTask):
    """Bring the fork over the chosen marshmallow: the first step of `Marshmallows`, and nothing more.

    A person's trial in HARMONIC, and in the paper's first study, ends with the fork there. Help that takes a
    fork there keeps it there, so what comes after must not be part of such a task.
    """

    whole: Marshmallows = field(default_factory=Marshmallows)  # the task that this is the first step of

    @property
    def name(self) -> str:
        """``over_marshmallow``."""
        return "over_marshmallow"

    @property
    def choices(self) -> tuple[str, ...]:
        """Which marshmallow."""
        return self.whole.choices

    @property
    def time_limit_s(self) -> float:
        """A minute."""
        return self.whole.time_limit_s

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """The same things and start as in the whole task."""
        begun = self.whole.begin(choice, rng)
        return replace(begun, steps=begun.steps[:1], text=f"the fork over the {self.choices[choice]}")
