"""The bound as a law: wherever it certifies, no person can keep the arm from coming nearer."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.assistance.blending import assistive_action, blend
from latentarm.core.errors import UserError
from latentarm.models.enclosure import linear_enclosure
from latentarm_research.assistance import bound
from latentarm_research.assistance.bound import furthest, known_help

MOMENTS = 100_000
FORMS = (furthest, known_help)


@dataclass(frozen=True, eq=False)
class Moments:
    """Many random moments with the same number of goals, and what the person does in each."""

    sigma_h: np.ndarray
    state: np.ndarray
    belief: np.ndarray
    goals: np.ndarray
    goal: np.ndarray
    alpha: np.ndarray
    gain: np.ndarray
    dt: np.ndarray
    phi: np.ndarray

    @property
    def bounded(self):
        return (self.sigma_h, self.state, self.belief, self.goals, self.goal, self.alpha)

    @property
    def wanted(self):
        return np.take_along_axis(self.goals, self.goal[:, None, None], axis=1)[:, 0]

    @property
    def sure(self):
        return np.take_along_axis(self.belief, self.goal[:, None], axis=1)[:, 0]

    @property
    def help(self):
        away = self.goals - self.state[:, None]
        return self.gain[:, None] * (self.belief[..., None] * away).sum(axis=1)

    @property
    def action(self):
        return blend(self.phi, self.help, self.alpha)


def moments(seed, count, goals, joints):
    """Spread over decades, so that each form certifies many and refuses many."""
    rng = np.random.default_rng(seed)

    def decades(low, high):
        return 10 ** rng.uniform(low, high, count)

    size = decades(-1, 1)[:, None, None]
    sharp = rng.gamma(decades(-1.5, 0.5)[:, None], size=(count, goals)) + 1e-12
    alpha = rng.uniform(1e-6, 1, count)
    alpha[rng.random(count) < 0.1] = 1.0
    sigma_h = decades(-3, 1)
    sigma_h[rng.random(count) < 0.05] = 0.0
    drawn = Moments(
        sigma_h=sigma_h,
        state=rng.normal(size=(count, joints)),
        belief=sharp / sharp.sum(axis=1, keepdims=True),
        goals=size * rng.normal(size=(count, goals, joints)),
        goal=rng.integers(0, goals, count),
        alpha=alpha,
        gain=decades(-1, 1),
        dt=decades(-3, 1),
        phi=np.zeros((count, joints)),
    )
    # Some steer anywhere, some straight away from the goal, some to where this step ends furthest from it.
    error = drawn.wanted - drawn.state
    ends = error - (drawn.dt * drawn.alpha)[:, None] * drawn.help
    ways = np.stack([rng.normal(size=(count, joints)), -error, -ends])
    way = ways[rng.integers(0, 3, count), np.arange(count)]
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-12)
    # A hair inside the ball: rounding must not take ‖phi‖ past sigma_h.
    return replace(drawn, phi=(1 - 1e-12) * sigma_h[:, None] * way)


def all_moments(seed):
    for goals in range(2, 11):
        yield moments(seed + goals, MOMENTS // 9 + 1, goals, joints=(2, 5, 7)[goals % 3])


def lyapunov_rate(state, goal_state, action):
    """``dV/dt = -e·a`` (equation 12), rad²/s; negative where the arm comes nearer."""
    return -((goal_state - state) * action).sum(axis=-1)


@settings(max_examples=3)
@given(st.integers(0, 2**31))
def test_wherever_it_certifies_the_error_shrinks(seed):
    held = np.zeros(len(FORMS), dtype=int)
    for drawn in all_moments(seed):
        rate = lyapunov_rate(drawn.state, drawn.wanted, drawn.action)
        for index, form in enumerate(FORMS):
            sure = bound.certified(*drawn.bounded, drawn.gain, form)
            assert (rate[sure] < 0).all()
            held[index] += sure.sum()
    assert (held > 1000).all()
    assert (held < 0.9 * MOMENTS).all()


@settings(max_examples=3)
@given(st.integers(0, 2**31))
def test_with_known_help_what_equation_14_certifies_is_certified_too(seed):
    for drawn in all_moments(seed):
        first, second = (bound.certified(*drawn.bounded, drawn.gain, form) for form in FORMS)
        assert (first <= second).all()
        deltas = [bound.delta(*drawn.bounded, drawn.gain, form) for form in FORMS]
        assert (deltas[0] >= deltas[1] - 1e-12 * abs(deltas[0])).all()


@settings(max_examples=3)
@given(st.integers(0, 2**31))
def test_with_known_help_no_smaller_delta_would_hold(seed):
    for drawn in all_moments(seed):
        error = drawn.wanted - drawn.state
        away = -drawn.sigma_h[:, None] * error / np.linalg.norm(error, axis=1, keepdims=True)
        rate = lyapunov_rate(drawn.state, drawn.wanted, replace(drawn, phi=away).action)
        length = np.linalg.norm(error, axis=1)
        excess = drawn.sure * length - bound.delta(*drawn.bounded, drawn.gain, known_help)
        scale = length * (drawn.alpha * np.linalg.norm(drawn.help, axis=1) + drawn.sigma_h)
        assert (abs(rate + drawn.alpha * drawn.gain * length * excess) <= 1e-9 * scale).all()


def against(drawn, seed):
    """A decoder for each moment, linear in two inputs, a metric, and what the person does: the worst or any.

    Returns:
        Its enclosure, the metric (N, n, n), and phi (N, n).
    """
    rng = np.random.default_rng(seed)
    count, joints = drawn.state.shape
    offset = 0.5 * drawn.sigma_h[:, None] * rng.normal(size=(count, joints))
    columns = drawn.sigma_h[:, None, None] * rng.normal(size=(count, 2, joints))
    root = rng.normal(size=(count, joints, joints)) * rng.uniform(0.01, 1.0, (count, 1, joints))
    metric = root @ root.mT + 1e-3 * np.eye(joints)
    metric[rng.random(count) < 0.3] = np.eye(joints)
    w = np.matvec(metric, drawn.wanted - drawn.state)
    worst = -np.sign(np.matvec(columns, w))
    z = np.where(rng.random((count, 1)) < 0.5, worst, rng.uniform(-1, 1, (count, 2)))
    return linear_enclosure(columns, offset), metric, offset + np.vecmat(z, columns)


def test_with_the_decoder_known_it_certifies_only_what_comes_nearer_in_any_metric():
    held = refused = 0
    for index, drawn in enumerate(all_moments(5)):
        decoder, metric, phi = against(drawn, index)
        w = np.matvec(metric, drawn.wanted - drawn.state)
        sure = bound.certified_along(
            decoder.furthest(-w), w, drawn.state, drawn.belief, drawn.goals, drawn.alpha, drawn.gain
        )
        # dV/dt of V = e^T M e / 2.
        rate = -(w * replace(drawn, phi=phi).action).sum(axis=-1)
        assert (rate[sure] < 0).all()
        held += sure.sum()
        refused += np.count_nonzero(~sure)
        # In joint space it certifies all that is certified with sigma_h, and more.
        flat = (metric == np.eye(metric.shape[-1])).all(axis=(1, 2))
        ball = bound.certified(decoder.largest(), *drawn.bounded[1:], drawn.gain, known_help)
        assert (ball[flat] <= sure[flat]).all()
    assert min(held, refused) > 10_000


def test_with_the_decoder_known_a_moment_worked_by_hand():
    """The goal 2 rad ahead, b = 1, alpha = 0.5: help does 2; w = e = (2, 0), so that it brings 4."""
    goals, belief, state = np.array([[2.0, 0.0]]), np.ones(1), np.zeros(2)
    w = np.array([2.0, 0.0])
    # An input can do 1.9 against it: 3.8 of 4. At 2.1 it holds no more, and to the side it may do anything.
    for against_it, sure in ((1.9, True), (2.1, False)):
        decoder = linear_enclosure(np.array([[against_it, 0.0], [0.0, 50.0]]), np.zeros(2))
        assert bound.certified_along(decoder.furthest(-w), w, state, belief, goals, 0.5) == sure
        assert not bound.certified(decoder.largest(), state, belief, goals, 0, 0.5, others=known_help)


@pytest.mark.parametrize("number", [np.nan, np.inf])
def test_with_the_decoder_known_what_is_no_number_certifies_nothing(number):
    goals, belief, w = np.array([[2.0, 0.0]]), np.ones(1), np.array([2.0, 0.0])
    assert not bound.certified_along(number, w, np.zeros(2), belief, goals, 0.5)
    assert not bound.certified_along(0.0, w, np.full(2, np.nan), belief, goals, 0.5)
    assert not bound.certified_along(-1.0, w, np.zeros(2), belief, goals, 0.0)
    with pytest.raises(UserError):
        bound.certified_along(0.0, w, np.zeros(2), belief, goals, 1.1)


def test_a_moment_worked_by_hand():
    """The goal 2 rad ahead, another 1 rad to the side; b = 0.8, alpha = 0.5, sigma_h = 0.4 rad/s."""
    goals, belief, state = np.array([[2.0, 0.0], [0.0, 1.0]]), np.array([0.8, 0.2]), np.zeros(2)
    moment = (0.4, state, belief, goals, 0, 0.5)
    # 0.4 + 0.2 x 1, and 0.8 x 2 is more; the other goal is square to the error, so that help towards it does
    # no harm.
    assert bound.delta(*moment) == pytest.approx(0.6)
    assert bound.delta(*moment, others=known_help) == pytest.approx(0.4)
    assert bound.certified(*moment)
    # alpha = 0.2 and k = 2: (0.8 / 0.4) x 0.4 + 0.2 = 1.0.
    assert bound.delta(0.4, state, belief, goals, 0, 0.2, 2.0) == pytest.approx(1.0)
    # The other goal: 0.4 + 0.8 x 2 against 0.2 x 1.
    assert not bound.certified(0.4, state, belief, goals, 1, 0.5)
    # e = (2, 0), a = 0.5 (-0.4, 0) + 0.5 (1.6, 0.2).
    action = blend(np.array([-0.4, 0.0]), assistive_action(state, belief, goals), 0.5)
    assert lyapunov_rate(state, goals[0], action) == pytest.approx(-2 * 0.6)


@pytest.mark.parametrize("form", FORMS)
def test_no_help_certifies_nothing(form):
    goals, belief = np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([1.0, 0.0])
    for sigma_h in (0.0, 0.3):
        moment = (sigma_h, np.zeros(2), belief, goals, 0, 0.0)
        assert bound.delta(*moment, others=form) == np.inf
        assert not bound.certified(*moment, others=form)


@pytest.mark.parametrize("form", FORMS)
def test_at_the_goal_there_is_nothing_to_certify(form):
    goals, belief = np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([0.9, 0.1])
    assert not bound.certified(0.1, goals[0], belief, goals, 0, 0.5, others=form)


@pytest.mark.parametrize("form", FORMS)
def test_with_one_goal_only_the_person_disturbs(form):
    goals = np.array([[1.0, 0.0]])
    assert bound.delta(0.4, np.zeros(2), np.ones(1), goals, 0, 0.5, others=form) == pytest.approx(0.4)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("wrong", ["state", "belief", "sigma_h"])
def test_what_is_no_number_certifies_nothing(form, wrong):
    moment = {
        "sigma_h": 0.01,
        "state": np.zeros(2),
        "belief": np.array([0.9, 0.1]),
        "goals": np.array([[1.0, 0.0], [0.0, 1.0]]),
        "goal": 0,
        "alpha": 0.5,
    }
    assert bound.certified(**moment, others=form)
    moment[wrong] = np.nan * np.asarray(moment[wrong])
    assert not bound.certified(**moment, others=form)


@pytest.mark.parametrize("form", FORMS)
def test_many_at_once_are_as_each_alone(form, rng):
    goals = rng.normal(size=(4, 5))
    state, belief = rng.normal(size=(3, 6, 5)), rng.dirichlet(np.ones(4), size=(3, 6))
    sigma_h, goal = rng.uniform(size=(3, 1)), rng.integers(0, 4, (3, 1))
    delta = bound.delta(sigma_h, state, belief, goals, goal, 0.5, others=form)
    sure = bound.certified(sigma_h, state, belief, goals, goal, 0.5, others=form)
    assert delta.shape == sure.shape == (3, 6)
    for drive, at in np.ndindex(3, 6):
        alone = (sigma_h[drive, 0], state[drive, at], belief[drive, at], goals, int(goal[drive, 0]), 0.5)
        assert bound.delta(*alone, others=form) == pytest.approx(delta[drive, at])
        assert bound.certified(*alone, others=form) == sure[drive, at]


@pytest.mark.parametrize(
    "wrong",
    [
        {"alpha": 1.1},
        {"alpha": np.nan},
        {"sigma_h": -0.1},
        {"gain_per_s": 0.0},
        {"goal": 2},
        {"goal": -1},
        {"goal": 0.5},
    ],
)
def test_numbers_out_of_range_are_refused(wrong):
    moment = {
        "sigma_h": 0.1,
        "state": np.zeros(2),
        "belief": np.array([0.9, 0.1]),
        "goals": np.eye(2),
        "goal": 0,
        "alpha": 0.5,
    }
    with pytest.raises(UserError):
        bound.certified(**{**moment, **wrong})
