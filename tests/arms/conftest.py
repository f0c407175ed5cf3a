import pytest

from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot


@pytest.fixture(scope="session")
def the_panda() -> Robot:
    return panda()
