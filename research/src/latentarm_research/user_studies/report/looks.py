"""Colours of a study's conditions in its figures."""

from typing import Final

from latentarm_research.user_studies.definition import Definition

ABOUT: Final = "#0072B2"
"""Of the condition that the first claim of a study is about, or of its last one."""

OTHERS: Final = ("#7f7f7f", "#E69F00", "#56B4E9", "#CC79A7", "#009E73", "#D55E00", "#F0E442")
"""Of the other ones in order; grey, and the Okabe-Ito palette."""

MOST_CONDITIONS: Final = len(OTHERS) + 1
"""That colours tell apart."""


def colours(definition: Definition) -> dict[str, str]:
    """The colour of each condition."""
    names = [condition.name for condition in definition.conditions]
    subject = next((claim.subject[-1] for claim in definition.claims), names[-1])
    others = iter(OTHERS)
    return {name: ABOUT if name == subject else next(others) for name in names}
