"""What is varied about the entropy, one thing at a time."""

import math
from collections.abc import Iterator
from dataclasses import replace

from latentarm_research.studies.shared_autonomy.preset import Ablation, Entropy

LETTER = "equation 15 to the letter"
"""The variant without an outcome that no goal is conveyed."""

JOINTS_ALONE = "progress of the joints alone"
"""The variant that does not look at the tool."""


def weight_label(weight: float) -> str:
    """What a variant with this lambda_2 is called."""
    return f"lambda_2 {weight:g}"


def variants(ablation: Ablation, proper: Entropy) -> dict[str, Entropy | None]:
    """Every variant by what it is called, each once."""
    found: dict[str, Entropy | None] = {
        weight_label(one): replace(proper, weight=one) if one else None for one in ablation.weights
    }
    found |= {name: entropy for name, entropy in _others(ablation, proper) if entropy != proper}
    return found


def _others(ablation: Ablation, proper: Entropy) -> Iterator[tuple[str, Entropy]]:
    for sharpness in ablation.sharpness:
        yield f"kappa {sharpness:g}", replace(proper, sharpness=sharpness)
    if ablation.without_no_goal:
        yield LETTER, replace(proper, least_progress=-math.inf)
    if ablation.joints_alone:
        yield JOINTS_ALONE, replace(proper, sees_tool=False)
    for where in ablation.contexts:
        yield f"contexts {where.replace('_', ' ')}", replace(proper, where=where)
