"""The paper's studies by name: what `latentarm study` offers. Each is a file like those of other studies."""

from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import read_object
from latentarm_research.user_studies.definition import Definition

NAMES: Final = ("harmonic", "apple_pie", "eating", "alignment", "case_study")  # in the order of the paper


def load_definition(name: str) -> Definition:
    """The definition of that name. Raises a `UserError` where there is no such study."""
    from latentarm_research.user_studies.own.records import read_record  # pydantic, which help does not need

    if name not in NAMES:
        raise UserError(f"There is no study {name!r}: choose from {', '.join(NAMES)}.")
    path = Path(__file__).parent / "definitions" / f"{name}.json"
    return read_record(Definition, read_object(path), str(path))
