"""Simulated people expect things that the tool holds to move with it."""

from dataclasses import replace

import numpy as np

from latentarm.core.types import BoolArray, Context, FloatArray
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.pose_rows import moved_along


def carried(
    chain: Chain,  # the arm, whose first tool holds things
    context: Context,
    held: BoolArray,  # (K,), which of its things are held
    state: FloatArray,  # (..., n), where the arm is then, rad
) -> Context:
    """The context once the arm is elsewhere, and with it what it holds."""
    if not held.any():
        return replace(context, state=state)
    moved = moved_along(context.objects, chain.forward(context.state), chain.forward(state))
    return replace(context, state=state, objects=np.where(held[:, None], moved, context.objects))
