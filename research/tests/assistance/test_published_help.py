"""Hindsight optimisation, HARMONIC's interpolation and policy blending, and the belief that they share."""

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.resolved_rates import Damping
from latentarm_research.assistance.cost_to_go import TICK_S, HindsightBelief
from latentarm_research.assistance.published_help import (
    HindsightOptimisation,
    Interpolation,
    PolicyBlending,
    published_assistance,
    published_belief,
)

PANDA = load_robot("panda")
GOALS = PANDA.home + np.array(
    [[0.3, 0.1, 0, 0, 0, 0, 0], [-0.3, 0.1, 0, 0, 0, 0, 0], [0.0, 0.3, 0, 0.3, 0, 0, 0]]
)
PUSH, REST = np.array([1.0, 0.0]), np.zeros(2)
EVEN = np.full(3, 1 / 3)

near_home = hnp.arrays(float, 7, elements=st.floats(-0.3, 0.3)).map(lambda moved: PANDA.home + moved)
velocities = hnp.arrays(float, 7, elements=st.floats(-1, 1))
beliefs = hnp.arrays(float, 3, elements=st.floats(0.01, 1)).map(lambda weights: weights / weights.sum())


def towards(goal, state=PANDA.home, speed=0.2):
    """Joint velocities that bring the tool straight to a goal's place."""
    chain = PANDA.chain
    way = chain.forward(GOALS[goal]).position - chain.forward(state).position
    return np.linalg.pinv(chain.jacobian(state)) @ np.r_[speed * way / np.linalg.norm(way), 0, 0, 0]


class TestBelief:
    @settings(max_examples=15)
    @given(beliefs, near_home, hnp.arrays(float, (2, 7), elements=st.floats(-2, 2)))
    def test_it_sums_to_one_and_is_never_surer_than_published(self, prior, state, matrix):
        rule = HindsightBelief(GOALS, PANDA, prior=prior, period_s=0.5)
        belief = rule.initial()
        for _ in range(3):
            belief = rule.update(belief, PUSH, state, lambda inputs: inputs @ matrix)
            assert belief.sum() == pytest.approx(1.0)
            assert belief.max() <= 0.99 + 1e-12

    def test_it_falls_by_q_less_v_forty_times_a_second(self):
        rule = HindsightBelief(GOALS, PANDA)
        action = towards(0)
        by_hand = rule.log_likelihood(PANDA.home, action[None])
        after = rule.update(EVEN, PUSH, PANDA.home, lambda inputs: inputs[..., :1] * action)
        assert np.log(after[0] / after[1]) == pytest.approx(by_hand[0] - by_hand[1])
        # Half of it in half a tick.
        half = HindsightBelief(GOALS, PANDA, period_s=TICK_S / 2)
        after = half.update(EVEN, PUSH, PANDA.home, lambda inputs: inputs[..., :1] * action)
        assert np.log(after[0] / after[1]) == pytest.approx((by_hand[0] - by_hand[1]) / 2)
        # Straight to the first goal, and away from the second.
        assert by_hand[0] > by_hand[2] > by_hand[1]

    def test_who_drives_to_a_goal_is_believed(self):
        rule = published_belief(PANDA)(GOALS, period_s=0.1)
        for goal in range(3):
            belief, state = rule.initial(), PANDA.home
            for _ in range(20):
                action = towards(goal, state)
                belief = rule.update(belief, PUSH, state, lambda inputs, a=action: inputs[..., :1] * a)
                state = state + 0.1 * action * min(1.0, np.linalg.norm(GOALS[goal] - state))
            assert belief.argmax() == goal
            assert belief[goal] > 0.8

    def test_what_is_over_the_most_is_shared_evenly(self):
        rule = HindsightBelief(GOALS, PANDA, prior=np.array([0.998, 0.0015, 0.0005]))
        assert rule.initial() == pytest.approx([0.99, 0.0055, 0.0045])

    def test_a_single_goal_keeps_its_belief(self):
        assert HindsightBelief(GOALS[:1], PANDA).initial() == pytest.approx([1.0])

    @pytest.mark.parametrize("most", [0.3, 1.1, float("nan")])
    def test_a_most_that_is_none_is_refused(self, most):
        with pytest.raises(UserError, match="most"):
            HindsightBelief(GOALS, PANDA, most=most)


