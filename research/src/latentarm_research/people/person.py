"""A simulated person: what they imagine, how they decide, and what their hand does."""

from dataclasses import dataclass, field, replace
from typing import final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import BoolArray, Context, Input, Pose
from latentarm.robots.robot import Robot
from latentarm_research.people import contract
from latentarm_research.people.anticipation import Anticipation
from latentarm_research.people.boltzmann import BoltzmannConfig, OneStep
from latentarm_research.people.lapses import LapseConfig, Lapsing
from latentarm_research.people.linear_guess import LinearGuess, LinearGuessConfig
from latentarm_research.people.motor_noise import Hand, HandConfig
from latentarm_research.people.own_directions import OwnSpeed
from latentarm_research.people.page_rates import PageRates, Screen, Wire
from latentarm_research.people.planning import Planning, PlanningConfig
from latentarm_research.people.ring_reading import RingDecision, RingReading, RingReadingConfig


@final
@dataclass(frozen=True)
class Person:
    """A simulated person, put together from parts."""

    # how they think of one step (equation 24)
    decides: BoltzmannConfig = field(default_factory=BoltzmannConfig)
    # where they expect an input to lead: by a linear guess that they learn, or by the page's ring that they
    # read; None knows the arm and its decoder exactly
    imagines: LinearGuessConfig | RingReadingConfig | None = None
    plans: PlanningConfig | None = None  # how far they plan where one step leads no nearer; None never plans
    hand: HandConfig = field(default_factory=HandConfig)  # how late and how unsteady their hand is
    speed: OwnSpeed = field(default_factory=OwnSpeed)  # how fast they like to go
    lapses: LapseConfig | None = None  # how their attention lapses; None never
    # whether they make up for their reaction time by what they know that they have pushed
    anticipates: bool = False
    page: PageRates | None = None  # what they drive through; None sees and is heard at once


@final
class SimulatedPerson:
    """A simulated person at the interface, whom a `Person` describes, asked once per step of the loop.

    They remember what they were doing (an input that they hold, a switch under way), so a new drive begins
    with `reset`.

    Args:
        robot: the arm.
        person: who drives it.
        period_s: time between calls of `act`, s.
        limits: what the loop makes of inputs. They mean no push that it takes for rest, but a tremor may make
            one so; of its limits on speed only those people know who know the arm, or are shown where
            it leads.
    """

    def __init__(
        self, robot: Robot, person: Person, period_s: float, limits: contract.LoopLimits = contract.UNLIMITED
    ) -> None:
        self._imagination = _imagination(robot, person, period_s, limits)
        self._decision = _decision(robot, person, period_s, limits)
        self._hand = Hand(person.hand, period_s)
        self._speed = person.speed
        self._limits = limits
        self._anticipation = Anticipation(robot.chain, limits, period_s) if person.anticipates else None
        self._screen = Screen(person.page, period_s) if person.page else None
        self._wire = Wire(person.page, period_s) if person.page else None
        self.reset()

    def reset(self) -> None:
        """Forget everything of the last drive."""
        self._imagination.reset()
        self._decision.reset()
        self._hand.reset()
        for part in (self._anticipation, self._screen, self._wire):
            if part is not None:
                part.reset()
        self._given: Input | None = None

    def act(
        self,
        context: Context,
        controller: Controller,
        mode: int,
        target: Pose,
        rng: np.random.Generator,
        within_m: float = contract.USUAL_WITHIN_M,  # how near they have to come to it, m
        speed: float = 1.0,  # share of their usual speed that is fit there, in (0, 1]
        held: BoolArray = contract.NOTHING_HELD,  # (K,), which of the context's things the tool holds
    ) -> Input:
        """See, learn, decide and move the hand: an input in [-1, 1]^d, and whether they switch modes."""
        u = np.zeros(controller.input_dim) if self._given is None else self._given.u
        moment = contract.Moment(context, mode, target, u, within_m, speed, held)
        seen = self._hand.sees(moment if self._screen is None else self._screen.shown(moment))
        self._imagination.saw(seen)
        if self._anticipation is not None and not self._decision.holding:
            seen = self._anticipation.now(moment, seen, controller)
        meant = self._decision.decide(seen, controller, self._imagination, rng)
        meant = replace(meant, u=OwnSpeed(speed * self._speed.share).pushed(meant.u, self._limits))
        if self._anticipation is not None:
            self._anticipation.meant(moment, meant.u)
        self._given = self._hand.gives(meant, rng)
        return self._given if self._wire is None else self._wire.carried(self._given)


def _imagination(
    robot: Robot, person: Person, period_s: float, limits: contract.LoopLimits
) -> contract.Imagination:
    if isinstance(person.imagines, LinearGuessConfig):
        return LinearGuess(robot.chain, person.imagines, period_s)
    if isinstance(person.imagines, RingReadingConfig):
        return RingReading(robot.chain, person.imagines, limits)
    return contract.KnowsTheArm(robot.chain, limits)


def _decision(
    robot: Robot, person: Person, period_s: float, limits: contract.LoopLimits
) -> contract.Decision:
    if isinstance(person.imagines, RingReadingConfig):
        decision: contract.Decision = RingDecision(
            person.decides, person.imagines, period_s, limits.dead_zone
        )
    elif person.plans is None:
        decision = OneStep(person.decides, period_s, limits.dead_zone)
    else:
        decision = Planning(robot, person.decides, person.plans, period_s, limits)
    return decision if person.lapses is None else Lapsing(decision, person.lapses, period_s)
