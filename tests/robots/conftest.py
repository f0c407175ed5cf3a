import importlib.util
from collections.abc import Callable
from pathlib import Path

import pytest

from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot
from scripted_arms import coupled

__all__ = ["coupled"]


def inside(package: str, file: str) -> Path:
    """Path of a file that a package ships, found without importing the package."""
    spec = importlib.util.find_spec(package)
    assert spec is not None, f"install the dev extra: {package} is missing"
    assert spec.submodule_search_locations
    return Path(next(iter(spec.submodule_search_locations))) / file


@pytest.fixture(scope="session")
def jaco_file() -> Path:
    return inside("dm_control", "third_party/kinova/jaco_arm.xml")


@pytest.fixture(scope="session")
def ur5e_file() -> Path:
    return inside("airo_models", "arms/ur5e/ur5e.urdf")


@pytest.fixture(scope="session")
def the_panda() -> Robot:
    return panda()


@pytest.fixture
def written(tmp_path: Path) -> Callable[..., Path]:
    def write(text: str, name: str = "robot.xml") -> Path:
        path = tmp_path / name
        path.write_text(text)
        return path

    return write
