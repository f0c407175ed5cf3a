"""The designs by name."""

from collections.abc import Mapping
from typing import Final

from latentarm_research.user_studies.definition import Definition, Design
from latentarm_research.user_studies.designs.between import Between
from latentarm_research.user_studies.designs.design import StudyDesign
from latentarm_research.user_studies.designs.within import Within

DESIGNS: Final[Mapping[Design, StudyDesign]] = {"within": Within(), "between": Between()}


def design_of(definition: Definition) -> StudyDesign:
    """The design of a study."""
    return DESIGNS[definition.design]
