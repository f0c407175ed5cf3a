"""Contract tests of beliefs over goals."""

from collections.abc import Callable

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from latentarm.assistance.belief import ActionOf, Belief
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray

DOF, COUNT = 7, 3
GOALS = np.random.default_rng(0).normal(0.0, 1.0, (COUNT, DOF))
MakeBelief = Callable[..., Belief]
states = hnp.arrays(float, DOF, elements=st.floats(-3, 3))
inputs = hnp.arrays(float, 2, elements=st.floats(-1, 1))
weights = hnp.arrays(float, COUNT, elements=st.floats(0.01, 1))
maps = hnp.arrays(float, (2, DOF), elements=st.floats(-1, 1))
seeds = st.integers(0, 2**32 - 1)
anything = st.floats(allow_nan=True, allow_infinity=True)
# A rule is a class without state, so one serves all examples and every subclass of the tests.
law = settings(
    max_examples=40,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.differing_executors],
)


def linear(matrix: FloatArray) -> ActionOf:
    """Actions that are linear in the input."""
    return lambda u: u @ matrix


def _drift(u: FloatArray) -> FloatArray:
    """Actions that are not zero where the input is."""
    return u.sum(axis=-1, keepdims=True) + np.ones(DOF)


class BeliefContract:
    """Tests of a rule, which is a class of beliefs.

    Override the fixture ``rule``::

        class TestTheirBelief(BeliefContract):
            @pytest.fixture
            def rule(self):
                return TheirBelief

    The class is called with ``goals``, and by name with ``period_s``, ``prior`` and ``floor``.
    """

    @pytest.fixture
    def rule(self) -> MakeBelief:
        """The class."""
        raise NotImplementedError("override the fixture `rule`")

    @law
    @given(weights, inputs, states, maps)
    def test_a_belief_stays_a_distribution_above_its_floor(
        self, rule: MakeBelief, prior: FloatArray, u: FloatArray, state: FloatArray, matrix: FloatArray
    ) -> None:
        model = rule(GOALS, floor=0.02, prior=prior)
        belief = model.initial()
        for _ in range(3):
            belief = model.update(belief, u, state, linear(matrix))
        assert belief.sum() == pytest.approx(1.0)
        assert (belief >= 0.02).all()

    def test_ten_thousand_steps_leave_it_sound(self, rule: MakeBelief) -> None:
        """Without a floor, where rounding could take a goal's probability below zero or lose it for ever."""
        rng = np.random.default_rng(0)
        model = rule(GOALS, floor=0.0)
        people, axes = 4, 2
        belief = np.tile(model.initial(), (people, 1))
        inputs = rng.uniform(-1, 1, (10_000, people, axes))
        inputs[rng.random((10_000, people)) < 0.1] = 0.0
        inputs[rng.random((10_000, people)) < 0.1] = np.nan
        matrix, state = rng.normal(size=(axes, DOF)), rng.normal(size=(people, DOF))
        for u in inputs:
            belief = model.update(belief, u, state, linear(matrix))
            assert (belief >= 0.0).all()
            assert abs(belief.sum(axis=-1) - 1).max() < 1e-12

    @law
    @given(weights)
    def test_it_begins_with_its_prior(self, rule: MakeBelief, prior: FloatArray) -> None:
        model = rule(GOALS, prior=prior, floor=0.0)
        assert model.initial() == pytest.approx(prior / prior.sum())
        assert rule(GOALS).initial() == pytest.approx(1 / COUNT)

    @law
    @given(weights, inputs, states, maps)
    def test_the_prior_is_carried_on(
        self, rule: MakeBelief, prior: FloatArray, u: FloatArray, state: FloatArray, matrix: FloatArray
    ) -> None:
        """Bayes' rule: odds before and after differ by what the input says, whatever they were."""
        plain, other = rule(GOALS, floor=0.0), rule(GOALS, prior=prior, floor=0.0)
        said = plain.update(plain.initial(), u, state, linear(matrix))
        after = other.update(other.initial(), u, state, linear(matrix))
        assert after == pytest.approx(prior * said / (prior * said).sum(), abs=1e-9)

    @law
    @given(weights, states, maps)
    def test_an_input_of_zero_says_nothing(
        self, rule: MakeBelief, prior: FloatArray, state: FloatArray, matrix: FloatArray
    ) -> None:
        model = rule(GOALS, prior=prior)
        belief = model.initial()
        for axes in (1, 2, 3):
            after = model.update(belief, np.zeros(axes), state, _drift)
            assert np.array_equal(after, belief)

    @law
    @given(weights, inputs, states, maps, st.permutations(range(COUNT)))
    def test_naming_the_goals_in_another_order_changes_nothing_else(
        self,
        rule: MakeBelief,
        prior: FloatArray,
        u: FloatArray,
        state: FloatArray,
        matrix: FloatArray,
        order: list[int],
    ) -> None:
        model, shuffled = rule(GOALS, prior=prior), rule(GOALS[order], prior=prior[order])
        after = model.update(model.initial(), u, state, linear(matrix))
        assert shuffled.update(shuffled.initial(), u, state, linear(matrix)) == pytest.approx(after[order])

    @law
    @given(st.floats(0.1, 2), st.floats(-1, 1), st.floats(-0.5, 0.5), st.integers(1, 3), seeds)
    def test_goals_to_either_side_of_the_motion_are_told_apart_by_nothing(
        self, rule: MakeBelief, apart: float, ahead: float, speed: float, axes: int, seed: int
    ) -> None:
        """Goals mirrored in the line of motion, and alternatives mirrored with them."""
        goals = np.array([[apart, ahead], [-apart, ahead]])
        u = np.zeros(axes)
        u[0] = np.random.default_rng(seed).choice([-1.0, 1.0])
        matrix = np.zeros((axes, 2))
        matrix[0, 1] = speed
        if axes > 1:
            matrix[1, 0] = speed
        model = rule(goals, prior=np.array([0.3, 0.7]))
        after = model.update(model.initial(), u, np.zeros(2), linear(matrix))
        assert after == pytest.approx([0.3, 0.7], abs=1e-9)

    @law
    @given(st.integers(0, COUNT - 1), st.floats(0.2, 1.0), st.integers(1, 3))
    def test_moving_straight_to_a_goal_raises_its_probability(
        self, rule: MakeBelief, goal: int, size: float, axes: int
    ) -> None:
        state = GOALS.mean(axis=0)
        away = GOALS[goal] - state
        rest = np.linalg.svd(GOALS - state)[2][COUNT : COUNT + axes - 1]
        matrix = 0.3 * np.vstack([away / np.linalg.norm(away), rest])
        u = np.zeros(axes)
        u[0] = size
        model = rule(GOALS)
        belief = model.initial()
        for _ in range(150):
            after = model.update(belief, u, state, linear(matrix))
            assert after[goal] > belief[goal] or after[goal] > 0.97
            belief = after
        assert belief.argmax() == goal

    def test_a_person_can_change_their_mind(self, rule: MakeBelief) -> None:
        model = rule(GOALS, floor=0.01)
        belief, state = model.initial(), np.zeros(DOF)
        for goal in (0, 1):
            for _ in range(3000):
                belief = model.update(
                    belief, np.array([1.0, 0.0]), state, linear(np.stack([GOALS[goal], -GOALS[2]]) / 5)
                )
            assert belief.argmax() == goal
            assert belief[goal] == pytest.approx(0.98)

    @law
    @given(seeds, st.integers(1, 4))
    def test_many_at_once_are_as_each_alone(self, rule: MakeBelief, seed: int, axes: int) -> None:
        rng = np.random.default_rng(seed)
        model = rule(GOALS)
        shape = (2, 5)
        belief = rng.dirichlet(np.ones(COUNT), size=shape)
        u, state = rng.uniform(-1, 1, (*shape, axes)), rng.normal(size=(*shape, DOF))
        u[0, 0], u[0, 1], u[1, 2] = 0.0, np.nan, np.inf
        matrices = rng.normal(size=(*shape, axes, DOF))
        matrices[1, 3] = np.nan
        together = model.update(belief, u, state, lambda inputs: np.tanh(inputs @ matrices))
        for index in np.ndindex(shape):
            matrix = matrices[index]
            alone = model.update(
                belief[index], u[index], state[index], lambda inputs, matrix=matrix: np.tanh(inputs @ matrix)
            )
            np.testing.assert_allclose(together[index], alone, rtol=1e-12)
        for index in ((0, 0), (0, 1), (1, 2), (1, 3)):
            assert np.array_equal(together[index], belief[index])
        for inputs in (u, np.zeros_like(u)):
            assert model.update(model.initial(), inputs, np.zeros(DOF), _drift).shape == (*shape, COUNT)

    @law
    @given(hnp.arrays(float, 2, elements=anything), hnp.arrays(float, (2, DOF), elements=anything))
    def test_inputs_and_actions_that_are_no_numbers_leave_a_sound_belief(
        self, rule: MakeBelief, u: FloatArray, matrix: FloatArray
    ) -> None:
        model = rule(GOALS)
        after = model.update(model.initial(), u, np.zeros(DOF), linear(matrix))
        assert after.sum() == pytest.approx(1.0)
        assert (after >= model.floor).all()

    @law
    @given(hnp.arrays(float, (4, DOF), elements=anything), hnp.arrays(float, DOF, elements=anything))
    def test_what_is_seen_may_be_anything_too(
        self, rule: MakeBelief, actions: FloatArray, state: FloatArray
    ) -> None:
        model = rule(GOALS)
        after = model.observe(model.initial(), state, actions)
        assert after.sum() == pytest.approx(1.0)
        if not np.isfinite(actions).all():
            assert np.array_equal(after, model.initial())

    @pytest.mark.parametrize(
        ("wrong", "named"),
        [
            ({"period_s": float("inf")}, "period_s"),
            ({"period_s": 0.0}, "period_s"),
            ({"floor": 0.4}, "floor"),
            ({"floor": 1 / 3}, "floor"),
            ({"floor": float("nan")}, "floor"),
            ({"prior": np.array([0.5, 0.5])}, "prior"),
            ({"prior": np.array([1.0, 0.0, 0.0])}, "prior"),
            ({"goals": np.full((2, DOF), np.nan)}, "goal"),
            ({"goals": np.zeros((0, DOF))}, "goal"),
        ],
    )
    def test_parameters_out_of_range_are_refused(
        self, rule: MakeBelief, wrong: dict[str, object], named: str
    ) -> None:
        with pytest.raises(UserError, match=named):
            rule(**{"goals": GOALS, **wrong})
