import numpy as np
import pytest

from latentarm.assistance.controllers.contract import Controller
from latentarm.robots.catalogue import load_robot


class Columns(Controller):
    """Each mode drives its own joints: a = z @ matrix, with any number of input axes."""

    def __init__(self, matrices):
        self._matrices = matrices

    @property
    def modes(self):
        return tuple(f"mode {i}" for i in range(len(self._matrices)))

    @property
    def input_dim(self):
        return self._matrices[0].shape[0]

    def latent(self, u, context, mode):
        return u

    def action(self, z, context, mode):
        return z @ self._matrices[mode]


@pytest.fixture(scope="session")
def planar():
    return load_robot("planar")


@pytest.fixture(scope="session")
def one_mode(planar):
    return Columns([0.5 * np.eye(planar.dof)[:2]])


@pytest.fixture(scope="session")
def two_modes(planar):
    return Columns([0.5 * np.eye(planar.dof)[[0, 1]], 0.5 * np.eye(planar.dof)[[2, 3]]])


@pytest.fixture(scope="session", params=[1, 2, 3])
def any_axes(request, planar):
    return Columns([0.5 * np.eye(planar.dof)[: request.param]])


@pytest.fixture(scope="session")
def wrist():
    """Two joints of a Panda's wrist: nothing that anybody would expect of a stick."""
    return Columns([0.5 * np.eye(7)[[4, 6]]])
