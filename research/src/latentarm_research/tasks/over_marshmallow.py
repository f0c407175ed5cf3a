"""The fork over one of three marshmallows: what people did in HARMONIC, where the arm stabbed by itself."""

from dataclasses import replace
from typing import final

import numpy as np

from latentarm.tasks.eating.fork_task import ForkTask
from latentarm.tasks.eating.marshmallows import Marshmallows
from latentarm.tasks.scene_task import Beginning


@final
class OverMarshmallow(ForkTask):
    """Bring the fork over the chosen marshmallow: the first step of `Marshmallows`, and nothing more.

    A person's trial in HARMONIC, and in the paper's first study, ends with the fork there. Help that takes a
    fork there keeps it there, so what comes after must not be part of such a task.
    """

    name = "over_marshmallow"
    choices = Marshmallows.choices
    time_limit_s = Marshmallows.time_limit_s

    def begin(self, choice: int, rng: np.random.Generator) -> Beginning:
        """The same things and start as in the whole task."""
        begun = Marshmallows().begin(choice, rng)
        return replace(begun, steps=begun.steps[:1], text=f"the fork over the {self.choices[choice]}")
