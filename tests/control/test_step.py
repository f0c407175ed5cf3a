"""Algorithm 1 as a person meets it."""

import itertools

import numpy as np
import pytest

from latentarm.assistance.blending import FixedAlpha
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.goal_blending import GoalBlending
from latentarm.control.step import Step
from latentarm.core.errors import UserError
from latentarm.core.types import Goal, Input, Stop
from latentarm.safety.config import SafetyConfig
from stepping import stepped

now_s = itertools.count(step=0.01).__next__
"""The loop's clock, one period later each time."""

NEUTRAL = Input(np.zeros(2))
PUSH = Input(np.array([1.0, 0.0]))
MATRIX = np.stack([np.full(7, 0.1), np.linspace(-0.1, 0.1, 7)])


@pytest.fixture
def step(arm, scripted):
    made = Step(arm, scripted(MATRIX, modes=("one", "two", "three")), SafetyConfig())
    made.reset(arm.home)
    return made


def engaged(step, state):
    stepped(step, NEUTRAL, 0.0, state, now_s())
    assert step.enable() is None
    return step


def run(step, given, state, ticks, age=0.0):
    for _ in range(ticks):
        record = stepped(step, given, age, state, now_s())
        state = state + record.command.velocity * step.dt_s
    return record, state


def goals_of(arm, *shifts):
    return tuple(
        Goal(f"goal {i}", arm.home + shift, arm.chain.forward(arm.home + shift))
        for i, shift in enumerate(shifts)
    )


def blended(goals, alpha):
    """Help of equation 10."""
    return GoalBlending(np.stack([goal.configuration for goal in goals]), FixedAlpha(alpha))


class TestEngagement:
    def test_starts_disengaged_and_says_so(self, step, arm):
        record, _ = run(step, PUSH, arm.home, 20)
        assert not record.command.velocity.any()
        assert record.command.stop is not None

    def test_enable_needs_a_neutral_stick_first(self, step, arm):
        assert step.enable() is not None
        stepped(step, PUSH, 0.0, arm.home, now_s())
        assert "stick" in step.enable().reason
        stepped(step, NEUTRAL, 0.0, arm.home, now_s())
        assert step.enable() is None
        record, _ = run(step, PUSH, arm.home, 5)
        assert record.command.velocity.any()
        assert record.command.stop is None

    @pytest.mark.parametrize("how", ["operator", "stale", "nan", "raises", "lost joints"])
    def test_after_any_stop_neutral_then_enable(self, step, arm, how):
        engaged(step, arm.home)
        record, state = run(step, PUSH, arm.home, 60)
        moving = np.abs(record.command.velocity)
        assert moving.max() > 0.05
        if how == "operator":
            step.stop("The operator pressed Stop.")
            record = stepped(step, PUSH, 0.0, state, now_s())
        elif how == "stale":
            record = stepped(step, PUSH, 1.0, state, now_s())
        elif how == "nan":
            record = stepped(step, Input(np.array([np.nan, 0.0])), 0.0, state, now_s())
        elif how == "raises":
            step._controller.answer = lambda context: 1 / 0
            record = stepped(step, PUSH, 0.0, state, now_s())
            step._controller.answer = None
        else:
            record = stepped(step, PUSH, 0.0, np.full(7, np.nan), now_s())
        assert record.command.stop is not None
        # Ramped, never a step, and then at rest for good, whatever the stick does.
        assert (np.abs(record.command.velocity) > 0.0).any()
        record, state = run(step, PUSH, state, 30)
        assert not record.command.velocity.any()
        assert step.enable() is not None
        record, state = run(step, NEUTRAL, state, 1)
        record, state = run(step, PUSH, state, 30)
        assert not record.command.velocity.any()
        # The stick was pushed again in between: neutral must be the newest.
        assert step.enable() is not None
        run(step, NEUTRAL, state, 1)
        assert step.enable() is None
        record, _ = run(step, PUSH, state, 30)
        assert record.command.velocity.any()

    def test_goes_on_from_where_the_arm_was_moved_to_without_a_jump(self, step, arm):
        engaged(step, arm.home)
        _, state = run(step, PUSH, arm.home, 60)
        step.stop("Moved by hand.")
        _, state = run(step, NEUTRAL, state, 30)
        elsewhere = state
        for _ in range(30):
            elsewhere = elsewhere + 0.01
            run(step, NEUTRAL, elsewhere, 1)
        engaged(step, elsewhere)
        record = stepped(step, PUSH, 0.0, elsewhere, now_s())
        np.testing.assert_array_equal(record.state, elsewhere)
        assert np.abs(record.command.velocity).max() <= step._stack.bounds.acceleration.max() * 0.01 + 1e-12

    def test_the_first_reason_is_kept(self, step, arm):
        engaged(step, arm.home)
        step.stop("first")
        step.stop("second")
        assert stepped(step, PUSH, 1.0, arm.home, now_s()).command.stop.reason == "first"

    def test_an_arm_that_halted_by_itself_is_not_told_to_move_again(self, step, arm):
        engaged(step, arm.home)
        _, state = run(step, PUSH, arm.home, 60)
        step.halted(Stop("too late"))
        record = stepped(step, PUSH, 0.0, state, now_s())
        assert not record.command.velocity.any()
        assert record.command.stop.reason == "too late"

    def test_reset_begins_anew(self, step, arm):
        engaged(step, arm.home)
        run(step, Input(PUSH.u, switch_mode=True), arm.home, 50)
        step.reset(arm.home)
        assert step.mode == 0
        assert step.stopped is not None
        assert step.at_rest
        with pytest.raises(UserError):
            step.reset(np.zeros(3))


