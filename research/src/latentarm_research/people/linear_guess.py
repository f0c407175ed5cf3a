"""A simulated person who guesses that the tool moves linearly with the stick, and learns how."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.errors import UserError
from latentarm.core.types import Context, FloatArray, Pose
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.rotations import pose_error
from latentarm_research.people.contract import Foresight, Imagination, Moment
from latentarm_research.people.motion import shifted


@final
@dataclass(frozen=True)
class LinearGuessConfig:
    """How a simulated person learns what the stick does. All figures are assumptions."""

    # SD of the speed along each axis of space that they expect of the tool, at first, of a full push, m/s
    speed_m_s: float = 0.1
    turn_rad_s: float = 0.5  # the same of its turning, rad/s
    # SD of what they see of a motion about what a linear guess can say, as a share of `speed_m_s` and
    # `turn_rad_s`
    noise: float = 0.2
    # a motion that was seen this far away counts 1/e, by the way that the tool has gone since in the same
    # mode, m. A radian of turning counts as `speed_m_s / turn_rad_s`
    memory_m: float = 0.1
    glance_s: float = 0.2  # they compare where the tool is with where it was so long ago, s
    trial_s: float = 0.3  # they stay with one guess for so long, s
    # what they expect at first of a full push along each axis of the stick, in every mode: for each axis a
    # twist (6 numbers, m/s and rad/s, in the base frame); None expects nothing in particular. What is
    # forgotten gives way to it
    expected: tuple[tuple[float, ...], ...] | None = None


@final
@dataclass(eq=False)
class Regression:
    """Bayesian linear regression of the tool's twist on the input, with exponential forgetting.

    The twist is ``y = B u + e``, each entry in units of its prior's SD. A motion adds ``u uᵀ / noise²`` to
    the precision of B's rows. All motions are forgotten towards the prior, so that no direction of the input
    that is not pushed becomes infinitely uncertain.
    """

    precision: FloatArray  # (d, d), of each row of B beyond the prior's, which is 1
    moment: FloatArray  # (6, d), precision times mean, beyond the prior's
    prior: FloatArray | float = 0.0  # (6, d), B's mean before anything was seen, or one for all entries

    def learn(
        self,
        u: FloatArray,  # (d,), the input
        y: FloatArray,  # (6,), the twist
        noise: float,  # SD of y
        kept: float,  # share of all earlier knowledge that is not forgotten
    ) -> None:
        """Take in one motion."""
        self.precision = kept * self.precision + np.outer(u, u) / noise**2
        self.moment = kept * self.moment + np.outer(y, u) / noise**2

    def drawn(self, rng: np.random.Generator) -> FloatArray:
        """B (6, d), drawn from what is believed of it."""
        precision = self.precision + np.eye(len(self.precision))
        mean = np.linalg.solve(precision, (self.moment + self.prior).T).T
        root = np.linalg.cholesky(precision)
        return mean + np.linalg.solve(root.T, rng.normal(size=mean.shape).T).T


@final
class LinearGuess(Imagination):
    """Learns a linear map from stick to tool for each mode; it holds where the arm is just now.

    The decoder's map changes with the state, so what was seen far away is forgotten. They act on a guess
    drawn from what they believe (Thompson sampling, 1933): at first they try all sorts of pushes, and later
    those that they have seen to work.
    """

    def __init__(self, chain: Chain, config: LinearGuessConfig, period_s: float) -> None:
        self._chain = chain
        self._config = config
        self._scale = np.repeat([config.speed_m_s, config.turn_rad_s], 3)
        self._glance_calls = max(round(config.glance_s / period_s), 1)
        self._glance_s = self._glance_calls * period_s
        self._trial_calls = max(round(config.trial_s / period_s), 1)
        self.reset()

    def reset(self) -> None:
        """Forget all that was learned."""
        self._learned: dict[int, Regression] = {}
        self._guesses: dict[int, FloatArray] = {}
        self._pushed: list[FloatArray] = []
        self._since: Moment | None = None
        self._calls = 0

    def saw(self, moment: Moment) -> None:
        """Learn from how the tool moved since the last glance, if the stick was pushed."""
        self._calls += 1
        if self._since is None or self._since.mode != moment.mode:
            self._since, self._pushed = moment, []
            return
        self._pushed.append(moment.u)
        if len(self._pushed) < self._glance_calls:
            return
        u = np.mean(self._pushed, axis=0)
        if u.any():
            before, now = (self._chain.forward(one.context.state) for one in (self._since, moment))
            twist = pose_error(before, now) / self._glance_s / self._scale
            gone_m = float(np.linalg.norm(twist)) * self._glance_s * self._config.speed_m_s
            kept = math.exp(-gone_m / self._config.memory_m)
            self._of(moment.mode, len(u)).learn(u, twist, self._config.noise, kept)
        self._since, self._pushed = moment, []

    def foresight(self, rng: np.random.Generator) -> Foresight:
        """A guess drawn from what is believed now, or the present one while it is on trial."""
        if self._calls >= self._trial_calls:
            self._calls = 0
            self._guesses = {}

        def expected(
            inputs: FloatArray,
            context: Context,
            controller: Controller,
            modes: Sequence[int],
            horizon_s: float,
        ) -> Pose:
            twist = np.stack([inputs @ self._guess(mode, inputs.shape[1], rng).T for mode in modes])
            return shifted(self._chain.forward(context.state), horizon_s * twist)

        return expected

    def _guess(self, mode: int, axes: int, rng: np.random.Generator) -> FloatArray:
        """(6, d), the tool's twist for each axis of the stick, m/s and rad/s, by the guess on trial."""
        if mode not in self._guesses:
            self._guesses[mode] = self._scale[:, None] * self._of(mode, axes).drawn(rng)
        return self._guesses[mode]

    def _of(self, mode: int, axes: int) -> Regression:
        if mode not in self._learned:
            nothing = np.zeros((6, axes))
            self._learned[mode] = Regression(np.zeros((axes, axes)), nothing, self._prior(axes))
        return self._learned[mode]

    def _prior(self, axes: int) -> FloatArray | float:
        """(6, d), what they expect before they have seen anything, in units of the prior's SD."""
        expected = self._config.expected
        if expected is None:
            return 0.0
        if len(expected) != axes:
            raise UserError(
                f"A person who knows what to expect of {len(expected)} axes cannot drive with {axes}."
            )
        return np.array(expected).T / self._scale[:, None]
