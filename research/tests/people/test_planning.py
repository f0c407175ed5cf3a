import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import Context
from latentarm.robots.planar import planar
from latentarm_research.people.boltzmann import BoltzmannConfig
from latentarm_research.people.contract import UNLIMITED, LoopLimits
from latentarm_research.people.person import Person, SimulatedPerson
from latentarm_research.people.planning import PlanningConfig

ARM = planar(2)
START = np.array([0.0, 1.0])
PERIOD_S = 0.1


class Driven(Controller):
    """An axis for each joint; where parked, the second moves only as far as the
    first joint is turned aside."""

    def __init__(self, parked):
        self._parked = parked

    @property
    def modes(self):
        return ("only",)

    @property
    def input_dim(self):
        return 2

    def latent(self, u, context, mode):
        return u

    def action(self, z, context, mode):
        second = z[..., 1] * (3.0 * context.state[..., 0] ** 2 if self._parked else 1.0)
        return 0.5 * np.stack([z[..., 0], second], axis=-1)


class Fading(Driven):
    """The second joint moves towards the target, the faster the lighter the push."""

    def action(self, z, context, mode):
        speed = 0.5 * np.maximum(0.6 - np.linalg.norm(z, axis=-1), 0.0)
        return np.stack([np.zeros_like(speed), speed], axis=-1)


def driven(operator, controller, target, seconds, seed=0, dead_zone=0.0):
    """Where the arm ends, and every input."""
    rng, state, inputs = np.random.default_rng(seed), START, []
    operator.reset()
    for _ in range(round(seconds / PERIOD_S)):
        given = operator.act(Context(state, np.zeros(0)), controller, 0, target, rng)
        inputs.append(given.u)
        if np.linalg.norm(given.u) > dead_zone:
            state = state + PERIOD_S * controller.action(given.u, Context(state, np.zeros(0)), 0)
    return state, np.array(inputs)


def one_step(config):
    return SimulatedPerson(ARM, Person(config), PERIOD_S)


def planner(config=None):
    decides = BoltzmannConfig() if config is None else config
    return SimulatedPerson(ARM, Person(decides, plans=PlanningConfig()), PERIOD_S)


def distance(state, target):
    return np.linalg.norm(ARM.chain.forward(state).position - target.position)


def test_who_plans_leaves_a_dead_end_that_one_step_does_not_leave():
    target = ARM.chain.forward(START + np.array([0.0, 0.5]))
    certain = BoltzmannConfig(beta=1e9)
    stuck, _ = driven(one_step(certain), Driven(True), target, 10.0)
    came, inputs = driven(planner(certain), Driven(True), target, 10.0)
    assert distance(stuck, target) > 0.05
    assert distance(came, target) < 0.02
    assert np.linalg.norm(inputs, axis=1).max() <= 1.0 + 1e-9


def test_who_is_not_stuck_does_as_equation_24_says():
    target = ARM.chain.forward(START + np.array([0.6, -0.6]))
    config = BoltzmannConfig()
    plain = driven(one_step(config), Driven(False), target, 0.4)[1]
    planning = driven(planner(config), Driven(False), target, 0.4)[1]
    np.testing.assert_array_equal(planning, plain)


def test_a_plan_comes_to_its_end():
    """Where nothing can help, no plan is followed for ever, and letting go is still possible."""
    target = ARM.chain.forward(START + np.array([0.0, 0.5]))

    class Useless(Driven):
        def action(self, z, context, mode):
            return 0.0 * super().action(z, context, mode)

    _, inputs = driven(planner(), Useless(True), target, 5.0)
    assert len(np.unique(inputs, axis=0)) > 1


def test_who_plans_knows_which_pushes_are_taken_for_rest():
    target = ARM.chain.forward(START + np.array([0.0, 0.5]))
    certain = Person(BoltzmannConfig(beta=1e9), plans=PlanningConfig())

    def left(limits):
        person = SimulatedPerson(ARM, certain, PERIOD_S, limits)
        return distance(driven(person, Fading(False), target, 6.0, dead_zone=0.2)[0], target)

    assert left(LoopLimits(0.2)) < 0.02
    assert left(UNLIMITED) > 0.1


def test_the_same_randomness_gives_the_same_drive():
    target = ARM.chain.forward(START + np.array([0.0, 0.5]))
    operator = planner()
    first, second = (driven(operator, Driven(True), target, 4.0, seed=3)[1] for _ in range(2))
    np.testing.assert_array_equal(first, second)
