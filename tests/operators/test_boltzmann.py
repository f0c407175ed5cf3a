from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.controllers.end_effector import EndEffectorController
from latentarm.errors import UserError
from latentarm.operators.boltzmann import BoltzmannConfig, BoltzmannOperator
from latentarm.robots.catalogue import load_robot
from latentarm.types import Context

PLANAR = load_robot("planar")
BENT = PLANAR.home + np.linspace(0.2, 0.6, PLANAR.dof)
HERE = Context(BENT, np.zeros(0))


def pose_after(joint_moves):
    return PLANAR.chain.forward(BENT + np.asarray(joint_moves))


def operator(**changes):
    return BoltzmannOperator(PLANAR, replace(BoltzmannConfig(), **changes), period_s=0.05)


AHEAD = pose_after([0.4, -0.3, 0.2, 0.1, 0.0])


def test_all_probabilities_together_are_one(any_axes):
    options = operator().options(HERE, any_axes, 0, AHEAD)
    assert options.inputs.shape[1] == any_axes.input_dim
    assert not options.inputs[0].any()
    assert (np.abs(options.inputs) <= 1).all()
    assert options.switch_probability == 0.0
    assert options.input_probability.sum() == pytest.approx(1.0)


@given(st.floats(0, 1e4))
def test_probabilities_follow_equation_24(beta):
    from_config = BoltzmannConfig()
    controller = EndEffectorController(PLANAR)
    options = operator(beta=beta).options(HERE, controller, 0, AHEAD)
    reached = PLANAR.chain.forward(BENT + from_config.horizon_s * controller.action(options.inputs, HERE, 0))
    turn = AHEAD.rotation[1, 0] * reached.rotation[:, 0, 0] - AHEAD.rotation[0, 0] * reached.rotation[:, 1, 0]
    cosine = (AHEAD.rotation[:, 0] * reached.rotation[:, :, 0]).sum(axis=1)
    angle = np.arctan2(turn, cosine)
    cost = ((reached.position - AHEAD.position) ** 2).sum(axis=1) + (from_config.rotation_weight * angle) ** 2
    weight = np.exp(-beta * (cost - cost.min()))
    wanted = weight / weight.sum() * (1 - options.switch_probability)
    assert options.input_probability == pytest.approx(wanted, abs=1e-9)


def test_inputs_come_as_often_as_their_probability_says(one_mode):
    person = operator(beta=300.0, decision_s=0.05)
    options = person.options(HERE, one_mode, 0, AHEAD)
    rng = np.random.default_rng(0)
    draws = 4000
    seen = np.zeros(len(options.inputs))
    for _ in range(draws):
        u = person.act(HERE, one_mode, 0, AHEAD, rng).u
        seen[np.flatnonzero((options.inputs == u).all(axis=1))] += 1
    spread = np.sqrt(options.input_probability * (1 - options.input_probability) / draws)
    assert (np.abs(seen / draws - options.input_probability) <= 4.5 * spread + 1e-3).all()


def test_a_learner_is_at_each_moment_as_rational_as_they_have_become(one_mode):
    learner = operator(beta=10.0, beta_per_s=40.0)
    for time_s in (0.0, 0.5, 3.0):
        now = learner.options(HERE, one_mode, 0, AHEAD, time_s)
        same = operator(beta=10.0 + 40.0 * time_s).options(HERE, one_mode, 0, AHEAD)
        np.testing.assert_array_equal(now.input_probability, same.input_probability)


def test_a_learner_begins_at_random_and_ends_near_optimal_and_forgets_between_drives(one_mode):
    target = pose_after(0.25 * np.array([0.0, 1.0, 0.0, 0.0, 0.0]))
    learner = operator(beta=0.0, beta_per_s=1e5, decision_s=0.05)
    best = operator(beta=np.inf).act(HERE, one_mode, 0, target, np.random.default_rng(0)).u

    def first_and_last(seed):
        learner.reset()
        rng = np.random.default_rng(seed)
        given = [learner.act(HERE, one_mode, 0, target, rng).u for _ in range(100)]
        return given[0], given[-1]

    ends = [first_and_last(seed) for seed in range(40)]
    assert len(np.unique([first for first, _ in ends], axis=0)) > 10
    np.testing.assert_array_equal([last for _, last in ends], np.tile(best, (40, 1)))


def test_without_reason_every_option_is_as_likely(two_modes):
    options = operator(beta=0.0).options(HERE, two_modes, 0, AHEAD)
    each = 1 / (len(options.inputs) + 1)
    assert options.input_probability == pytest.approx(each)
    assert options.switch_probability == pytest.approx(each)


def test_the_more_rational_the_closer_they_expect_to_come(one_mode):
    def expected(beta):
        options = operator(beta=beta).options(HERE, one_mode, 0, AHEAD)
        reached = PLANAR.chain.forward(BENT + 0.5 * one_mode.action(options.inputs, HERE, 0))
        return options.input_probability @ ((reached.position - AHEAD.position) ** 2).sum(axis=1)

    distances = [expected(beta) for beta in (0.0, 10.0, 100.0, 1e3, 1e4, np.inf)]
    assert distances == sorted(distances, reverse=True)
    assert distances[0] > distances[-1]