class TestZeroInput:
    def test_zero_wants_no_motion_whatever_the_decoder_makes_of_it(self, step, arm):
        step._controller.answer = lambda context: np.full(7, 0.3)
        engaged(step, arm.home)
        record, state = run(step, NEUTRAL, arm.home, 50)
        np.testing.assert_array_equal(state, arm.home)
        record, _ = run(step, Input(np.array([0.01, -0.01])), arm.home, 50)
        assert not record.command.velocity.any()

    @pytest.mark.parametrize("push", [(1, 0), (0, 1), (0, -1), (-0.6, 0.6), (0.015, -0.015), (0, 0.021)])
    def test_a_push_along_any_axis_longer_than_the_dead_zone_moves_the_arm(self, step, arm, push):
        engaged(step, arm.home)
        record, _ = run(step, Input(np.array(push, dtype=float)), arm.home, 5)
        assert record.command.velocity.any()

    def test_letting_go_ramps_down_within_half_a_second(self, step, arm):
        engaged(step, arm.home)
        record, state = run(step, PUSH, arm.home, 100)
        first, state = run(step, NEUTRAL, state, 1)
        assert 0.0 < np.abs(first.command.velocity).max() < np.abs(record.command.velocity).max()
        record, _ = run(step, NEUTRAL, state, 50)
        assert not record.command.velocity.any()
        assert record.command.stop is None

    def test_help_ends_with_the_input(self, arm, scripted):
        goals = goals_of(arm, 0.5, -0.5)
        step = Step(arm, scripted(MATRIX), SafetyConfig(), goals=goals, assistance=blended(goals, 1.0))
        engaged(step, arm.home)
        record, state = run(step, PUSH, arm.home, 20)
        assert record.alpha == 1.0
        record, state = run(step, NEUTRAL, state, 60)
        assert record.alpha == 0.0
        assert not record.command.velocity.any()


