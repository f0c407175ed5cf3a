"""Where a simulated person expects their inputs to lead."""

from collections.abc import Callable, Sequence
from typing import final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import Context, FloatArray, Pose
from latentarm.robots.kinematics.chain import Chain
from latentarm_research.people.loop_limits import LoopLimits

Foresight = Callable[[FloatArray, Context, Controller, Sequence[int], float], Pose]
"""Inputs (K, d), held in a context for a time, s, to poses (M, K) of the tool in M modes of the controller.
An input of zero leaves the tool where it is."""


@final
class KnowsTheArm:
    """The ``Psi(s + phi(f(u, c), c) dt)`` of equation 24: they know exactly what each input does."""

    def __init__(
        self,
        chain: Chain,  # the arm; its first tool is looked at
        limits: LoopLimits,
    ) -> None:
        self._chain = chain
        self._limits = limits

    def __call__(
        self,
        inputs: FloatArray,
        context: Context,
        controller: Controller,
        modes: Sequence[int],
        horizon_s: float,
    ) -> Pose:
        """Where the controller takes the tool."""
        actions = np.stack(
            [controller.action(controller.latent(inputs, context, m), context, m) for m in modes]
        )
        # The arm of a person who lets go stands still, whatever phi(0, c) is.
        actions[:, ~self._limits.is_push(inputs)] = 0.0
        # One call over all modes: (M, K, n).
        return self._chain.forward(context.state + horizon_s * self._limits.slowed(actions))
