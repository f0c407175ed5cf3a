"""The studies by name: what `latentarm study` offers."""

from importlib import import_module
from typing import Final

from latentarm.core.errors import UserError
from latentarm_research.user_studies.definition import Definition

NAMES: Final = ("harmonic", "apple_pie", "eating", "alignment", "case_study")  # in the order of the paper


def load_definition(name: str) -> Definition:
    """The definition of that name. Raises a `UserError` where there is no such study."""
    if name not in NAMES:
        raise UserError(f"There is no study {name!r}: choose from {', '.join(NAMES)}.")
    return import_module(f"latentarm_research.user_studies.definitions.{name}").DEFINITION
