"""The robot's part of Algorithm 1: any belief, help at rest, and how far help constrains the arm."""

import dataclasses
import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.belief import Belief
from latentarm.assistance.blending import Arbitration, FixedAlpha
from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.assistance.catalogue import BELIEFS
from latentarm.assistance.goal_blending import GoalBlending
from latentarm.control.shared_autonomy import Choices
from latentarm.control.step import Step
from latentarm.core.errors import UserError
from latentarm.core.types import Context, Goal, Input
from latentarm.recordings.dataset_export import demonstrations_of
from latentarm.recordings.journal_reader import read_journal
from latentarm.recordings.journal_writer import EpisodeHeader, Recorder
from latentarm.safety.config import SafetyConfig
from latentarm_research.assistance.bound import delta
from latentarm_research.assistance.cost_to_go import HindsightBelief
from latentarm_research.assistance.published_help import HindsightOptimisation
from stepping import stepped

now_s = itertools.count(step=0.01).__next__
"""The loop's clock, one period later each time."""

NEUTRAL = Input(np.zeros(2))
PUSH = Input(np.array([1.0, 0.0]))
MATRIX = np.stack([np.full(7, 0.1), np.linspace(-0.2, 0.2, 7)])


class HelpsAtRest(Arbitration):
    """Half of the motion is the robot's, also without an input."""

    acts_at_rest = True

    def alpha(self, u, belief):
        return 0.5


UNPROMPTED = HelpsAtRest()


def goals_of(arm, *shifts):
    return tuple(
        Goal(f"goal {i}", arm.home + shift, arm.chain.forward(arm.home + shift))
        for i, shift in enumerate(shifts)
    )


@pytest.fixture
def make(arm, scripted):
    """An engaged step towards two goals, the second likelier, and its controller."""

    def make(arbitration=None, period_s=0.05, prior=(0.25, 0.75), rule=BoltzmannBelief, **changes):
        goals = goals_of(arm, 0.3, -0.2)
        controller = changes.pop("controller", scripted(MATRIX))
        configurations = np.stack([goal.configuration for goal in goals])
        belief = rule(configurations, period_s=period_s, prior=np.array(prior))
        help_by = None if arbitration is None else GoalBlending(configurations, arbitration)
        step = Step(
            arm, controller, SafetyConfig(), goals=goals, belief=belief, assistance=help_by, **changes
        )
        step.reset(arm.home)
        stepped(step, NEUTRAL, 0.0, arm.home, now_s())
        assert step.enable() is None
        return step

    return make


def run(step, given, state, ticks, age=0.0):
    records = []
    for _ in range(ticks):
        records.append(stepped(step, given, age, state, now_s()))
        state = state + records[-1].command.velocity * step.dt_s
    return records, state


CORNERS = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
SIGMA_H = np.linalg.norm(CORNERS @ MATRIX, axis=1).max()
"""The most that a person commands with `MATRIX`, whose actions are convex in the input, rad/s."""


def radius_by_hand(arm, state, belief, alpha, sigma_h=SIGMA_H):
    """Equation 14 about the likeliest of the two goals."""
    goals = [goal.configuration for goal in goals_of(arm, 0.3, -0.2)]
    likeliest = int(np.argmax(belief))
    sigma_r = np.linalg.norm(goals[1 - likeliest] - state)
    delta = (1 - alpha) / alpha * sigma_h + (1 - belief[likeliest]) * sigma_r
    return delta / belief[likeliest]


class TestAnyBelief:
    @pytest.mark.parametrize("rule", BELIEFS.values(), ids=BELIEFS.keys())
    def test_every_rule_believes_in_the_goal_that_is_steered_to(self, make, arm, rule):
        step = make(FixedAlpha(), rule=rule, prior=(0.5, 0.5))
        records, _ = run(step, PUSH, arm.home, 150)
        assert records[0].belief == pytest.approx([0.5, 0.5])
        assert step.belief[0] > 0.9
        assert step.belief.sum() == pytest.approx(1.0)

    def test_a_belief_that_is_no_number_stops_the_arm(self, make, arm):
        class Broken(Belief):
            def __init__(self, goals, period_s, prior):
                super().__init__(goals, 0.5, period_s, prior, 0.01)

            def log_likelihood(self, state, actions):
                raise ArithmeticError("no idea")

        records, _ = run(make(rule=Broken), PUSH, arm.home, 10)
        assert "no idea" in records[-1].command.stop.reason


