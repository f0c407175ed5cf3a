"""A simulated person who plans a few seconds ahead when one step brings the tool no closer."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import FloatArray, Input, IntArray
from latentarm.robots.robot import Robot
from latentarm_research.people.boltzmann import BoltzmannConfig, OneStep
from latentarm_research.people.contract import Decision, Imagination, LoopLimits, Moment
from latentarm_research.people.motion import carried
from latentarm_research.people.motor_noise import within_reach

BEYOND: Final = 0.01
"""Initial inputs of a plan lie this far beyond the dead zone: within it nothing they do changes anything, and
exactly at rest decoders that use the input's length have no gradient."""

SOMEWHERE: Final = 0.7  # inputs of another plan to begin with are drawn from ± this
DIFFERENCE: Final = 1e-3  # of an input, for slopes
FIRST_DAMPING: Final = 1e-2
CHANGE: Final = 5.0
"""The damping is relative to the curvature; it shrinks by this after a step that helped, and grows after one
that did not."""


@final
@dataclass(frozen=True)
class PlanningConfig:
    """How far ahead the simulated person plans."""

    pieces: int = 8  # maximum number in a plan; the input is constant in each
    piece_s: float = 0.5  # length of a piece, s
    steps: int = 2  # of the imagined motion in a piece
    iterations: int = 5  # iterations of plan optimisation
    stuck_m: float = 0.004  # a step that brings the tool closer by less than this is no progress, m
    # a plan that ends this near the target will do, m; a radian counts as `rotation_weight`
    arrived_m: float = 0.02


