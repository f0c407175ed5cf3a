import importlib.util
from pathlib import Path

import pytest

from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from scripted_arms import COUPLED

# A slide, an anchor off the joint's frame, a reference angle, two joints on one body, a frozen
# finger on the way to nothing, and a fork in the tree: what the catalogue's robots do not have.
ODD = """
<mujoco model="odd">
  <compiler angle="radian"/>
  <worldbody>
    <body name="post" pos="0.1 0.2 0.3" euler="0.3 0 0.5">
      <body name="carriage" pos="0 0 0.1">
        <joint name="rail" type="slide" axis="1 2 0" ref="0.2" range="-0.5 0.5"/>
        <geom size="0.05"/>
        <body name="upper" pos="0.1 0 0" euler="0 0.4 0">
          <joint name="swing" axis="0 1 1" pos="0.02 -0.03 0.1" ref="0.7" range="-2 2"/>
          <joint name="twist" axis="1 0 0" range="-2 2"/>
          <geom type="box" size="0.02 0.03 0.2"/>
          <body name="cover" pos="0 0.1 0">
            <joint name="hatch" axis="0 0 1" range="0 1"/>
            <geom type="cylinder" size="0.03 0.1"/>
            <body name="lower" pos="0 0 0.3">
              <joint name="elbow" axis="0 0 1" pos="0 0.1 0" range="-2 2"/>
              <geom type="ellipsoid" size="0.03 0.05 0.1"/>
              <site name="tip" pos="0.1 0.2 0.3" euler="0.1 0.2 0.3"/>
            </body>
          </body>
          <body name="finger" pos="0.1 0 0">
            <joint name="knuckle" axis="0 1 0" range="-1 1"/>
            <geom size="0.02"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <keyframe><key name="home" qpos="0.1 0.2 0.3 0.4 0.5 0.6"/></keyframe>
</mujoco>
"""


def inside(package: str, file: str) -> str:
    """Path of a file that a package ships, found without importing the package."""
    spec = importlib.util.find_spec(package)
    assert spec is not None
    assert spec.submodule_search_locations, f"install the dev extra: {package} is missing"
    return str(Path(next(iter(spec.submodule_search_locations))) / file)


@pytest.fixture(scope="session")
def odd_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("odd") / "odd.xml"
    path.write_text(ODD)
    return path


@pytest.fixture(scope="session", params=["panda", "planar", "planar2", "odd", "coupled", "jaco", "ur5e"])
def robot(request: pytest.FixtureRequest, odd_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Robot:
    coupled_file = tmp_path_factory.mktemp("coupled") / "coupled.xml"
    coupled_file.write_text(COUPLED)
    files = {
        "odd": (str(odd_file), "tip"),
        "coupled": (str(coupled_file), "tip"),
        "jaco": (inside("dm_control", "third_party/kinova/jaco_arm.xml"), None),
        "ur5e": (inside("airo_models", "arms/ur5e/ur5e.urdf"), "tool0"),
    }
    return load_robot(*files.get(request.param, (request.param, None)))
