"""The beliefs by name, ours and those that other distributions register."""

from typing import Final, cast

from latentarm.assistance.belief import Belief, Rule
from latentarm.core.plugins import Catalogue


def _rule(name: str, thing: object) -> Rule:
    if not (isinstance(thing, type) and issubclass(thing, Belief)):
        raise TypeError(f"{thing!r} is no subclass of latentarm.assistance.belief.Belief")
    return cast(Rule, thing)


BELIEFS: Final = Catalogue(
    "latentarm.beliefs", "belief", {"boltzmann": "latentarm.assistance.boltzmann:BoltzmannBelief"}, _rule
)
"""Each is made with ``goals``, and if wanted ``period_s``, ``prior`` and ``floor``."""
