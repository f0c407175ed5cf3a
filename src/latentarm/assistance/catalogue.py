"""The beliefs by name, ours and those that other distributions register; and the published kinds of help."""

from collections.abc import Callable
from functools import partial
from typing import Final, Literal, cast

from latentarm.assistance.assistance import Assistance, AssistanceRule
from latentarm.assistance.belief import Belief, Rule
from latentarm.assistance.hindsight import HindsightOptimisation
from latentarm.assistance.hindsight_belief import HindsightBelief
from latentarm.assistance.interpolation import WEIGHTS, Interpolation
from latentarm.assistance.policy_blending import PolicyBlending
from latentarm.core.plugins import Catalogue
from latentarm.robots.robot import Robot


def _rule(name: str, thing: object) -> Rule:
    if not (isinstance(thing, type) and issubclass(thing, Belief)):
        raise TypeError(f"{thing!r} is no subclass of latentarm.assistance.belief.Belief")
    return cast(Rule, thing)


BELIEFS: Final = Catalogue(
    "latentarm.beliefs",
    "belief",
    {
        "boltzmann": "latentarm.assistance.boltzmann:BoltzmannBelief",
        "distance": "latentarm.assistance.distance:DistanceBelief",
        "maximum_entropy": "latentarm.assistance.maximum_entropy:MaximumEntropyBelief",
    },
    _rule,
)
"""Each is made with ``goals``, and if wanted ``period_s``, ``prior`` and ``floor``."""

AssistanceName = Literal["hindsight", "low_assist", "high_assist", "full_assist", "policy_blending"]

_PUBLISHED: Final[dict[AssistanceName, Callable[..., Assistance]]] = {
    "hindsight": HindsightOptimisation,
    "low_assist": partial(Interpolation, weight=WEIGHTS["low"]),
    "high_assist": partial(Interpolation, weight=WEIGHTS["high"]),
    "full_assist": partial(Interpolation, weight=WEIGHTS["full"]),
    "policy_blending": PolicyBlending,
}


def published_assistance(name: AssistanceName, robot: Robot) -> AssistanceRule:
    """A published kind of help, made for `HindsightBelief`.

    Hindsight optimisation, HARMONIC's levels, or policy blending. HARMONIC's No Assist is no assistance.

    Args:
        name: which.
        robot: the arm.
    """
    return partial(_PUBLISHED[name], robot=robot)


def published_belief(robot: Robot) -> Rule:
    """The belief that `published_assistance` was published with.

    Args:
        robot: the arm.
    """
    return cast(Rule, partial(HindsightBelief, robot=robot))
