import numpy as np
import pytest

from latentarm.assistance.controllers.latent import LatentController
from latentarm.core.errors import UserError
from latentarm.core.types import Context

BELIEF = np.array([0.5, 0.3, 0.2])


@pytest.fixture(params=["state_decoder", "belief_decoder"])
def decoder(request):
    return request.getfixturevalue(request.param)


def test_inputs_are_decoded_in_the_context_the_model_was_trained_on(decoder, panda):
    context = Context(panda.home, BELIEF)
    u = np.array([0.3, -0.7])
    sees_belief = "belief" in decoder.layout.features
    vector = np.concatenate([panda.home, BELIEF]) if sees_belief else panda.home
    controller = LatentController(decoder)
    assert np.array_equal(
        controller.action(controller.latent(u, context, 0), context, 0), decoder.decode(u, vector)
    )


def test_an_alignment_stands_between_input_and_latent_action(decoder, panda):
    swap = np.array([[0.0, 1.0], [1.0, 0.0]])
    controller = LatentController(decoder, alignment=lambda u, context: u @ swap)
    assert controller.latent(np.array([0.3, -0.7]), Context(panda.home, BELIEF), 0) == pytest.approx(
        [-0.7, 0.3]
    )


def test_a_model_for_another_arm_is_refused(decoder):
    with pytest.raises(UserError, match="trained for this arm"):
        LatentController(decoder).action(np.zeros(2), Context(np.zeros(5), BELIEF), 0)


def test_a_model_for_another_number_of_goals_is_refused(belief_decoder, panda):
    with pytest.raises(UserError, match="2 goals"):
        LatentController(belief_decoder).action(np.zeros(2), Context(panda.home, np.array([0.5, 0.5])), 0)
