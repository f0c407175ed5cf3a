"""The published kinds of help by name."""

from collections.abc import Callable
from functools import partial
from typing import Final, Literal, cast

from latentarm.assistance.assistance import Assistance, AssistanceRule
from latentarm.assistance.belief import Rule
from latentarm.robots.robot import Robot
from latentarm_research.assistance.hindsight import HindsightOptimisation
from latentarm_research.assistance.hindsight_belief import HindsightBelief
from latentarm_research.assistance.interpolation import WEIGHTS, Interpolation
from latentarm_research.assistance.policy_blending import PolicyBlending

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
    """
    return partial(_PUBLISHED[name], robot=robot)


def published_belief(robot: Robot) -> Rule:
    """The belief that `published_assistance` was published with."""
    return cast(Rule, partial(HindsightBelief, robot=robot))
