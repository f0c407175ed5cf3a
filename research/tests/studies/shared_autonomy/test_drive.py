from dataclasses import replace

import numpy as np
import pytest

from latentarm.assistance.blending import FixedAlpha
from latentarm_research.studies.shared_autonomy import drive as drives
from latentarm_research.studies.shared_autonomy.drive import HELP, NO_HELP, RULE, STEP_S, drive, steps_of
from latentarm_research.studies.shared_autonomy.measures import (
    EVERY,
    certify,
    measure,
    state_error,
    tool_metric,
    true_belief,
)
from latentarm_research.studies.shared_autonomy.preset import changing, learner, of_fixed_expertise

PERFECT = replace(of_fixed_expertise(1.0), beta=np.inf)


def driven(scene, decoder, person=PERFECT, help_by=HELP, drives=6, seed=0, start=None, spread=0.05):
    rng = np.random.default_rng(seed)
    begin = scene.goals.mean(axis=0) if start is None else start
    starts = begin + rng.normal(0.0, spread, (drives, len(begin)))
    target = np.arange(drives) % len(scene.goals)
    chances = np.random.default_rng(seed + 1).random((drives, steps_of(person)))
    return drive(decoder, scene, [person] * drives, help_by, starts, target, chances)


@pytest.mark.parametrize("help_by", [NO_HELP, HELP])
def test_a_perfect_person_with_a_perfect_decoder_goes_to_the_goal(scene, straight, help_by):
    drives = driven(scene, straight, help_by=help_by, spread=0.0)
    figures = measure(drives, scene, straight)
    assert (figures["final_state_error"] < 0.05).all()
    assert (figures["arrival_rate"] == 1.0).all()
    # From half the distance to a fifth of it, 1 rad apart, at 0.3 rad/s: a second without help.
    fastest = 0.3 * np.linalg.norm(scene.goals[0] - scene.goals[1]) / 0.3
    assert (figures["time_s"] <= 2.0 * fastest).all()
    assert (true_belief(drives)[:, -1] > 0.9).all()


def test_help_towards_the_believed_goal_brings_people_there_sooner(scene, straight):
    person = of_fixed_expertise(30.0)
    alone = measure(driven(scene, straight, person, NO_HELP, drives=40), scene, straight)
    helped = measure(driven(scene, straight, person, HELP, drives=40), scene, straight)
    assert helped["final_state_error"].mean() < alone["final_state_error"].mean()


def test_without_help_belief_does_not_move_the_arm(scene, straight):
    other = replace(scene, belief=RULE(scene.goals, beta=10.0, period_s=STEP_S))
    person = of_fixed_expertise(75.0)
    one, two = (driven(where, straight, person, NO_HELP) for where in (scene, other))
    np.testing.assert_array_equal(one.state, two.state)
    np.testing.assert_array_equal(one.moments.action, two.moments.action)
    assert (one.belief != two.belief).any()
    assert (driven(other, straight, person, HELP).state != one.state).any()


def test_whoever_lets_go_stands_still_and_learns_the_robot_nothing(scene, wild, monkeypatch):
    monkeypatch.setattr(drives, "choose", lambda cost, at_rest, beta, chance: np.zeros(len(cost)))
    still = driven(scene, wild, of_fixed_expertise(0.0), FixedAlpha(0.5))
    assert (still.moments.action == 0.0).all()
    assert (still.moments.alpha == 0.0).all()
    np.testing.assert_array_equal(still.state, still.moments.state[:, 0])
    np.testing.assert_array_equal(still.belief, np.full_like(still.belief, 0.5))


def test_the_arm_moves_as_it_was_told(scene, wild):
    done = driven(scene, wild, of_fixed_expertise(10.0))
    after = np.concatenate([done.moments.state[:, 1:], done.state[:, None]], axis=1)
    np.testing.assert_allclose(after, done.moments.state + STEP_S * done.moments.action, rtol=1e-12)
    fastest = np.linalg.norm(done.moments.action, axis=-1)
    farthest = np.linalg.norm(scene.goals[:, None, None] - done.moments.state, axis=-1).max(axis=0)
    context = np.concatenate([done.moments.state, done.moments.belief], axis=-1)
    assert (fastest <= np.maximum(wild.enclose(context, 4).largest(), farthest) + 1e-12).all()


