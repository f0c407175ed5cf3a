"""New directions are kept only where held-out answers are met better than before."""

import numpy as np
import pytest

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import identity
from latentarm.alignment.judgement import judge
from latentarm.alignment.queries import FEWEST, order_of_questions
from latentarm.runs.questions import AlignmentProblem


@pytest.fixture(scope="module")
def scene(circles, linear_model, slides):
    """Half a second along circles in a plane, and the decoder that moves in it."""
    start = np.concatenate([one.state[:-10:3] for one in circles.episodes])
    end = np.concatenate([one.state[10::3] for one in circles.episodes])
    return AlignmentProblem(linear_model.decoder(), slides.chain, Motions(start, end, 0.5))


@pytest.fixture
def asked(scene):
    """So many motions, and the inputs that ask for them with the directions of now."""

    def asked(count):
        motions = scene.candidates[np.array(order_of_questions(scene.chain, scene.candidates, count))]
        columns = scene.decoder.decode(np.eye(2), motions.context[:1])
        rest = scene.decoder.decode(np.zeros((1, 2)), motions.context[:1])
        return motions, (motions.action - rest) @ np.linalg.pinv(columns - rest)

    return asked


def judged(scene, motions, u, present=identity, learn=None):
    decoder, chain = scene.decoder, scene.chain
    usual = lambda some: scene.learn(some).with_arm(decoder, chain)  # noqa: E731
    answers = Answers(motions, np.clip(u, -1, 1))
    return judge(answers, learn or usual, present, decoder, chain, scene.candidates)


TURNED = np.array([[0.0, -1.0], [1.0, 0.0]])
FRAMES = {
    "turned": TURNED,
    "opposite": -np.eye(2),
    "mirrored": np.diag([1.0, -1.0]),
    "swapped": np.array([[0.0, 1.0], [1.0, 0.0]]),
}


@pytest.mark.parametrize("count", [FEWEST, pytest.param(10, marks=pytest.mark.slow)])
@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_who_means_other_directions_and_is_a_little_unsteady_gets_them(scene, asked, frame, count):
    motions, u = asked(count)
    noise = 1 + 0.1 * np.random.default_rng(count).standard_normal(u.shape)
    found = judged(scene, motions, u @ frame * noise)
    assert found.refusal is None
    assert found.learned < 0.2 < found.present


def test_who_means_the_directions_of_now_keeps_them(scene, asked):
    motions, u = asked(FEWEST)
    noise = 1 + 0.1 * np.random.default_rng(0).standard_normal(u.shape)
    assert judged(scene, motions, u * noise).refusal == "answers_agree"
    turned = lambda pushes, context: pushes @ TURNED.T  # noqa: E731
    assert judged(scene, motions, u @ TURNED * noise, turned).refusal == "answers_agree"


@pytest.mark.parametrize("push", [(0.0, -0.5), (0.0, -1.0), (0.7, 0.7)])
def test_ten_times_the_same_answer_teaches_nothing(scene, asked, push):
    motions, _ = asked(10)
    assert judged(scene, motions, np.tile(push, (10, 1))).refusal == "answers_alike"
    unsteady = 0.05 * np.random.default_rng(1).standard_normal((10, 2))
    assert judged(scene, motions, np.tile(push, (10, 1)) + unsteady).refusal == "answers_alike"


def test_answers_to_other_motions_than_those_shown_teach_nothing(scene, asked):
    motions, u = asked(8)
    rng = np.random.default_rng(0)
    assert judged(scene, motions, np.roll(u @ FRAMES["mirrored"], 3, axis=0)).refusal == "answers_unclear"
    assert judged(scene, motions, rng.uniform(-1, 1, u.shape)).refusal == "answers_unclear"


def test_too_few_answers_are_not_judged(scene, asked):
    motions, u = asked(FEWEST - 1)
    found = judged(scene, motions, u @ FRAMES["mirrored"])
    assert (found.refusal, found.learned) == ("answers_few", None)


def test_a_direction_that_would_hardly_move_the_arm_is_refused(scene, asked):
    """All motions lie near one line, so that the other direction hardly counts as an error."""
    motions, _ = asked(10)
    z = np.stack([np.cos(angle := np.linspace(-0.26, 0.26, 10)), np.sin(angle)], axis=-1)
    z *= np.where(np.arange(10) % 2, -1, 1)[:, None]
    step = motions.duration_s * scene.decoder.decode(z, motions.context)
    there = Motions(motions.start, motions.start + step, motions.duration_s)
    u = z @ (-np.eye(2)) * [1.0, 2.0]
    lame = lambda some: lambda pushes, context: pushes * [-1.0, 0.0]  # noqa: E731
    whole = lambda some: lambda pushes, context: pushes * [-1.0, -0.5]  # noqa: E731
    assert judged(scene, there, u, learn=lame).refusal == "answers_weak"
    assert judged(scene, there, u, learn=whole).refusal is None
