"""Learning alignments: what two answers and the priors give, and runs that do not meddle with each other."""

import numpy as np
import pytest

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import identity
from latentarm.alignment.error import relative_alignment_error
from latentarm.core.errors import UserError
from latentarm.models.pca.training import PCA
from latentarm_research.alignment.priors import NO_PRIORS, Priors
from latentarm_research.alignment.training import FitConfig, fit_alignments

SMALL = FitConfig(hidden=(8, 8), steps=30, batch_size=8)


def turned(angle, mirror=1.0):
    """A person's axes: the decoder's, turned and perhaps mirrored."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, -sin], [sin, cos]]) @ np.diag([1.0, mirror])


def two_answers(circles, columns, axes):
    """One push along each axis of the stick, from two demonstrated states."""
    start = np.stack([circles.episodes[0].state[5], circles.episodes[1].state[40]])
    end = start + 0.5 * axes.T @ columns
    return Answers(Motions(start, end, 0.5), np.eye(2))


@pytest.fixture(scope="module")
def states(circles):
    return np.concatenate([episode.state for episode in circles.episodes])


def test_a_rotation_and_a_mirror_are_recovered_from_two_answers(
    linear_model, slides, circles, columns, states
):
    axes = turned(2.5, mirror=-1.0)
    answers = two_answers(circles, columns, axes)
    config = FitConfig(steps=1000)
    (alignment,) = fit_alignments(linear_model, slides.chain, [answers], states, config)
    rng = np.random.default_rng(0)
    u, context = rng.uniform(-1, 1, (500, 2)), states[rng.integers(0, len(states), 500)]
    missed = alignment(u, context) - u @ axes.T
    assert np.sqrt(np.square(missed).sum(axis=-1).mean()) < 1e-2
    # As the tool shows it, over all that could be asked.
    motions = Motions(context, context + 0.5 * (u @ axes.T) @ columns, 0.5)
    decoder = linear_model.decoder()
    meant = Answers(motions, u)
    assert relative_alignment_error(alignment, decoder, slides.chain, meant) < 2e-4
    assert relative_alignment_error(identity, decoder, slides.chain, meant) > 0.4


def test_without_priors_two_answers_are_not_enough(linear_model, slides, circles, columns, states):
    axes = turned(0.7)
    answers = two_answers(circles, columns, axes)
    rng = np.random.default_rng(0)
    u, context = rng.uniform(-1, 1, (500, 2)), states[rng.integers(0, len(states), 500)]
    meant = Answers(Motions(context, context + 0.5 * (u @ axes.T) @ columns, 0.5), u)
    errors = {}
    for name, priors in {"none": NO_PRIORS, "all": Priors()}.items():
        config = FitConfig(priors, steps=200)
        (alignment,) = fit_alignments(linear_model, slides.chain, [answers], states, config)
        met = relative_alignment_error(alignment, linear_model.decoder(), slides.chain, answers)
        assert met < 0.01, "the answers themselves are met either way"
        errors[name] = relative_alignment_error(alignment, linear_model.decoder(), slides.chain, meant)
    assert errors["all"] < 0.02 < 0.2 < errors["none"]


@pytest.mark.parametrize("many", [5, 150])
def test_runs_together_are_what_each_is_alone(curved_model, arm, answered, many):
    answers = [answered(4, count=many, seed=seed) for seed in range(3)]
    unlabelled = answered(4, count=40, seed=9).motions.context
    seeds = [7, 3, 11]
    together = fit_alignments(curved_model, arm.chain, answers, unlabelled, SMALL, seeds=seeds)
    rng = np.random.default_rng(0)
    u, context = rng.uniform(-1, 1, (30, 2)), rng.uniform(-0.5, 0.5, (30, 4))
    for run in range(3):
        alone = fit_alignments(
            curved_model, arm.chain, answers[run : run + 1], unlabelled, SMALL, seeds=seeds[run : run + 1]
        )
        np.testing.assert_allclose(alone[0](u, context), together[run](u, context), rtol=0, atol=1e-6)


def test_the_same_seed_gives_the_same_alignment_and_another_another(curved_model, arm, answered):
    answers = [answered(4)] * 2
    unlabelled = answered(4, count=40).motions.context
    first, again = (
        fit_alignments(curved_model, arm.chain, answers, unlabelled, SMALL, seeds=[1, 2]) for _ in range(2)
    )
    u, context = np.ones((1, 2)), np.zeros((1, 4))
    for one, other in zip(first, again, strict=True):
        np.testing.assert_array_equal(one(u, context), other(u, context))
    assert not np.array_equal(first[0](u, context), first[1](u, context))


def test_a_belief_may_belong_to_the_context(swings, arm, answered):
    model = PCA(context="state_belief").fit(swings)
    unlabelled = answered(4, count=40, goals=2).motions.context
    (alignment,) = fit_alignments(model, arm.chain, [answered(4, goals=2)], unlabelled, SMALL)
    assert alignment.context_dim == 6


def test_of_all_weights_those_are_kept_that_miss_the_held_out_answers_least(curved_model, arm, answered):
    """The two answers of these people say little of the other eight: the longer f trains, the more it misses.

    In the end it misses by 2 to 19 percent more than at best. For most people all weights looked at miss
    equally, and rounding decides which are kept.
    """
    seeds = (15, 20, 23)
    people = [answered(4, count=10, seed=seed) for seed in seeds]
    others = [answers[np.arange(2, 10)] for answers in people]

    def errors(answers, held_out, steps=1000):
        config = FitConfig(NO_PRIORS, hidden=(32,), steps=steps, learning_rate=0.03, held_out=held_out)
        unlabelled = people[0].motions.context
        fitted = fit_alignments(curved_model, arm.chain, answers, unlabelled, config, seeds=seeds)
        return np.array(
            [
                relative_alignment_error(alignment, curved_model.decoder(), arm.chain, other)
                for alignment, other in zip(fitted, others, strict=True)
            ]
        )

    trained_on_all, chosen = errors(people, 0.0, steps=300), errors(people, 0.8)
    last = errors([answers[np.arange(2)] for answers in people], 0.0)
    assert (trained_on_all < 0.5 * chosen).all()
    assert (chosen < 0.99 * last).all()


def test_what_cannot_be_learned_is_refused(curved_model, arm, answered):
    answers = answered(4)
    with pytest.raises(UserError, match="not fitted"):
        fit_alignments(PCA(), arm.chain, [answers], answers.motions.context, SMALL)
    config = FitConfig(hidden=(8,), steps=60, learning_rate=1e30)
    with pytest.raises(UserError, match="diverged"):
        fit_alignments(curved_model, arm.chain, [answers], answers.motions.context, config)