def test_beliefs_stay_probabilities(scene, wild):
    done = driven(scene, wild, learner("quick", 100.0))
    np.testing.assert_allclose(done.moments.belief.sum(axis=-1), 1.0)
    assert done.moments.belief.min() >= scene.belief.floor - 1e-12
    assert (true_belief(done) <= 1.0).all()


def test_where_the_bound_certifies_a_step_the_arm_comes_nearer(scene, wild):
    """The enclosure bounds what the person can do, so the certificates hold for what the person did."""
    certified = 0
    for seed in range(2):
        done = driven(scene, wild, of_fixed_expertise(3.0), FixedAlpha(0.9), seed=seed)
        wanted, state, action = (
            part[:, ::EVERY] for part in (done.moments.wanted, done.moments.state, done.moments.action)
        )
        error = scene.goals[wanted] - state
        found = certify(done, scene, wild)
        tools = np.matvec(tool_metric(scene)[wanted], error)
        for name, sure in found.items():
            # dV/dt, equation 12, in the metric of the tools for the last.
            rate = -((tools if name.endswith("tools") else error) * action).sum(axis=-1)
            assert (rate[sure] < 0.0).all()
            certified += np.count_nonzero(sure)
        assert (found["certified_share_known_help"] <= found["certified_share_decoder"]).all()
    assert certified > 50


def test_without_help_nothing_is_certified(scene, wild):
    found = certify(driven(scene, wild, help_by=NO_HELP), scene, wild)
    assert not any(share.any() for share in found.values())


def test_a_decoder_without_an_enclosure_is_no_decoder_for_this_study(scene, wild):
    class Unknown(type(wild)):
        kind = "unknown"

        def enclose(self, context, fineness=1):
            return None

    with pytest.raises(TypeError, match="unknown decoder"):
        certify(driven(scene, wild, drives=1), scene, Unknown(wild.joints, wild.goals))


def test_a_change_of_mind_begins_at_the_other_goal(scene, straight):
    done = driven(scene, straight, replace(changing(3.0), beta=np.inf), spread=0.0)
    before = round(3.0 / STEP_S)
    assert (done.moments.wanted[:, :before] != done.target[:, None]).all()
    assert (done.moments.wanted[:, before:] == done.target[:, None]).all()
    error = state_error(done, scene)
    assert (error[:, before] > 0.6).all()  # on the way to the other goal, 1 away
    assert (error[:, -1] < 0.1).all()
    assert (true_belief(done)[:, before] < 0.5).all()


def test_the_first_drives_are_the_same_however_many_there_are(scene, wild):
    person = of_fixed_expertise(75.0)
    rng = np.random.default_rng(3)
    start = scene.goals.mean(axis=0) + rng.normal(0.0, 0.05, (8, scene.goals.shape[1]))
    target, chances = np.arange(8) % 2, rng.random((8, steps_of(person)))
    many = drive(wild, scene, [person] * 8, HELP, start, target, chances)
    few = drive(wild, scene, [person] * 3, HELP, start[:3], target[:3], chances[:3])
    np.testing.assert_allclose(few.state, many.state[:3], atol=1e-9)


def test_people_of_several_kinds_drive_in_one_go_as_each_would_alone(scene, wild):
    people = [of_fixed_expertise(75.0), of_fixed_expertise(3.0), learner("fast", 100.0)]
    rng = np.random.default_rng(4)
    start = scene.goals.mean(axis=0) + rng.normal(0.0, 0.05, (3, scene.goals.shape[1]))
    target, chances = np.array([0, 1, 1]), rng.random((3, steps_of(people[0])))
    together = drive(wild, scene, people, HELP, start, target, chances)
    for index, person in enumerate(people):
        own = slice(index, index + 1)
        alone = drive(wild, scene, [person], HELP, start[own], target[own], chances[own])
        np.testing.assert_allclose(alone.state, together.state[own], atol=1e-9)
        np.testing.assert_allclose(alone.belief, together.belief[own], atol=1e-9)


def test_learners_grow_more_rational_and_others_do_not():
    assert learner("slow", 10.0).rationality(0.0) == 0.0
    assert learner("slow", 10.0).rationality(6.0) == 60.0
    assert of_fixed_expertise(75.0).rationality(6.0) == 75.0
    assert changing(8.0).drive_s == 2 * changing(8.0).changes_at_s