class TestAddedHelp:
    """Hindsight optimisation through the one step and its filters."""

    def step(self, arm, scripted):
        goals = goals_of(arm, 0.3, -0.2)
        configurations = np.stack([goal.configuration for goal in goals])
        step = Step(
            arm,
            scripted(MATRIX),
            SafetyConfig(),
            goals=goals,
            belief=HindsightBelief(configurations, arm, prior=np.array([0.01, 0.99])),
            assistance=HindsightOptimisation(configurations, arm),
        )
        step.reset(arm.home)
        stepped(step, NEUTRAL, 0.0, arm.home, now_s())
        assert step.enable() is None
        return step

    def test_it_is_added_to_what_the_person_does(self, arm, scripted):
        record = run(self.step(arm, scripted), Input(np.array([0.2, 0.0])), arm.home, 60)[0][-1]
        assert (record.alpha, record.added) == (0.0, 1.0)
        assert record.action_human == pytest.approx(0.2 * MATRIX[0])
        wanted = record.action_human + record.action_assist
        assert record.command.velocity == pytest.approx(wanted, abs=0.01)
        assert math.isnan(record.bound_rad)

    def test_it_drives_to_the_likeliest_goal_at_rest_and_a_stop_ends_it(self, arm, scripted):
        step = self.step(arm, scripted)
        goal = arm.chain.forward(goals_of(arm, 0.3, -0.2)[1].configuration).position
        away = [np.linalg.norm(arm.chain.forward(arm.home).position - goal)]
        records, state = run(step, NEUTRAL, arm.home, 100)
        away.append(np.linalg.norm(arm.chain.forward(state).position - goal))
        assert away[1] < away[0] - 0.02
        step.stop("enough")
        records, _ = run(step, NEUTRAL, state, 60)
        assert not records[-1].command.velocity.any()
        assert records[-1].added == 0.0

    def test_it_is_recorded_and_exported(self, arm, scripted, tmp_path):
        records, _ = run(self.step(arm, scripted), PUSH, arm.home, 30)
        path = tmp_path / "drive.sqlite"
        recorder = Recorder(path)
        recorder.begin_episode(EpisodeHeader("panda", arm.joint_names, 100.0, goals=goals_of(arm, 0.3, -0.2)))
        for tick, record in enumerate(records):
            recorder.record(dataclasses.replace(record, time_s=0.01 * tick))
        recorder.end_episode()
        recorder.close()
        (episode,) = read_journal(path)
        assert [record.added for record in episode.records] == [1.0] * 30
        (exported,) = demonstrations_of([episode], source="drive.sqlite").episodes
        np.testing.assert_array_equal(exported.extras["assist.added"], np.ones((30, 1)))


