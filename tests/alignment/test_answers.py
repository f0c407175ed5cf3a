import numpy as np
import pytest

from latentarm.alignment.answers import Answers, Motions
from latentarm.alignment.contract import identity
from latentarm.alignment.error import lengths, outcome, relative_alignment_error
from latentarm.alignment.poses import ROTATION_WEIGHT_M, pose_vectors
from latentarm.core.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.rotations import angle_between
from latentarm.robots.planar import planar
from latentarm_research.alignment.transition import TorchPoses

ZERO = np.zeros((3, 4))


def test_what_motions_and_answers_say(answered):
    answers = answered(4, count=6, goals=3)
    assert len(answers) == len(answers.motions) == 6
    assert answers.motions.context.shape == (6, 7)
    np.testing.assert_allclose(answers.motions.action * 0.5, answers.motions.end - answers.motions.start)
    some = answers[np.array([4, 1, 1])]
    np.testing.assert_array_equal(some.u, answers.u[[4, 1, 1]])
    np.testing.assert_array_equal(some.motions.rest, answers.motions.rest[[4, 1, 1]])
    assert answered(4, count=6).motions.context.shape == (6, 4)


@pytest.mark.parametrize(
    ("motions", "said"),
    [
        (lambda: Motions(np.zeros(4), np.zeros(4), 0.5), "states of one arm"),
        (lambda: Motions(ZERO, np.zeros((3, 5)), 0.5), "states of one arm"),
        (lambda: Motions(ZERO[:0], ZERO[:0], 0.5), "states of one arm"),
        (lambda: Motions(ZERO, ZERO, 0.5, np.ones((2, 2))), "as many contexts"),
        (lambda: Motions(ZERO, np.full((3, 4), np.nan), 0.5), "NaN"),
        (lambda: Motions(ZERO, ZERO, 0.5, np.full((3, 2), np.inf)), "NaN or an infinity"),
        (lambda: Motions(ZERO, ZERO, 0.0), "positive time"),
        (lambda: Motions(ZERO, ZERO, float("nan")), "positive time"),
    ],
)
def test_motions_that_are_none_are_refused(motions, said):
    with pytest.raises(UserError, match=said):
        motions()


@pytest.mark.parametrize(
    ("u", "said"),
    [
        (np.zeros((2, 2)), "as many answers"),
        (np.zeros(3), "as many answers"),
        (np.zeros((3, 0)), "as many answers"),
        (np.array([[0, 0], [0, 1.01], [0, 0]]), r"Answer 1 is \[0.0, 1.01\]"),
        (np.full((3, 2), np.nan), "Answer 0"),
    ],
)
def test_answers_that_are_none_are_refused(u, said):
    with pytest.raises(UserError, match=said):
        Answers(Motions(ZERO, ZERO, 0.5), u)


@pytest.fixture(params=["panda", "planar4", "two_arms"])
def chain(request):
    return {
        "panda": lambda: load_robot("panda"),
        "planar4": lambda: planar(4),
        "two_arms": lambda: planar(n_links=3, arms=2),
    }[request.param]().chain


def test_torch_has_the_same_poses(chain):
    import torch

    q = np.random.default_rng(0).uniform(-1, 1, (3, 5, chain.dof))
    poses = TorchPoses(chain, torch.float64)(torch.from_numpy(q)).numpy()
    np.testing.assert_allclose(poses, pose_vectors(chain, q), rtol=0, atol=1e-12)


def test_the_distance_of_poses_is_that_of_places_and_turns(chain):
    q, other = np.random.default_rng(0).uniform(-1, 1, (2, 20, chain.dof))
    squared = np.square(pose_vectors(chain, q) - pose_vectors(chain, other)).sum(axis=-1)
    tools = len(chain.tools)
    expected = np.zeros(20)
    for tool in range(tools):
        one, two = chain.forward(q, tool), chain.forward(other, tool)
        turn = angle_between(one.rotation, two.rotation)
        expected += np.square(one.position - two.position).sum(-1) / tools
        expected += ROTATION_WEIGHT_M**2 * 2 * (1 - np.cos(turn)) / tools
    np.testing.assert_allclose(squared, expected, rtol=1e-9)


def test_a_met_answer_has_no_error_and_an_arm_that_stays_has_one(curved_model, arm, answered):
    motions, u, decoder = answered(4).motions, answered(4).u, curved_model.decoder(1)
    led = motions.start + 0.5 * decoder.decode(u, motions.context)
    met = Answers(Motions(motions.start, led, 0.5), u)
    assert relative_alignment_error(identity, decoder, arm.chain, met) == pytest.approx(0, abs=1e-20)

    def undoes(u, context):
        return np.zeros_like(u)

    class Resting:
        latent_dim = 2

        def decode(self, z, context):
            return np.zeros((*z.shape[:-1], 4))

    assert relative_alignment_error(undoes, Resting(), arm.chain, met) == pytest.approx(1)
    np.testing.assert_allclose(
        outcome(identity, decoder, arm.chain, motions, np.stack([u, -u]))[0], pose_vectors(arm.chain, led)
    )
    assert lengths(arm.chain, motions).shape == (5,)
