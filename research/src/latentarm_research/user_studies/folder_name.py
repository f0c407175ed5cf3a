"""What the folder of a study's results says that it is."""

from typing import Final

from latentarm_research.user_studies.definition import Definition

PREFIX: Final = "user study "
"""Before a study's name, in what a folder of its results says that it is."""


def folder_name(definition: Definition) -> str:
    """What the folder of a study's results says that it is."""
    return f"{PREFIX}{definition.name}"