class TestHelpAtRest:
    def test_only_where_the_arbitration_acts_at_rest(self, make, arm):
        for arbitration, moves in ((FixedAlpha(0.5), False), (UNPROMPTED, True), (None, False)):
            records, state = run(make(arbitration), NEUTRAL, arm.home, 100)
            assert (not np.array_equal(state, arm.home)) == moves
            assert (records[-1].alpha > 0) == moves
            assert records[-1].action_assist.any() == moves

    def test_the_person_commands_nothing_whatever_the_decoder_makes_of_zero(self, make, arm, scripted):
        class Drifts(scripted):
            def action(self, z, context, mode):
                return super().action(z, context, mode) + 0.3

        step = make(UNPROMPTED, controller=Drifts(MATRIX))
        records, _ = run(step, Input(np.array([0.01, -0.01])), arm.home, 100)
        assert not np.any([record.action_human for record in records])
        assert not np.any([record.latent for record in records])
        # Letting go says nothing about goals.
        np.testing.assert_array_equal(step.belief, [0.25, 0.75])
        towards = 0.25 * 0.3 - 0.75 * 0.2
        np.testing.assert_allclose(records[0].action_assist, np.full(7, towards))
        wanted = 0.5 * towards
        assert np.abs(records[40].command.velocity).max() <= abs(wanted) + 1e-12

    def test_it_maintains_the_goal_when_it_is_reached(self, make, arm):
        goal = arm.home - 0.2
        _, state = run(make(UNPROMPTED, prior=(0.01, 0.99)), NEUTRAL, arm.home, 1500)
        assert np.abs(state - goal).max() < 0.02

    def test_a_stale_input_stops_it_all_the_same(self, make, arm):
        step = make(UNPROMPTED)
        records, state = run(step, NEUTRAL, arm.home, 60)
        assert records[-1].command.velocity.any()
        records, state = run(step, NEUTRAL, state, 40, age=0.2)
        assert records[0].command.stop is not None
        assert records[0].alpha == 0.0
        assert not records[-1].command.velocity.any()
        # Fresh inputs alone do not start it again.
        records, _ = run(step, NEUTRAL, state, 40)
        assert not np.any([record.command.velocity for record in records])

    def test_disengaged_stays_disengaged(self, make, arm):
        step = make(UNPROMPTED)
        step.reset(arm.home)
        records, _ = run(step, NEUTRAL, arm.home, 40)
        assert not np.any([record.command.velocity for record in records])
        assert not np.any([record.alpha for record in records])
        assert step.enable() is None
        _, state = run(step, NEUTRAL, arm.home, 60)
        step.stop("The operator pressed Stop.")
        _, state = run(step, NEUTRAL, state, 40)
        records, _ = run(step, NEUTRAL, state, 40)
        assert not np.any([record.command.velocity for record in records])

    def test_an_arbitration_that_fails_at_rest_stops_the_arm(self, make, arm):
        class Broken(Arbitration):
            acts_at_rest = True

            def alpha(self, u, belief):
                return np.nan

        records, _ = run(make(Broken()), NEUTRAL, arm.home, 1)
        assert "arbitration" in records[0].command.stop.reason


