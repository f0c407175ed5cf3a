"""Fixtures of tests of alignment: arms, and decoders for them."""

from collections.abc import Callable

import numpy as np
import pytest

from latentarm.alignment.answers import Answers, Motions
from latentarm.core.types import Demonstrations, Episode
from latentarm.models.estimators import MODELS
from latentarm.models.pca.training import PCA
from latentarm.robots.assemble import assemble
from latentarm.robots.limits import JointLimits
from latentarm.robots.planar import planar

SLIDES = """
<mujoco><worldbody>
  <body><joint name="x" type="slide" axis="1 0 0" range="-1 1"/><geom type="sphere" size="0.05" mass="1"/>
    <body><joint name="y" type="slide" axis="0 1 0" range="-1 1"/><geom type="sphere" size="0.05" mass="1"/>
      <body><joint name="z" type="slide" axis="0 0 1" range="-1 1"/><geom type="sphere" size="0.05" mass="1"/>
        <site name="tool"/>
</body></body></body></worldbody></mujoco>"""

PLANE = np.linalg.qr(np.array([[1.0, 0.2, 0.5], [-0.2, 1.0, 0.4]]).T)[0].T
"""Two directions that the linear decoder moves the slides along."""


@pytest.fixture(scope="session")
def slides():
    """Three slides: the tool's position is the state."""
    one = np.ones(3)
    limits = JointLimits(-one, one, one, 10 * one, 1000 * one)
    return assemble("slides", SLIDES, ["tool"], limits, np.zeros(3), 2.0)


@pytest.fixture(scope="session")
def circles(slides):
    """Circles both ways round in one plane: no direction of it is special, and the mean motion is none."""
    time = np.arange(60) / 20.0
    turns = [(way * speed, start) for way in (2, -2) for speed, start in ((1.0, 0.0), (1.1, 2.0), (0.9, 4.0))]
    states = [
        0.15 * np.stack([np.cos(rate * time + start), np.sin(rate * time + start)], axis=-1) @ PLANE
        for rate, start in turns
    ]
    return Demonstrations(tuple(Episode(state, time) for state in states), 20.0, slides.joint_names)


@pytest.fixture(scope="session")
def linear_model(circles):
    """A decoder that is linear in z and the same everywhere."""
    return PCA(latent_dim=2).fit(circles)


@pytest.fixture(scope="session")
def columns(linear_model) -> np.ndarray:
    """(2, 3), what z moves the slides by, per s."""
    decoder = linear_model.decoder()
    return np.stack([decoder.decode(z, np.zeros(3)) - decoder.decode(0 * z, np.zeros(3)) for z in np.eye(2)])


@pytest.fixture(scope="session")
def arm():
    return planar(4)


@pytest.fixture(scope="session")
def swings(arm, tmp_path_factory):
    """A planar arm of four joints that swings to and fro, with a belief over two goals."""
    path = tmp_path_factory.mktemp("arm") / "arm.xml"
    path.write_text(arm.mjcf)
    rng = np.random.default_rng(3)
    time = np.arange(60) / 20.0
    episodes = []
    for _ in range(8):
        angle = rng.uniform(-1, 1) + np.sin(rng.uniform(1.0, 2.0) * time + rng.uniform(0, 6))
        other = 0.5 * np.cos(rng.uniform(1.0, 2.0) * time + rng.uniform(0, 6))
        state = np.stack([0.5 * angle, other, 0.3 * angle * other, 0.2 + 0 * angle], axis=-1)
        belief = np.stack([0.5 + 0.4 * np.sin(angle), 0.5 - 0.4 * np.sin(angle)], axis=-1)
        episodes.append(Episode(state, time, extras={"belief": belief}))
    return Demonstrations(tuple(episodes), 20.0, arm.joint_names, robot=str(path))


@pytest.fixture(scope="session")
def curved_model(swings):
    """A decoder that depends on the state, two seeds of it."""
    return MODELS["cae"](seeds=2, epochs=4, hidden=(8, 8), window=3).fit(swings)


@pytest.fixture(scope="session")
def answered() -> Callable[..., Answers]:
    """Random motions of n joints, rad or m, with random inputs."""

    def make(joints: int, count: int = 5, goals: int = 0, seed: int = 0) -> Answers:
        rng = np.random.default_rng(seed)
        start = rng.uniform(-0.5, 0.5, (count, joints))
        end = start + rng.uniform(-0.1, 0.1, (count, joints))
        belief = rng.dirichlet(np.ones(goals), count) if goals else np.empty((count, 0))
        return Answers(Motions(start, end, 0.5, belief), rng.uniform(-1, 1, (count, 2)))

    return make
