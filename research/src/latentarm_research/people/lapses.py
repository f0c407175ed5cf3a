"""Lapses of attention: for a while a simulated person decides nothing, and their hand stays where it is."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import Input
from latentarm_research.people.contract import Decision, Imagination, Moment

SHORTEST_S: Final = 0.5
"""A lapse is a response later than 500 ms in the psychomotor vigilance task (Dinges and Powell, Behav. Res.
Methods Instrum. Comput. 17:652, 1985), s."""


@final
@dataclass(frozen=True)
class LapseConfig:
    """How often a simulated person's attention lapses, and for how long."""

    per_minute: float  # mean number of lapses that begin in a minute of attention
    mean_s: float  # mean duration, s: `SHORTEST_S`, and an exponential share beyond it


@final
class Lapsing(Decision):
    """Decides like another person, except that attention lapses.

    Lapses begin at random (a Poisson process in the time between them). In a lapse there is no new decision:
    the stick stays where it was last meant to be, and nothing is asked for.
    """

    def __init__(self, decision: Decision, config: LapseConfig, period_s: float) -> None:
        self._decision = decision
        self._config = config
        self._period_s = period_s
        self.reset()

    def reset(self) -> None:
        """Begin a drive with attention."""
        self._decision.reset()
        self._last: Input | None = None
        self._lapse_calls = 0
        self._attentive_calls: int | None = None

    @property
    def holding(self) -> bool:
        """Whether attention has lapsed, or what was decided with attention is held."""
        return self._lapse_calls > 0 or self._decision.holding

    def decide(
        self, moment: Moment, controller: Controller, imagination: Imagination, rng: np.random.Generator
    ) -> Input:
        """Decide, or hold what was last meant while attention lapses."""
        if self._attentive_calls is None:
            self._attentive_calls = self._calls(rng.exponential(60.0 / self._config.per_minute))
        if self._last is not None and self._attentive_calls == 0:
            self._attentive_calls = None
            beyond_s = self._config.mean_s - SHORTEST_S
            self._lapse_calls = self._calls(SHORTEST_S + beyond_s * rng.exponential())
        if self._last is not None and self._lapse_calls > 0:
            self._lapse_calls -= 1
            return Input(self._last.u)
        self._attentive_calls = max((self._attentive_calls or 0) - 1, 0)
        self._last = self._decision.decide(moment, controller, imagination, rng)
        return self._last

    def _calls(self, time_s: float) -> int:
        return max(round(time_s / self._period_s), 1)