class TestAlgorithm:
    def test_decodes_blends_and_records_what_it_did(self, arm, scripted):
        goals = goals_of(arm, 0.5, np.array([0.5, 0, 0, 0, 0, 0, 0]))
        belief = BoltzmannBelief(
            [goal.configuration for goal in goals], prior=np.array([0.25, 0.75]), period_s=0.01
        )
        step = Step(
            arm, scripted(MATRIX), SafetyConfig(), goals=goals, belief=belief, assistance=blended(goals, 0.4)
        )
        engaged(step, arm.home)
        time_s = now_s()
        record = stepped(step, PUSH, 0.0, arm.home, time_s)
        np.testing.assert_allclose(record.action_human, MATRIX[0])
        expected = 0.25 * (goals[0].configuration - arm.home) + 0.75 * (goals[1].configuration - arm.home)
        np.testing.assert_allclose(record.action_assist, expected)
        assert record.alpha == 0.4
        np.testing.assert_allclose(record.belief, [0.25, 0.75])
        np.testing.assert_array_equal(record.latent, PUSH.u)
        assert record.time_s == time_s
        # Line 10: the belief of the next step has seen this input.
        assert not np.allclose(step.belief, [0.25, 0.75])
        np.testing.assert_allclose(step.belief.sum(), 1.0)

    def test_an_uneventful_command_is_the_blend(self, arm, scripted):
        goals = goals_of(arm, 0.1)
        step = Step(arm, scripted(MATRIX), SafetyConfig(), goals=goals, assistance=blended(goals, 0.5))
        engaged(step, arm.home)
        record, _ = run(step, PUSH, arm.home, 100)
        wanted = 0.5 * MATRIX[0] + 0.5 * (goals[0].configuration - record.state)
        np.testing.assert_allclose(record.command.velocity, wanted, rtol=1e-6)
        assert record.command.limited_by == ()

    def test_the_belief_moves_at_its_own_rate(self, arm, scripted):
        goals = goals_of(arm, 0.5, -0.5)
        belief = BoltzmannBelief([goal.configuration for goal in goals], period_s=0.05)
        step = Step(arm, scripted(MATRIX), SafetyConfig(), goals=goals, belief=belief)
        engaged(step, arm.home)
        changed, q = [], arm.home
        for _ in range(20):
            before = step.belief
            q = q + 0.01 * stepped(step, PUSH, 0.0, q, now_s()).command.velocity
            changed.append(not np.array_equal(before, step.belief))
        assert sum(changed) == 4

    def test_a_mode_switch_is_one_press_however_long(self, step, arm):
        engaged(step, arm.home)
        press = Input(np.zeros(2), switch_mode=True)
        for _ in range(5):
            stepped(step, press, 0.0, arm.home, now_s())
        assert step.mode == 1
        stepped(step, NEUTRAL, 0.0, arm.home, now_s())
        stepped(step, press, 0.0, arm.home, now_s())
        assert step.mode == 2
        stepped(step, NEUTRAL, 0.0, arm.home, now_s())
        stepped(step, press, 0.0, arm.home, now_s())
        assert step.mode == 0

    def test_the_same_ticks_give_the_same_records(self, arm, scripted):
        def record_all():
            step = engaged(Step(arm, scripted(MATRIX), SafetyConfig()), arm.home)
            state, found = arm.home, []
            for tick in range(50):
                record = stepped(step, Input(np.array([np.sin(tick), 1.0])), 0.0, state, tick * 0.01)
                state = state + record.command.velocity * 0.01
                found.append(record.command.velocity)
            return np.array(found)

        np.testing.assert_array_equal(record_all(), record_all())

    def test_assistance_without_goals_is_refused(self, arm, scripted):
        with pytest.raises(UserError, match="goal"):
            Step(arm, scripted(MATRIX), SafetyConfig(), assistance=blended(goals_of(arm, 0.1), 0.5))
        belief = BoltzmannBelief(np.zeros((2, 7)))
        with pytest.raises(UserError, match="2 goals"):
            Step(arm, scripted(MATRIX), SafetyConfig(), goals=goals_of(arm, 0.1), belief=belief)

    @pytest.mark.parametrize(
        "answer", [np.full(7, np.nan), np.full(7, np.inf), np.zeros(6), np.zeros((1, 7)), "x"]
    )
    def test_a_controller_that_gives_no_velocity_stops_the_arm(self, step, arm, answer):
        engaged(step, arm.home)
        step._controller.answer = lambda context: answer
        record = stepped(step, PUSH, 0.0, arm.home, now_s())
        assert "controller" in record.command.stop.reason


def test_a_mode_can_be_chosen_and_none_that_is_not_there(arm, scripted):
    step = Step(arm, scripted(np.zeros((2, 7)), ("one", "two", "three")), SafetyConfig())
    step.choose_mode(2)
    assert stepped(step, Input(np.zeros(2)), 0.0, arm.home, now_s()).mode == 2
    for mode in (-1, 3):
        with pytest.raises(UserError, match="modes 0 to 2"):
            step.choose_mode(mode)


def test_a_step_says_what_a_second_person_left_of_the_speed(arm, scripted):
    step = Step(arm, scripted(MATRIX), SafetyConfig())
    assert stepped(step, Input(np.zeros(2), pace=0.0), 0.0, arm.home, now_s()).pace == 0.0
    assert step.enable() is None
    slow = stepped(step, Input(np.array([1.0, 0.0]), pace=0.4), 0.0, arm.home, now_s())
    assert slow.pace == 0.4
    assert slow.command.stop is None
    # Nothing is known of an input that cannot be used.
    assert stepped(step, Input(np.array([1.0, 0.0]), pace=2.0), 0.0, arm.home, now_s()).pace == 1.0
