"""Colours of a study's conditions in its figures."""

from typing import Final

from latentarm.user_studies.definition import Definition

COLOURS: Final = ("#7f7f7f", "#E69F00", "#56B4E9", "#CC79A7", "#0072B2")
"""Of the Okabe-Ito palette; the last one is that of the last condition, which each study is about."""


def colours(definition: Definition) -> dict[str, str]:
    """The colour of each condition."""
    names = [condition.name for condition in definition.conditions]
    return dict(zip(names, (*COLOURS[: len(names) - 1], COLOURS[-1]), strict=True))
