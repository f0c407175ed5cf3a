"""A simulated newcomer who reads what the stick does off the ring that the page draws."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.assistance.controllers.contract import Controller
from latentarm.control.stick_ring import AHEAD_S, STRETCHES, full_pushes
from latentarm.core.types import Context, FloatArray, Input, IntArray, Pose
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.rotations import pose_error
from latentarm_research.people.boltzmann import BoltzmannConfig, OneStep
from latentarm_research.people.contract import Decision, Foresight, Imagination, LoopLimits, Moment
from latentarm_research.people.motion import shifted


@final
@dataclass(frozen=True)
class RingReadingConfig:
    """How a simulated person reads the ring."""

    # how far a direction in space is misread from two views, RMS of the angle, rad. An assumption
    error_rad: float = math.radians(15.0)
    # they read the ring, and decide, no more often than this, s: one look at a part of a picture lasts 260 to
    # 330 ms (Rayner, Q. J. Exp. Psychol. 62:1457, 2009)
    read_s: float = 0.3
    # how far the stick is pushed at least, as a share of full deflection. An assumption
    least_push: float = 0.03


@final
class RingReading(Imagination):
    """Expects of a push what the drawn direction nearest to it shows, and less of a smaller push.

    The ring shows where the tool would be after a full push of `AHEAD_S`, and its pins how it would be turned
    there. What lies between is not drawn: they expect that a share of the push, or of the time, leads a
    share of the way, straight on. They learn nothing from what they have pushed before. Of other modes, whose
    names they see, they imagine the ring that they would be shown.

    What they read is the ring, turned as a whole by an error that is drawn anew for each reading. It is one
    shape, of connected lines: who misjudges its depth misjudges neighbouring directions alike. Errors of
    their own for 32 directions would tear it apart, and the best of them would be chosen for its error.
    """

    def __init__(self, chain: Chain, config: RingReadingConfig, limits: LoopLimits) -> None:
        self._chain = chain
        self._limits = limits
        # An angle is made up of the turns about the two axes across a direction.
        self._error_rad = config.error_rad / math.sqrt(2.0)

    def reset(self) -> None:
        """Nothing was learned."""

    def saw(self, moment: Moment) -> None:
        """Nothing is learned."""

    def foresight(self, rng: np.random.Generator) -> Foresight:
        """One reading of the ring."""
        misread = Rotation.from_rotvec(rng.normal(scale=self._error_rad, size=3)).as_matrix()
        rings: dict[int, FloatArray] = {}

        def expected(
            inputs: FloatArray,
            context: Context,
            controller: Controller,
            modes: Sequence[int],
            horizon_s: float,
        ) -> Pose:
            for mode in set(modes) - rings.keys():
                rings[mode] = (self._drawn(context, controller, mode) @ misread.T).reshape(-1, 6)
            share = np.linalg.norm(inputs, axis=1) * horizon_s / AHEAD_S
            drawn = nearest_drawn(inputs)
            ways = np.stack([rings[mode][drawn] for mode in modes]) * share[:, None]
            return shifted(self._chain.forward(context.state), ways)

        return expected

    def _drawn(self, context: Context, controller: Controller, mode: int) -> FloatArray:
        """(K, 2, 3), from the tool to each point of the ring, m, and the turn to its pin, rad."""
        pushes = full_pushes(controller.input_dim)
        state = np.tile(context.state, (len(pushes), 1))
        for _ in range(STRETCHES):
            here = replace(context, state=state)
            action = controller.action(controller.latent(pushes, here, mode), here, mode)
            state = state + AHEAD_S / STRETCHES * self._limits.slowed(action)
        way = pose_error(self._chain.forward(context.state), self._chain.forward(state))
        return way.reshape(-1, 2, 3)


@final
class RingDecision(Decision):
    """Decides like `OneStep` at each reading, and pushes only in directions that are drawn.

    While they read, the stick stays where it was pushed to: eyes are on the picture, and the hand on the
    stick.
    """

    def __init__(
        self,
        decides: BoltzmannConfig,
        reading: RingReadingConfig,
        period_s: float,  # time between calls of `decide`, s
        dead_zone: float,  # length of an input up to which the loop takes it for rest, in [0, 1)
    ) -> None:
        config = replace(decides, decision_s=max(decides.decision_s, reading.read_s))
        self._one_step = OneStep(config, period_s, max(dead_zone, reading.least_push))

    def reset(self) -> None:
        """Forget what was held."""
        self._one_step.reset()

    @property
    def holding(self) -> bool:
        """True while they read, or wait for a mode."""
        return self._one_step.holding

    def decide(
        self, moment: Moment, controller: Controller, imagination: Imagination, rng: np.random.Generator
    ) -> Input:
        """A push along the drawn direction that is nearest to what one step asks for."""
        meant = self._one_step.decide(moment, controller, imagination, rng)
        direction = full_pushes(len(meant.u))[nearest_drawn(meant.u)]
        return replace(meant, u=np.linalg.norm(meant.u) * direction)


def nearest_drawn(inputs: FloatArray) -> IntArray:
    """Index of the drawn direction that is nearest to each of some inputs (..., d)."""
    return (inputs @ full_pushes(inputs.shape[-1]).T).argmax(axis=-1)