def test_a_perfectly_rational_one_always_takes_the_best(one_mode):
    target = pose_after(0.5 * 0.5 * np.array([0.0, 1.0, 0.0, 0.0, 0.0]))
    person = operator(beta=np.inf)
    for seed in range(20):
        person.reset()
        given = person.act(HERE, one_mode, 0, target, np.random.default_rng(seed))
        assert given.u == pytest.approx([0.0, 1.0], abs=1e-12)


def test_at_the_target_a_rational_one_lets_go_even_if_the_decoder_drifts(planar, one_mode):
    class Drifts(type(one_mode)):
        def action(self, z, context, mode):
            return super().action(z, context, mode) + 0.3

    drifting = Drifts([0.5 * np.eye(planar.dof)[:2]])
    given = operator(beta=np.inf).act(HERE, drifting, 0, pose_after(0.0), np.random.default_rng(0))
    assert not given.u.any()


def test_an_input_is_held_until_the_next_decision(one_mode):
    person = operator(beta=0.0, decision_s=0.2)
    rng = np.random.default_rng(0)
    given = np.array([person.act(HERE, one_mode, 0, AHEAD, rng).u for _ in range(400)])
    for first in range(0, 400, 4):
        assert (given[first : first + 4] == given[first]).all()
    assert len(np.unique(given[::4], axis=0)) > 10


def test_a_mode_is_switched_for_a_gain_above_its_cost_and_not_below(two_modes):
    # Only the second mode's joints are off, so the first mode has nothing to offer.
    target = pose_after([0.0, 0.0, 0.25, 0.0, 0.0])
    gain = np.linalg.norm(PLANAR.chain.forward(BENT).position - target.position)
    switches = {
        cost: operator(beta=np.inf, rotation_weight=0.0, switch_cost=cost)
        .act(HERE, two_modes, 0, target, np.random.default_rng(0))
        .switch_mode
        for cost in (0.1 * gain, 10 * gain)
    }
    assert list(switches.values()) == [True, False]


def test_during_a_switch_there_is_no_input_and_one_request(two_modes):
    person = operator(beta=np.inf, switch_s=0.5)
    target = pose_after([0.0, 0.0, 0.25, 0.0, 0.0])
    rng = np.random.default_rng(0)
    given = [person.act(HERE, two_modes, 0, target, rng)]
    given += [person.act(HERE, two_modes, 1, target, rng) for _ in range(11)]
    assert [one.switch_mode for one in given] == [True] + 11 * [False]
    assert not np.array([one.u for one in given[:10]]).any()
    assert given[10].u.any()


def test_a_new_drive_begins_afresh(two_modes):
    person = operator(beta=np.inf, switch_s=5.0)
    rng = np.random.default_rng(0)
    assert person.act(HERE, two_modes, 0, pose_after([0, 0, 0.25, 0, 0]), rng).switch_mode
    person.reset()
    assert person.act(HERE, two_modes, 0, pose_after([0.25, 0, 0, 0, 0]), rng).u.any()


def test_the_same_seed_gives_the_same_person(two_modes):
    def inputs():
        person, rng = operator(beta=100.0), np.random.default_rng(7)
        return [person.act(HERE, two_modes, 0, AHEAD, rng).u for _ in range(50)]

    assert np.array_equal(inputs(), inputs())


def test_a_decoder_that_gives_no_numbers_makes_them_let_go(planar, one_mode):
    class Broken(type(one_mode)):
        def action(self, z, context, mode):
            return np.full((*z.shape[:-1], planar.dof), np.nan)

    given = operator().act(HERE, Broken([np.eye(planar.dof)[:2]]), 0, AHEAD, np.random.default_rng(0))
    assert not given.u.any()
    assert not given.switch_mode


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"beta": -1.0}, "beta"),
        ({"beta": float("nan")}, "beta"),
        ({"beta_per_s": -1.0}, "beta_per_s"),
        ({"beta_per_s": float("inf")}, "beta_per_s"),
        ({"horizon_s": 0.0}, "horizon_s"),
        ({"decision_s": float("inf")}, "decision_s"),
        ({"rotation_weight": -0.1}, "rotation_weight"),
        ({"switch_cost": float("nan")}, "switch_cost"),
        ({"switch_s": -1.0}, "switch_s"),
        ({"magnitudes": ()}, "magnitudes"),
        ({"magnitudes": (1.5,)}, "magnitudes"),
        ({"directions": 1}, "directions"),
    ],
)
def test_a_person_who_cannot_be_is_refused(wrong, named):
    with pytest.raises(UserError, match=named):
        BoltzmannConfig(**wrong)


def test_a_period_that_is_none_is_refused():
    with pytest.raises(UserError, match="time between inputs"):
        BoltzmannOperator(PLANAR, period_s=0.0)