class TestBound:
    @pytest.mark.parametrize("period_s", [0.05, 0.1])
    def test_the_radius_is_that_of_equation_14_at_the_belief_s_period(self, make, arm, period_s):
        records, _ = run(make(FixedAlpha(0.4), period_s), Input(np.array([0.2, -0.1])), arm.home, 50)
        bounds = np.array([record.bound_rad for record in records])
        assert np.isfinite(bounds).all()
        ticks = round(100 * period_s)
        changed = np.flatnonzero(np.diff(bounds)) + 1
        np.testing.assert_array_equal(changed, np.arange(ticks - 1, 50, ticks))
        goals = np.stack([goal.configuration for goal in goals_of(arm, 0.3, -0.2)])
        for tick in (0, *changed):
            record = records[tick]
            assert 0 < record.alpha < 0.4
            expected = radius_by_hand(arm, record.state, record.belief, record.alpha)
            assert bounds[tick] == pytest.approx(expected)
            goal = record.belief.argmax()
            from_bound = delta(SIGMA_H, record.state, record.belief, goals, goal, record.alpha)
            assert bounds[tick] == pytest.approx(float(from_bound) / record.belief[goal])

    def test_however_often_the_belief_changes_fifty_milliseconds_are_enough(self, make, arm):
        records, _ = run(make(FixedAlpha(0.4), period_s=0.02), PUSH, arm.home, 60)
        changed = np.flatnonzero(np.diff([record.bound_rad for record in records])) + 1
        np.testing.assert_array_equal(np.diff(changed), 6)

    def test_every_number_of_goals_and_any_state(self, arm, scripted):
        rng = np.random.default_rng(0)
        for count in (1, 2, 50):
            states = arm.home + rng.uniform(-0.3, 0.3, (count, 7))
            goals = [Goal(str(i), q, arm.chain.forward(q)) for i, q in enumerate(states)]
            prior = rng.dirichlet(np.ones(count))
            belief = BoltzmannBelief(states, prior=prior, floor=0.0)
            step = Step(
                arm,
                scripted(MATRIX),
                SafetyConfig(),
                goals=goals,
                belief=belief,
                assistance=GoalBlending(states, FixedAlpha(0.3)),
            )
            stepped(step, NEUTRAL, 0.0, arm.home, now_s())
            step.enable()
            record = stepped(step, PUSH, 0.0, arm.home, now_s())
            expected = delta(SIGMA_H, arm.home, prior, states, prior.argmax(), 0.3)
            assert record.bound_rad == pytest.approx(float(expected) / prior.max())

    @pytest.mark.parametrize("known", [None, math.nan, math.inf])
    def test_a_controller_that_knows_no_bound_has_none_and_drives(self, make, arm, scripted, known):
        class Unknown(scripted):
            def speed_bound(self, context, mode):
                return known

        step = make(FixedAlpha(0.4), controller=Unknown(MATRIX))
        records, _ = run(step, Input(np.array([0.3, 0.3])), arm.home, 20)
        assert all(math.isnan(record.bound_rad) for record in records)
        assert step.stopped is None

    def test_a_controller_that_decodes_one_input_only_stops_the_arm(self, make, arm, scripted):
        class One(scripted):
            def action(self, z, context, mode):
                return (z @ self.matrix).reshape(-1, 7)[0]

        # The belief is the first to ask for several.
        records, _ = run(make(FixedAlpha(0.4), controller=One(MATRIX)), PUSH, arm.home, 5)
        assert "actions of shape" in records[-1].command.stop.reason

    def test_without_help_there_is_none(self, make, arm, scripted):
        step = make(FixedAlpha(0.4))
        _, state = run(step, PUSH, arm.home, 20)
        records, state = run(step, NEUTRAL, state, 30)
        assert all(math.isnan(record.bound_rad) for record in records)
        step.stop("enough")
        assert math.isnan(stepped(step, PUSH, 0.0, state, now_s()).bound_rad)
        for arbitration in (None, FixedAlpha(0.0)):
            records, _ = run(make(arbitration), PUSH, arm.home, 20)
            assert all(math.isnan(record.bound_rad) for record in records)
        alone = Step(arm, scripted(MATRIX), SafetyConfig())
        alone(NEUTRAL, 0.0, arm.home, now_s())
        alone.enable()
        assert math.isnan(alone(PUSH, 0.0, arm.home, now_s()).bound_rad)

    def test_help_that_begins_anew_has_a_bound_of_its_own(self, make, arm):
        step = make(FixedAlpha(0.4))
        run(step, PUSH, arm.home, 3)
        run(step, NEUTRAL, arm.home, 1)
        (record,), _ = run(step, PUSH, arm.home + 0.02, 1)
        expected = radius_by_hand(arm, arm.home + 0.02, record.belief, record.alpha)
        assert record.bound_rad == pytest.approx(expected)

    def test_help_without_a_belief_has_one_too(self, arm, scripted):
        goals = goals_of(arm, 0.3, -0.2)
        help_by = GoalBlending(np.stack([goal.configuration for goal in goals]), FixedAlpha(0.4))
        step = Step(arm, scripted(MATRIX), SafetyConfig(), goals=goals, assistance=help_by)
        stepped(step, NEUTRAL, 0.0, arm.home, now_s())
        step.enable()
        record = stepped(step, PUSH, 0.0, arm.home, now_s())
        assert record.bound_rad == pytest.approx(radius_by_hand(arm, arm.home, np.array([0.5, 0.5]), 0.4))

    def test_more_help_and_a_surer_belief_make_it_smaller(self, make, arm):
        def bound(alpha, sure):
            return run(make(FixedAlpha(alpha), prior=(1 - sure, sure)), PUSH, arm.home, 1)[0][0].bound_rad

        assert bound(0.2, 0.6) > bound(0.5, 0.6) > bound(0.9, 0.6)
        assert bound(0.5, 0.6) > bound(0.5, 0.8) > bound(0.5, 0.95)

    def test_the_controller_is_asked_once_a_step(self, make, arm, scripted):
        class Counts(scripted):
            calls = 0

            def action(self, z, context, mode):
                self.calls += 1
                return super().action(z, context, mode)

        with_help, without = Counts(MATRIX), Counts(MATRIX)
        push = Input(np.array([0.4, 0.3]))
        run(make(FixedAlpha(0.4), controller=with_help), push, arm.home, 20)
        run(make(None, controller=without), push, arm.home, 20)
        assert without.calls == with_help.calls == 20

    def test_recorded_read_back_and_exported(self, make, arm, tmp_path):
        from latentarm.demonstrations.dataset import read_dataset, write_dataset

        step, path = make(FixedAlpha(0.4)), tmp_path / "drive.sqlite"
        records, state = run(step, PUSH, arm.home, 20)
        records += run(step, NEUTRAL, state, 20)[0]
        recorder = Recorder(path)
        recorder.begin_episode(EpisodeHeader("panda", arm.joint_names, 100.0, goals=goals_of(arm, 0.3, -0.2)))
        for tick, record in enumerate(records):
            recorder.record(dataclasses.replace(record, time_s=0.01 * tick))
        recorder.end_episode()
        recorder.close()
        bounds = np.array([record.bound_rad for record in records])
        (episode,) = read_journal(path)
        np.testing.assert_array_equal([record.bound_rad for record in episode.records], bounds)
        write_dataset(demonstrations_of(read_journal(path), source="drive"), tmp_path / "dataset")
        (found,) = read_dataset(tmp_path / "dataset").episodes
        np.testing.assert_allclose(found.extras["assist.bound"][:20, 0], bounds[:20], rtol=1e-6)
        assert (found.extras["assist.bound"][20:] == -1.0).all()


