"""A simulated person's senses and hand: what they see comes late, and their hand trembles."""

from collections import deque
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray, Input
from latentarm_research.people.contract import Moment

SINUSOIDS: Final = 24  # of which a tremor is the sum


@final
@dataclass(frozen=True)
class HandConfig:
    """How late and how unsteady a simulated person's hand is; by default neither."""

    reaction_s: float = 0.0  # time from what can be seen to the input that answers it, s
    tremor: float = 0.0  # RMS of each axis's tremor as a share of full deflection, while the stick is pushed
    lowest_hz: float = 4.0  # lower edge of the tremor's band, Hz
    highest_hz: float = 12.0  # its upper edge, Hz
    # SD of each axis of a push about what was meant, as a share of its length; drawn anew for each push that
    # is meant, and held as long as it
    variation: float = 0.0


REACTION_S: Final = 0.23
"""Reaction time, s: the mean of 1469 people to a visual stimulus is 231 ms (Woods et al., Front. Hum.
Neurosci. 9:131, 2015)."""

UNSTEADY: Final = HandConfig(reaction_s=REACTION_S, tremor=0.1)
"""A usual reaction time. A tremor of 4 to 12 Hz, the band of essential tremor (Bhatia et al., Mov. Disord.
33:75, 2018). Its size, 10 % of full deflection, is an assumption."""


@final
class Hand:
    """Delays what is seen, and adds tremor and noise to what is given.

    The tremor of each axis is a sum of sinusoids with random phases and with frequencies drawn from equal
    parts of the band: nearly Gaussian noise, with nothing outside the band (Shinozuka and Jan 1972). A hand
    that lets go does not move the stick.

    The noise of a push is in proportion to it (Harris and Wolpert, Nature 394:780, 1998). The next pushes
    correct what comes of it: the more of them, the narrower the target (Crossman and Goodeve 1963).
    """

    def __init__(self, config: HandConfig, period_s: float) -> None:
        self._config = config
        self._period_s = period_s
        self._delay_calls = round(config.reaction_s / period_s)
        self.reset()

    def reset(self) -> None:
        """Forget what was seen, the tremor, and the push."""
        self._views = deque[Moment](maxlen=self._delay_calls + 1)
        self._phase = self._turn = np.zeros((0, SINUSOIDS))
        self._meant = self._wrong = np.zeros(0)

    def sees(self, moment: Moment) -> Moment:
        """What is seen now: what was there a reaction time ago, or when the drive began."""
        self._views.append(moment)
        return self._views[0]

    def gives(self, meant: Input, rng: np.random.Generator) -> Input:
        """What the stick does when the person means an input."""
        if self._config.variation:
            meant = Input(self._pushed(meant.u, rng), meant.switch_mode)
        if not self._config.tremor:
            return meant
        if not len(self._phase):
            self._start(len(meant.u), rng)
        self._phase = self._phase + self._turn
        if not meant.u.any():
            return meant
        size = self._config.tremor * np.sqrt(2.0 / SINUSOIDS)
        return Input(within_reach(meant.u + size * np.cos(self._phase).sum(axis=1)), meant.switch_mode)

    def _pushed(self, u: FloatArray, rng: np.random.Generator) -> FloatArray:
        """What becomes of a push."""
        if u.any() and not np.array_equal(u, self._meant):
            self._wrong = self._config.variation * float(np.linalg.norm(u)) * rng.normal(size=len(u))
        self._meant = u
        return within_reach(u + self._wrong) if u.any() else u

    def _start(self, axes: int, rng: np.random.Generator) -> None:
        shape = (axes, SINUSOIDS)
        band = self._config.highest_hz - self._config.lowest_hz
        hz = self._config.lowest_hz + band * (np.arange(SINUSOIDS) + rng.random(shape)) / SINUSOIDS
        self._phase = rng.uniform(0.0, 2.0 * np.pi, shape)
        self._turn = 2.0 * np.pi * self._period_s * hz


def within_reach(u: FloatArray) -> FloatArray:
    """Inputs (..., d), those of length over 1 shortened to 1: a stick goes no farther."""
    return u / np.maximum(np.linalg.norm(u, axis=-1, keepdims=True), 1.0)
