"""A simulated person who is approximately optimal (equation 24)."""

from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.control.controller import Controller
from latentarm.errors import UserError
from latentarm.kinematics.rotations import angle_between
from latentarm.operators.foresight import Foresight, KnowsTheArm
from latentarm.operators.operator import Operator
from latentarm.operators.rationality import boltzmann
from latentarm.robots.robot import Robot
from latentarm.types import Context, FloatArray, Input, Pose


@final
@dataclass(frozen=True)
class BoltzmannConfig:
    """Parameters of the simulated person.

    Attributes:
        beta: rationality of equation 24, 1/m², at the start of a drive; 0 acts at random, infinity always
            takes the best.
        beta_per_s: m of ``beta(t) = beta + m t``, 1/(m² s): somebody who learns within the task.
        horizon_s: the look-ahead dt of equation 24, s: how far ahead an input is imagined.
        rotation_weight: what a radian of wrong orientation counts, m.
        magnitudes: sizes ‖u‖ of the inputs that are considered, beside no input at all.
        directions: how many equal angles are considered on a 2-axis input; one axis has two
            directions, more than two axes have two along each axis.
        decision_s: a person decides this often and holds the input in between, s.
        switch_cost: a switch of mode must bring the tool this much closer to be worth it, m.
        switch_s: a switch takes this long, during which the input is zero, s.
    """

    beta: float = 2000.0
    beta_per_s: float = 0.0
    horizon_s: float = 0.5
    rotation_weight: float = 0.2
    magnitudes: tuple[float, ...] = (0.2, 0.6, 1.0)
    directions: int = 8
    decision_s: float = 0.1
    switch_cost: float = 0.015
    switch_s: float = 0.8

    def __post_init__(self) -> None:
        if not self.beta >= 0:
            raise UserError(f"The simulated person's beta must be zero or more, not {self.beta}.")
        if not 0 <= self.beta_per_s < np.inf:
            raise UserError(
                f"The simulated person's beta_per_s must be zero or more, and finite, not {self.beta_per_s}."
            )
        for name in ("horizon_s", "decision_s"):
            if not 0 < getattr(self, name) < np.inf:
                raise UserError(
                    f"The simulated person's {name} must be positive and finite, not {getattr(self, name)}."
                )
        for name in ("rotation_weight", "switch_cost", "switch_s"):
            if not 0 <= getattr(self, name) < np.inf:
                raise UserError(
                    f"The simulated person's {name} must be zero or more, and finite, "
                    f"not {getattr(self, name)}."
                )
        if not self.magnitudes or not all(0 < size <= 1 for size in self.magnitudes):
            raise UserError(
                f"The simulated person's magnitudes must be in (0, 1], at least one, not {self.magnitudes}."
            )
        if self.directions < 2:
            raise UserError(
                f"The simulated person needs at least 2 directions of input, not {self.directions}."
            )


@final
@dataclass(frozen=True, eq=False)
class Options:
    """What a simulated person can do at one moment, and how likely each is.

    Attributes:
        inputs: (K, d), inputs in the present mode; the first is zero.
        input_probability: (K,).
        switch_probability: of asking for the next mode; all probabilities together sum to one.
    """

    inputs: FloatArray
    input_probability: FloatArray
    switch_probability: float


