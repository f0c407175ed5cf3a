import numpy as np
import pytest
import torch

from latentarm.core.types import Demonstrations
from latentarm.robots.planar import planar
from latentarm.testing.models import FEW, JOINTS, ring


@pytest.fixture(autouse=True, scope="session")
def one_thread():
    torch.set_num_threads(1)


@pytest.fixture(scope="session")
def arm_file(tmp_path_factory):
    """A planar arm of as many joints as a model file, for models that look at the tool."""
    path = tmp_path_factory.mktemp("arm") / "arm.xml"
    path.write_text(planar(JOINTS).mjcf)
    return path


def rings(arm_file, samples):
    """Twelve motions, each of so many samples."""
    rng = np.random.default_rng(3)
    return Demonstrations(
        tuple(ring(rng, samples) for _ in range(12)),
        20.0,
        tuple(f"joint{i + 1}" for i in range(JOINTS)),
        robot=str(arm_file),
    )


@pytest.fixture(scope="session")
def demonstrations(arm_file):
    return rings(arm_file, 80)


@pytest.fixture(scope="session")
def few(arm_file):
    """Short motions, for models of which nobody asks how well they learn."""
    return rings(arm_file, FEW)


@pytest.fixture(scope="session")
def samples():
    """Contexts (N, 4) and latent actions (N, 2) that no model was trained on."""
    rng = np.random.default_rng(4)
    return rng.uniform(-1, 1, size=(30, JOINTS)), rng.uniform(-1, 1, size=(30, 2))
