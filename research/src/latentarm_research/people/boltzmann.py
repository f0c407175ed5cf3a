"""A simulated person who is approximately optimal (equation 24)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import FloatArray, Input, Pose
from latentarm.robots.kinematics.rotations import pose_error
from latentarm_research.people.contract import USUAL_WITHIN_M, Decision, Imagination, Moment
from latentarm_research.people.density import CostModel, InputDensity, Lattice


def boltzmann(cost: FloatArray, beta: FloatArray | float) -> FloatArray:
    """``p ∝ exp(-beta cost)`` over options, (..., K), for any number of people at once.

    An option whose cost is not finite is never taken; where all are such, the first is taken for
    certain, so the first should be to do nothing. At beta = infinity the cheapest option gets all,
    ties share; at beta = 0 all options are as likely.

    Args:
        cost: (..., K), what each option costs, such as squared distances, m².
        beta: (...), rationality, zero or more, 1 over the unit of the cost; its axes broadcast
            against the leading axes of ``cost``.
    """
    rationality = np.asarray(beta, dtype=np.float64)[..., None]
    possible = np.isfinite(cost)
    possible[..., 0] |= ~possible.any(axis=-1)
    known = np.where(possible, cost, np.inf)
    least = known.min(axis=-1, keepdims=True)
    # No option has a finite cost, or the costs differ by more than floats can represent.
    with np.errstate(over="ignore", invalid="ignore"):
        above = np.minimum(known - least, np.finfo(np.float64).max)
        loss = np.where(known > least, rationality * above, 0.0)
    weight = np.where(possible, np.exp(-loss), 0.0)
    return weight / weight.sum(axis=-1, keepdims=True)


@final
@dataclass(frozen=True)
class BoltzmannConfig:
    """Parameters of a simulated person who looks one step ahead; all values are assumptions."""

    # rationality of equation 24, 1/m²; 0 acts at random, infinity always takes the best
    beta: float = 2000.0
    horizon_s: float = 0.5  # the look-ahead dt of equation 24, s: how far ahead an input is imagined
    rotation_weight: float = 0.2  # what a radian of wrong orientation counts, m
    decision_s: float = 0.1  # a person decides this often and holds the input in between, s
    # how often a person without reason (beta = 0) lets go, if they do not switch, 0 to 1
    rest_share: float = 0.04
    switch_share: float = 0.04  # how often they ask for another mode, where there is one, 0 to 1
    switch_cost: float = 0.015  # a switch of mode must bring the tool this much closer to be worth it, m
    switch_s: float = 0.8  # a switch takes this long, during which the input is zero, s

    def missed(self, target: Pose, reached: Pose, within_m: float) -> FloatArray:
        """How far poses are from the target, (..., 6), m; a radian counts as `rotation_weight`.

        Args:
            target: where the tool is wanted.
            reached: where it may be.
            within_m: how near it has to come. Distances count in proportion to that, so that a person is as
                careful as they need to be (distance over width, as in Fitts 1954); with `USUAL_WITHIN_M`
                they are what they are.
        """
        return pose_error(target, reached) * np.repeat([USUAL_WITHIN_M / within_m, self.rotation_weight], 3)


@final
@dataclass(frozen=True, eq=False)
class Outlook:
    """What a simulated person can do at one moment."""

    push_to: FloatArray  # (d,), where they would push the stick in the present mode
    left_m: float  # how far from the target the best of some inputs leaves the tool, in any mode, m
    rest_m: float  # how far it is now, m
    push: float  # probability of pushing the stick
    rest: float  # of letting go
    switch: float  # of asking for the next mode. The three sum to one


@final
class OneStep(Decision):
    """Looks one step ahead and usually picks a helpful input.

    Equation 24::

        p(u) ∝ exp(-beta ‖g* - Psi(s + phi(f(u, c), c) dt)‖²)

    over all inputs of length 1 at most that the loop does not take for rest (see
    `latentarm_research.people.density`), with the person's own `Foresight` in place of Psi and phi where
    they do not know these. Distance between poses is ``‖Δp‖² + (rotation_weight · angle)²``, m², and Δp
    grows where they must come nearer than usual (see `BoltzmannConfig.missed`). The person looks one step
    ahead only, as in the paper: they can get stuck where no single input brings the tool closer.

    A person can also let go, which leaves the tool where it is: one more input of equation 24, with a
    probability of its own, ``rest_share``, where beta is zero.

    Where the controller has several modes, they first decide whether to ask for the next one. To stay
    counts as the best input of the present mode, and to switch as the best input of the best other one with
    ``switch_cost`` added to the distance that it leaves, so that a switch is worth a gain of more than that.
    """

    def __init__(self, config: BoltzmannConfig, period_s: float, dead_zone: float = 0.0) -> None:
        self._config = config
        self._dead_zone = dead_zone
        self._hold_calls = max(round(config.decision_s / period_s), 1)
        # The step that asks for the mode already has a zero input.
        self._switch_calls = max(round(config.switch_s / period_s), 1)
        self.reset()

    def reset(self) -> None:
        """Forget the held input, any switch under way and what was learned."""
        self._held = np.zeros(0)
        self._held_calls = 0

    @property
    def holding(self) -> bool:
        """Whether the next call of `decide` holds an input, or waits for a mode, without deciding."""
        return self._held_calls > 0

    def decide(
        self, moment: Moment, controller: Controller, imagination: Imagination, rng: np.random.Generator
    ) -> Input:
        """Hold the input of the last decision, or decide again."""
        if self.holding:
            return self._hold()
        return self.take(self.outlook(moment, controller, imagination, rng), rng)

    def outlook(
        self, moment: Moment, controller: Controller, imagination: Imagination, rng: np.random.Generator
    ) -> Outlook:
        """Equation 24 at a moment."""
        config, mode, beta = self._config, moment.mode, self._config.beta
        lattice = Lattice.of(controller.input_dim, rng, self._dead_zone)
        inputs = np.concatenate([np.zeros((1, lattice.axes)), lattice.nodes])
        modes = range(len(controller.modes))
        foresight = imagination.foresight(rng)

        def residuals(tried: FloatArray, in_modes: Sequence[int]) -> FloatArray:
            """(M, K, 6), m, what K inputs leave in each of M modes."""
            reached = foresight(tried, moment.context, controller, in_modes, config.horizon_s)
            return config.missed(moment.target, reached, moment.within_m)

        left = residuals(inputs, modes)
        models = [CostModel(lattice, one[1:]) for one in left]
        draws = InputDensity(models[mode], beta).draw(
            lambda tried: np.square(residuals(tried, (mode,))[0]).sum(axis=1), rng
        )
        # What is best by a model is looked at too: its error may be large.
        tops = residuals(np.stack([model.best for model in models]), modes)[modes, modes]
        best = np.fmin.reduce(np.square(np.concatenate([left, tops[:, None]], axis=1)).sum(axis=2), axis=1)
        best[mode] = np.fmin(best[mode], draws.least[0])
        rest = float(np.square(left[mode, 0]).sum())
        other = np.delete(best, mode).min(initial=np.inf)
        switched = np.square(np.sqrt(other) + config.switch_cost)
        # What comes first is what they do if no cost is finite: stay, and let go.
        stay, switch = _shared(boltzmann(np.array([best[mode], switched]), beta), config.switch_share)
        push, let_go = _shared(boltzmann(np.array([rest, draws.value[0]]), beta)[::-1], config.rest_share)
        return Outlook(
            push_to=draws.inputs[0],
            left_m=float(np.sqrt(best.min())),
            rest_m=float(np.sqrt(rest)),
            push=stay * push,
            rest=stay * let_go,
            switch=switch,
        )

    def take(self, outlook: Outlook, rng: np.random.Generator) -> Input:
        """Choose among what there is to do, and begin to do it."""
        chance = rng.random()
        switches = chance < outlook.switch
        lets_go = switches or chance < outlook.switch + outlook.rest
        self._held = np.zeros_like(outlook.push_to) if lets_go else outlook.push_to
        self._held_calls = self._switch_calls if switches else self._hold_calls
        return Input(self._hold().u, switch_mode=switches)

    def _hold(self) -> Input:
        self._held_calls -= 1
        return Input(self._held)


def _shared(likely: FloatArray, share: float) -> list[float]:
    """Probabilities of two options: the second has this share where both are worth as much."""
    weight = likely * np.array([1.0 - share, share])
    if not weight.any():
        weight = likely
    return (weight / weight.sum()).tolist()