@final
class Planning(Decision):
    """Decides like `OneStep`, and plans when that gets stuck.

    Stuck is where neither an input nor another mode brings the tool nearer by ``stuck_m``. Then the person
    imagines plans of 1, 2, ... pieces in the present mode, all bettered together by damped Gauss-Newton steps
    on where they end, and takes the shortest that arrives, or the one that ends nearest. Its first piece is
    given, and planned anew after it, until the plan is through. If no plan leads closer either, they take an
    ordinary step. They predict with the controller itself; no person is that good, but it is the same for
    all controllers.
    """

    def __init__(
        self,
        robot: Robot,
        config: BoltzmannConfig,
        planning: PlanningConfig,
        period_s: float,  # time between calls of `decide`, s
        limits: LoopLimits,
    ) -> None:
        self._config = config
        self._planning = planning
        self._limits = limits
        self._one_step = OneStep(config, period_s, limits.dead_zone)
        self._chain = robot.chain
        self._hold_calls = max(round(planning.piece_s / period_s), 1)
        self.reset()

    def reset(self) -> None:
        """Forget the plan and what was held."""
        self._one_step.reset()
        self._rest_of_plan = np.zeros((0, 0))
        self._held = np.zeros(0)
        self._held_calls = 0

    @property
    def holding(self) -> bool:
        """Whether the next call of `decide` holds a piece of a plan, or an input."""
        return self._held_calls > 0 or self._one_step.holding

    def decide(
        self, moment: Moment, controller: Controller, imagination: Imagination, rng: np.random.Generator
    ) -> Input:
        """Hold the piece of a plan, follow a plan, or take one step."""
        if self._held_calls > 0:
            self._held_calls -= 1
            return Input(self._held)
        if self._one_step.holding:
            return self._one_step.decide(moment, controller, imagination, rng)
        outlook = self._one_step.outlook(moment, controller, imagination, rng)
        following = len(self._rest_of_plan) > 0
        if following or outlook.rest_m - outlook.left_m <= self._planning.stuck_m:
            plan, leaves = self._plan(moment, controller, rng)
            if following or outlook.rest_m - leaves > self._planning.stuck_m:
                self._held, self._rest_of_plan = plan[0], plan[1:]
                self._held_calls = self._hold_calls - 1
                return Input(self._held)
        return self._one_step.take(outlook, rng)

    def _plan(
        self, moment: Moment, controller: Controller, rng: np.random.Generator
    ) -> tuple[FloatArray, float]:
        """Inputs (L, d), one for each of the L pieces of the plan that is taken, and what it leaves, m."""
        following = len(self._rest_of_plan) > 0
        near_rest = self._limits.dead_zone + BEYOND
        if following:
            # No longer than what is left of it: every plan comes to its end.
            starts = [self._rest_of_plan, np.full_like(self._rest_of_plan, near_rest)]
        else:
            shape = (self._planning.pieces, controller.input_dim)
            # A person who is stuck again tries something else.
            starts = [np.full(shape, near_rest), rng.uniform(-SOMEWHERE, SOMEWHERE, shape)]
        pieces = len(starts[0])
        length = np.repeat(np.arange(1, pieces + 1), len(starts))
        plans = np.tile(np.stack(starts), (pieces, 1, 1))
        plans, left = self._bettered(plans, length, moment, controller)
        arrives = np.flatnonzero(left < self._planning.arrived_m)
        taken = int(arrives[np.argmin(length[arrives])] if len(arrives) else np.argmin(left))
        return within_reach(plans[taken, : length[taken]]), float(left[taken])

    def _bettered(
        self,
        plans: FloatArray,
        length: IntArray,
        moment: Moment,
        controller: Controller,
    ) -> tuple[FloatArray, FloatArray]:
        """Plans (P, L, d), of which the first ``length`` pieces count, bettered, and what is left (P,), m."""
        shape, flat = plans.shape, plans.reshape(len(plans), -1)
        damping = np.full(len(flat), FIRST_DAMPING)

        def outcome(tried: FloatArray) -> tuple[FloatArray, FloatArray]:
            """Residual (P, 6), m, and its slope (P, 6, L d)."""
            inward = np.where(tried > 0, -DIFFERENCE, DIFFERENCE)
            varied = np.concatenate(
                [tried[:, None], tried[:, None] + inward[:, None] * np.eye(tried.shape[1])], axis=1
            )
            ends = self._imagined(varied.reshape(*varied.shape[:2], *shape[1:]), length, moment, controller)
            residual = self._residual(ends, moment)
            slope = (residual[:, 1:] - residual[:, :1]) / inward[..., None]
            return residual[:, 0], slope.mT

        residual, slope = outcome(flat)
        left = np.linalg.norm(residual, axis=-1)
        for _ in range(self._planning.iterations):
            tried = np.clip(flat + _step(flat, residual, slope, damping), -1.0, 1.0)
            new_residual, new_slope = outcome(tried)
            new_left = np.linalg.norm(new_residual, axis=-1)
            better = new_left < left
            flat = np.where(better[:, None], tried, flat)
            residual = np.where(better[:, None], new_residual, residual)
            slope = np.where(better[:, None, None], new_slope, slope)
            left = np.where(better, new_left, left)
            damping = np.where(better, damping / CHANGE, damping * CHANGE)
        return flat.reshape(shape), left

    def _imagined(
        self, plans: FloatArray, length: IntArray, moment: Moment, controller: Controller
    ) -> FloatArray:
        """States (P, V, n) at the end of plans (P, V, L, d) of so many pieces.

        The arm rests in a piece where the first of the V variations of a plan is in the dead zone: so the
        others, which differ from it by `DIFFERENCE`, show no step at its edge for a slope.
        """
        step_s, mode = self._planning.piece_s / self._planning.steps, moment.mode
        context = moment.context
        state = np.broadcast_to(context.state, (*plans.shape[:2], len(context.state)))
        ends: list[FloatArray] = []
        for piece in range(plans.shape[2]):
            u = within_reach(plans[:, :, piece])
            pushed = self._limits.is_push(u[:, :1])[..., None]
            for _ in range(self._planning.steps):
                here = carried(self._chain, context, moment.held, state)
                action = controller.action(controller.latent(u, here, mode), here, mode)
                state = state + step_s * np.where(pushed, self._limits.slowed(action), 0.0)
            ends.append(state)
        return np.stack(ends)[length - 1, np.arange(len(plans))]

    def _residual(self, state: FloatArray, moment: Moment) -> FloatArray:
        """How far, (..., 6), m, the tool is from the target."""
        return self._config.missed(moment.target, self._chain.forward(state), moment.within_m)


def _step(flat: FloatArray, residual: FloatArray, slope: FloatArray, damping: FloatArray) -> FloatArray:
    """Damped Gauss-Newton step (P, L d) in the inputs that are free to move inside the box."""
    gradient = np.einsum("pri,pr->pi", slope, residual)
    held = ((flat >= 1.0) & (gradient < 0)) | ((flat <= -1.0) & (gradient > 0))
    free = np.where(held[:, None], 0.0, slope)
    gram = free @ free.mT
    ridge = damping * np.trace(gram, axis1=1, axis2=2) + np.finfo(float).tiny
    solved = np.linalg.solve(gram + ridge[:, None, None] * np.eye(gram.shape[-1]), residual[..., None])
    return -(free.mT @ solved)[..., 0]