@final
class BoltzmannOperator(Operator):
    """A simulated person who looks one step ahead and usually picks a helpful input.

    Equation 24::

        p(u) ∝ exp(-beta(t) ‖g* - Psi(s + phi(f(u, c), c) dt)‖²)

    over a grid of inputs: none, at which the arm stands still whatever the decoder makes of zero, and
    every direction at every magnitude. A person who does not know Psi and phi uses a
    `Foresight` instead. Distance between poses is
    ``‖Δp‖² + (rotation_weight · angle)²``, m². The person looks one step ahead only, as in the paper:
    they can get stuck where no single input brings the tool closer. ``beta(t)`` counts from `reset`, by
    calls of `act`.

    Where the controller has several modes, asking for the next mode is one more option. It counts as
    the best input of the best other mode, with ``switch_cost`` added to the distance that it leaves,
    so that a switch happens only for a gain of more than ``switch_cost``.

    Args:
        robot: the arm, for its forward kinematics.
        config: how the simulated person thinks.
        period_s: time between calls of `act`, s.
        foresight: where the person expects an input to lead; they know the arm and its decoder where None.

    Raises:
        UserError: the period is not positive and finite.
    """

    def __init__(
        self,
        robot: Robot,
        config: BoltzmannConfig | None = None,
        period_s: float = 0.05,
        foresight: Foresight | None = None,
    ) -> None:
        if not 0 < period_s < np.inf:
            raise UserError(f"The time between inputs must be positive and finite, not {period_s} s.")
        self._foresight = KnowsTheArm(robot.chain) if foresight is None else foresight
        self._config = config or BoltzmannConfig()
        self._period_s = period_s
        self._hold_calls = max(round(self._config.decision_s / period_s), 1)
        # The step that asks for the mode already has a zero input.
        self._switch_calls = max(round(self._config.switch_s / period_s), 1)
        self.reset()

    def reset(self) -> None:
        """Forget the held input, any switch under way and what was learned."""
        self._held = np.zeros(0)
        self._held_calls = 0
        self._calls = 0

    def act(
        self, context: Context, controller: Controller, mode: int, target: Pose, rng: np.random.Generator
    ) -> Input:
        """Hold the input of the last decision, or decide again."""
        time_s = self._calls * self._period_s
        self._calls += 1
        if self._held_calls > 0:
            self._held_calls -= 1
            return Input(self._held)
        options = self.options(context, controller, mode, target, time_s)
        choice = int(
            rng.choice(
                len(options.inputs) + 1, p=np.append(options.input_probability, options.switch_probability)
            )
        )
        switches = choice == len(options.inputs)
        self._held = np.zeros(controller.input_dim) if switches else options.inputs[choice]
        self._held_calls = (self._switch_calls if switches else self._hold_calls) - 1
        return Input(self._held, switch_mode=switches)

    def options(
        self, context: Context, controller: Controller, mode: int, target: Pose, time_s: float = 0.0
    ) -> Options:
        """Equation 24 in the present context.

        Args:
            context: what the arm is at and believes.
            controller: what the inputs go to.
            mode: the controller's present mode.
            target: the pose ``g*`` that the simulated person wants.
            time_s: t of ``beta(t)``, since the drive began, s.

        Returns:
            Every option and its probability.
        """
        inputs = self._grid(controller.input_dim)
        cost = self.costs(context, controller, target)
        others = (float(best) for other, best in enumerate(cost.min(axis=-1)) if other != mode)
        switch_cost = (np.sqrt(min(others, default=np.inf)) + self._config.switch_cost) ** 2
        beta = self._config.beta + self._config.beta_per_s * time_s
        probability = boltzmann(np.append(cost[mode], switch_cost), beta)
        return Options(inputs, probability[:-1], float(probability[-1]))

    @property
    def holding(self) -> bool:
        """Whether the next call of `act` holds an input, or waits for a mode, without deciding."""
        return self._held_calls > 0

    def costs(self, context: Context, controller: Controller, target: Pose) -> FloatArray:
        """Squared distances (M, K), m², that K inputs leave in each of M modes; the first is none."""
        inputs = self._grid(controller.input_dim)
        reached = self._foresight(inputs, context, controller, self._config.horizon_s)
        angle = self._config.rotation_weight * angle_between(reached.rotation, target.rotation)
        return ((reached.position - target.position) ** 2).sum(axis=-1) + angle**2

    def _grid(self, input_dim: int) -> FloatArray:
        """The inputs that are considered, (K, d), the first of them zero."""
        if input_dim == 2:
            angle = np.arange(self._config.directions) * (2 * np.pi / self._config.directions)
            directions = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        else:
            directions = np.concatenate([np.eye(input_dim), -np.eye(input_dim)])
        sized = [size * directions for size in self._config.magnitudes]
        return np.concatenate([np.zeros((1, input_dim)), *sized])
