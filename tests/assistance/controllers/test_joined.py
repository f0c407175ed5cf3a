"""Joined controllers do what each would do alone."""

import numpy as np
import pytest

from latentarm.assistance.controllers.contract import Controller
from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.assistance.controllers.joined import JoinedController
from latentarm.assistance.controllers.latent import LatentController
from latentarm.core.errors import UserError
from latentarm.core.types import Context


def test_every_mode_is_that_of_its_own_controller(state_decoder, panda):
    latent, end_effector = LatentController(state_decoder), EndEffectorController(panda)
    joined = JoinedController([latent, end_effector])
    assert joined.modes == ("latent", "x-y", "z-yaw", "roll-pitch")
    context = Context(panda.home, np.zeros(0))
    u = np.array([[0.5, -1.0], [0.0, 1.0]])
    alone = [(latent, 0)] + [(end_effector, mode) for mode in range(3)]
    for mode, (controller, own) in enumerate(alone):
        z = joined.latent(u, context, mode)
        np.testing.assert_array_equal(z, controller.latent(u, context, own))
        np.testing.assert_array_equal(joined.action(z, context, mode), controller.action(z, context, own))


class Third(Controller):
    """Three axes, one for each of the first joints."""

    modes = ("joints",)
    input_dim = 3

    def latent(self, u, context, mode):
        return 2.0 * u

    def action(self, z, context, mode):
        return np.concatenate([z, np.zeros((*z.shape[:-1], 4))], axis=-1)


def test_axes_that_a_controller_lacks_do_nothing(panda):
    joined = JoinedController([Third(), EndEffectorController(panda)])
    assert joined.input_dim == 3
    context = Context(panda.home, np.zeros(0))
    u = np.array([0.1, 0.2, 0.9])
    np.testing.assert_array_equal(joined.latent(u, context, 0), 2.0 * u)
    z = joined.latent(u, context, 1)
    np.testing.assert_array_equal(z, [0.1, 0.2, 0.0])
    np.testing.assert_array_equal(
        joined.action(z, context, 1), EndEffectorController(panda).action(u[:2], context, 0)
    )


def test_joining_nothing_is_refused():
    with pytest.raises(UserError, match="at least one"):
        JoinedController([])
