"""What the simulated people of a run are like, as lines of a table."""

from collections.abc import Sequence
from typing import Final

from latentarm_research.people.population import MIRRORED, TRAITS
from latentarm_research.people.traits import Traits

HEAD: Final = ("trait", "mean (range)", "where it comes from")


def people_lines(people: Sequence[Traits]) -> list[tuple[str, str, str]]:
    """Every trait over some people, with its source."""
    lines = [
        (
            f"{one.meaning} ({one.unit})" if one.unit else one.meaning,
            _spans([float(getattr(person, one.name)) for person in people]),
            one.source,
        )
        for one in TRAITS
    ]
    mirrored = sum(person.mirrored for person in people)
    upside_down = (
        "second axis upside down for them",
        f"{mirrored} of {len(people)}",
        f"chosen: a share of {MIRRORED:g}",
    )
    return [*lines, upside_down]


def _spans(values: Sequence[float]) -> str:
    mean, low, high = (f"{value:,.0f}" if value >= 100.0 else f"{value:.3g}" for value in _ends(values))
    return f"{mean} ({low} to {high})"


def _ends(values: Sequence[float]) -> tuple[float, float, float]:
    """Mean, least and most."""
    return sum(values) / len(values), min(values), max(values)
