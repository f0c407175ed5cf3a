"""A simulated person who sees late makes up for it: they know what they have pushed since."""

from collections import deque
from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby
from typing import Final, final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain
from latentarm_research.people.contract import LoopLimits, Moment
from latentarm_research.people.motion import carried

LONGEST_S: Final = 2.0  # nobody makes up for more than this, s: far longer than any reaction


@final
class Anticipation:
    """Brings forward what was seen by what has been pushed since.

    People act on a prediction of where their hand, or what it drives, is now, made from a copy of their own
    commands, as in a Smith predictor (Miall, Weir, Wolpert and Stein, J. Motor Behav. 25:203, 1993). This
    person predicts with the controller itself. Whatever else moves or stops the arm they see late.
    """

    def __init__(self, chain: Chain, limits: LoopLimits, period_s: float) -> None:
        self._chain = chain
        self._limits = limits
        self._period_s = period_s
        self._moments = deque[Moment](maxlen=max(round(LONGEST_S / period_s), 1))
        self._meant = deque[FloatArray](maxlen=self._moments.maxlen)

    def reset(self) -> None:
        """Forget what was pushed."""
        self._moments.clear()
        self._meant.clear()

    def meant(self, moment: Moment, u: FloatArray) -> None:
        """Remember what they meant at a moment, before their hand's tremor."""
        self._moments.append(moment)
        self._meant.append(u)

    def now(self, moment: Moment, seen: Moment, controller: Controller) -> Moment:
        """Predict the present moment from the one they saw and their inputs since."""
        here = seen.context
        for u, mode, time_s in self._since(seen):
            if self._limits.is_push(u):
                action = controller.action(controller.latent(u, here, mode), here, mode)
                state = here.state + time_s * self._limits.slowed(action)
                here = carried(self._chain, seen.context, seen.held, state)
        return replace(seen, context=here, mode=moment.mode)

    def _since(self, seen: Moment) -> Iterator[tuple[FloatArray, int, float]]:
        """What was pushed from then on, in which mode, and for how long, s."""
        first = next((i for i, one in enumerate(self._moments) if one is seen), len(self._moments))
        pushed = list(zip(self._moments, self._meant, strict=True))[first:]
        for _, same in groupby(pushed, key=lambda one: (one[0].mode, one[1].tobytes())):
            held = list(same)
            yield np.asarray(held[0][1]), held[0][0].mode, len(held) * self._period_s