class TestExpectedHelp:
    @settings(max_examples=15)
    @given(beliefs, near_home, velocities)
    def test_it_is_the_mean_over_goals_within_the_published_gains(self, belief, state, action):
        expected = HindsightOptimisation(GOALS, PANDA)
        twist = expected.twist(action, state, belief)
        each = np.stack([expected.twist(action, state, one) for one in np.eye(3)])
        assert twist == pytest.approx(belief @ each)
        assert np.linalg.norm(twist[:3]) <= 0.2
        assert np.linalg.norm(twist[3:]) <= 0.4

    def test_the_tool_moves_with_that_twist(self):
        expected = HindsightOptimisation(GOALS, PANDA)
        jacobian = PANDA.chain.jacobian(PANDA.home)
        assert np.linalg.svd(jacobian, compute_uv=False)[-1] > Damping().threshold
        moved = jacobian @ expected.action(np.zeros(7), PANDA.home, EVEN)
        assert moved == pytest.approx(expected.twist(np.zeros(7), PANDA.home, EVEN))

    def test_it_leads_to_a_goal_that_is_certain_and_stays_there(self):
        expected = HindsightOptimisation(GOALS, PANDA)
        state, certain = PANDA.home.copy(), np.array([0.0, 0.0, 1.0])
        for _ in range(1500):
            state = state + 0.02 * expected.action(np.zeros(7), state, certain)
        reached, wanted = PANDA.chain.forward(state), PANDA.chain.forward(GOALS[2])
        assert reached.position == pytest.approx(wanted.position, abs=5e-3)
        assert reached.rotation == pytest.approx(wanted.rotation, abs=0.02)


class TestWays:
    def test_hindsight_optimisation_adds_to_the_person_and_acts_at_rest(self):
        way = HindsightOptimisation(GOALS, PANDA)
        assert way.acts_at_rest
        action = towards(0)
        given = way.contribution(PUSH, action, PANDA.home, EVEN)
        assert (given.alpha, given.added) == (0.0, 1.0)
        assert given.with_person(action) == pytest.approx(action + given.action)
        at_rest = way.contribution(REST, np.zeros(7), PANDA.home, EVEN)
        assert np.linalg.norm(at_rest.with_person(np.zeros(7))) > 0.01

    @settings(max_examples=15)
    @given(st.floats(0, 1))
    def test_interpolation_is_between_the_person_and_the_robot(self, weight):
        way = Interpolation(GOALS, PANDA, weight)
        action = towards(0)
        given = way.contribution(PUSH, action, PANDA.home, EVEN)
        assert given.with_person(action) == pytest.approx((1 - weight) * action + weight * given.action)
        assert way.acts_at_rest == (weight > 0)

    def test_the_levels_of_harmonic(self):
        levels = [published_assistance(f"{name}_assist", PANDA)(GOALS) for name in ("low", "high")]
        weights = [one.contribution(PUSH, towards(0), PANDA.home, EVEN).alpha for one in levels]
        assert weights == pytest.approx([1 / 3, 2 / 3])
        full = published_assistance("full_assist", PANDA)(GOALS)
        assert full.acts_at_rest
        given = full.contribution(PUSH, towards(0), PANDA.home, EVEN)
        # What the person commands moves nothing by itself.
        assert given.with_person(towards(0)) == pytest.approx(given.with_person(towards(1)))

    def test_policy_blending_waits_until_one_goal_is_ahead(self):
        way = PolicyBlending(GOALS, PANDA)
        action = towards(0)
        unsure = way.contribution(PUSH, action, PANDA.home, np.array([0.6, 0.2, 0.2]))
        assert np.array_equal(unsure.with_person(action), action)
        sure = way.contribution(PUSH, action, PANDA.home, np.array([0.61, 0.2, 0.19]))
        certain = HindsightOptimisation(GOALS, PANDA).action(action, PANDA.home, np.array([1.0, 0.0, 0.0]))
        assert sure.with_person(action) == pytest.approx(action + certain)
        alone = PolicyBlending(GOALS[:1], PANDA)
        assert alone.contribution(PUSH, action, PANDA.home, np.ones(1)).added == 1.0
