import numpy as np
import pytest

from latentarm.core.types import Demonstrations, Episode
from latentarm.models.pca.training import PCA
from latentarm.robots.catalogue import load_robot


@pytest.fixture(scope="session")
def panda():
    return load_robot("panda")


def wandering(robot, episodes=4, samples=60, rate_hz=20.0):
    rng = np.random.default_rng(0)
    time = np.arange(samples) / rate_hz
    return Demonstrations(
        tuple(
            Episode(
                state=robot.home + 0.2 * np.sin(time[:, None] + rng.uniform(0, 6, robot.dof)),
                timestamp=time,
                extras={"belief": np.tile(rng.dirichlet([1, 1, 1]), (samples, 1))},
            )
            for _ in range(episodes)
        ),
        rate_hz,
        robot.joint_names,
    )


@pytest.fixture(scope="session")
def state_decoder(panda):
    return PCA(latent_dim=2, context="state").fit(wandering(panda)).decoder(0)


@pytest.fixture(scope="session")
def belief_decoder(panda):
    return PCA(latent_dim=2, context="state_belief").fit(wandering(panda)).decoder(0)