class TestChoices:
    @given(st.integers(1, 3), st.integers(0, 2**32 - 1))
    def test_whatever_was_asked_before_the_answer_is_the_controller_s(self, scripted, axes, seed):
        rng = np.random.default_rng(seed)
        matrix = rng.normal(size=(axes, 7))
        choices = Choices(scripted(matrix), Context(np.zeros(7), np.zeros(0)), 0)
        u = rng.uniform(-1, 1, axes)
        for inputs in (np.stack([u, -u]), rng.uniform(-1, 1, (4, axes)), u[None]):
            np.testing.assert_allclose(choices(inputs), inputs @ matrix)
            z, action = choices.chosen(u)
            np.testing.assert_array_equal(z, u)
            np.testing.assert_allclose(action, u @ matrix)


class TestGoalsThatMove:
    def test_help_leads_to_where_they_are_now_and_the_belief_stays(self, make, arm):
        step = make(FixedAlpha(0.5))
        (before,), _ = run(step, PUSH, arm.home, 1)
        believed = step.belief
        step.move_goals(np.stack([arm.home + 0.3, arm.home + 0.4]))
        (after,), _ = run(step, PUSH, arm.home, 1)
        assert step.belief.tolist() == believed.tolist()
        assert (before.action_assist < 0.0).all()  # towards the likelier one, at -0.2
        assert after.action_assist == pytest.approx(believed @ [0.3, 0.4])

    def test_the_belief_learns_of_the_goals_where_they_are_now(self, make, arm):
        step = make(prior=(0.5, 0.5))
        step.move_goals(np.stack([arm.home - 0.3, arm.home + 0.2]))  # each to the other's side
        run(step, PUSH, arm.home, 100)  # towards the second
        assert step.belief[1] > 0.9

    @pytest.mark.parametrize("wrong", [np.zeros((1, 7)), np.zeros((2, 6)), np.full((2, 7), np.nan)])
    def test_others_are_refused(self, make, arm, wrong):
        step = make(FixedAlpha(0.5))
        with pytest.raises(UserError, match="2 finite configurations"):
            step.move_goals(wrong)
        (record,), _ = run(step, PUSH, arm.home, 1)
        assert record.command.stop is None
