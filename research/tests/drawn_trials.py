"""Trials that nobody gave, for tests of the analysis."""

from collections.abc import Mapping, Sequence

import numpy as np

from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs import design_of
from latentarm_research.user_studies.record import Trial


def drawn_trials(
    definition: Definition,
    people: int,
    rng: np.random.Generator,
    effects: Mapping[str, float] | None = None,
    measures: Sequence[str] = (),
) -> list[Trial]:
    """Trials whose measures are a person's level, a condition's effect, and chance of unit SD."""
    effects = effects or {}
    measures = measures or definition.measures
    levels = rng.normal(20.0, 2.0, people)
    return [
        Trial(
            person,
            condition,
            task.name,
            place,
            number,
            {name: float(levels[person] + effects.get(condition, 0.0) + rng.normal()) for name in measures},
        )
        for person, order in enumerate(design_of(definition).orders(definition, people, rng))
        for place, condition in enumerate(order)
        for task in definition.tasks
        for number in range(task.trials)
    ]
