"""Items of a questionnaire by name, and in which order each person is given them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.errors import UserError
from latentarm_research.studies.streams import generator
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.designs.catalogue import design_of
from latentarm_research.user_studies.questionnaire import Item, Scale
from latentarm_research.user_studies.sizes import Stream


@final
@dataclass(frozen=True)
class Asked:
    """One line of a sheet."""

    person: int  # their number, from 0
    condition: str  # after which they are asked
    item: str  # its name
    text: str  # the statement


def items_of(definition: Definition) -> dict[str, tuple[Scale, Item]]:
    """Every item by name, such as ``ease_1``, with its scale."""
    return {
        f"{scale.name}_{number}": (scale, item)
        for scale in definition.questionnaire
        for number, item in enumerate(scale.items, start=1)
    }


def sheet(definition: Definition, people: int, seed: int) -> list[Asked]:
    """What everybody is asked: after each condition that they meet all items, in an order of their own.

    Raises:
        UserError: the study has no questionnaire with scales.
    """
    items = items_of(definition)
    if not items:
        raise UserError(f"The study {definition.name} has no questionnaire with scales.")
    rng = generator(seed, definition.name, Stream.ORDER)
    met = design_of(definition).orders(definition, people, rng)
    rng = generator(seed, f"{definition.name} items", Stream.QUESTIONS)
    return [
        Asked(person, condition, name, items[name][1].text)
        for person, order in enumerate(met)
        for names in [_shuffled(list(items), rng)]
        for condition in order
        for name in names
    ]


def _shuffled(names: Sequence[str], rng: np.random.Generator) -> list[str]:
    return [names[int(place)] for place in rng.permutation(len(names))]
