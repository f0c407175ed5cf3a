import numpy as np
import pytest
import torch

from latentarm.robots.planar import planar
from latentarm.types import Demonstrations, Episode

JOINTS = 4


@pytest.fixture(autouse=True, scope="session")
def one_thread():
    torch.set_num_threads(1)


def ring(rng, samples=80, rate_hz=20.0):
    """A motion back and forth around a ring whose radius swells: what a joint does depends on where
    the arm is. Two-dimensional at every state, and the last joint never moves."""
    time = np.arange(samples) / rate_hz
    angle = rng.uniform(-np.pi, np.pi) + 2.0 * np.sin(rng.uniform(0.5, 1.0) * time + rng.uniform(0, 6))
    radius = rng.uniform(0.5, 1.0) + 0.3 * np.sin(rng.uniform(1.0, 2.0) * time + rng.uniform(0, 6))
    state = np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), 0.4 * np.sin(2 * angle), np.full(samples, 0.3)],
        axis=-1,
    )
    belief = np.stack([0.5 + 0.4 * np.sin(angle), 0.5 - 0.4 * np.sin(angle)], axis=-1)
    return Episode(state=state, timestamp=time, extras={"belief": belief})


@pytest.fixture(scope="session")
def arm_file(tmp_path_factory):
    """A planar arm of as many joints as a model file, for models that look at the tool."""
    path = tmp_path_factory.mktemp("arm") / "arm.xml"
    path.write_text(planar(JOINTS).mjcf)
    return path


@pytest.fixture(scope="session")
def demonstrations(arm_file):
    rng = np.random.default_rng(3)
    return Demonstrations(
        tuple(ring(rng) for _ in range(12)),
        20.0,
        tuple(f"joint{i + 1}" for i in range(JOINTS)),
        robot=str(arm_file),
    )


@pytest.fixture(scope="session")
def samples():
    """Contexts (N, 4) and latent actions (N, 2) that no model was trained on."""
    rng = np.random.default_rng(4)
    return rng.uniform(-1, 1, size=(30, JOINTS)), rng.uniform(-1, 1, size=(30, 2))
