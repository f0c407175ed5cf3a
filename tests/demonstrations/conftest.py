from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from latentarm.core.types import Demonstrations, Episode, Goal, Pose
from latentarm.robots.catalogue import load_robot
from latentarm.robots.limits import JointLimits
from latentarm.robots.robot import Robot

SO101 = """
<mujoco model="so101_new_calib"><compiler angle="radian"/><worldbody>
<body name="shoulder" pos="0 0 .06"><joint name="shoulder_pan" axis="0 0 1" range="-1.91986 1.91986"/>
<geom type="capsule" size=".02" fromto="0 0 0 0 0 .05"/>
<body name="upper_arm" pos="0 0 .05"><joint name="shoulder_lift" axis="0 1 0" range="-1.74533 1.74533"/>
<geom type="capsule" size=".02" fromto="0 0 0 0 0 .11"/>
<body name="lower_arm" pos="0 0 .11"><joint name="elbow_flex" axis="0 1 0" range="-1.69 1.69"/>
<geom type="capsule" size=".02" fromto="0 0 0 .13 0 0"/>
<body name="wrist" pos=".13 0 0"><joint name="wrist_flex" axis="0 1 0" range="-1.65806 1.65806"/>
<geom type="capsule" size=".02" fromto="0 0 0 .06 0 0"/>
<body name="gripper" pos=".06 0 0"><joint name="wrist_roll" axis="1 0 0" range="-2.74385 2.84121"/>
<geom type="capsule" size=".02" fromto="0 0 0 .05 0 0"/><site name="gripperframe" pos=".1 0 0"/>
<body name="jaw" pos=".05 0 0"><joint name="gripper" axis="0 0 1" range="-.174533 1.74533"/>
<geom type="capsule" size=".01" fromto="0 0 0 .05 0 0"/>
</body></body></body></body></body></body></worldbody></mujoco>
"""
"""Joints and limits of the SO-101 (TheRobotStudio's URDF of the new calibration), with plain shapes."""

SHARED = Path(__file__).resolve().parents[3] / "shared" / "demonstrations"


def make_episode(index: int, samples: int = 6, dof: int = 3, task: str = "pour") -> Episode:
    """An episode whose every number says where it belongs."""
    time = np.arange(samples) / 10
    state = 0.1 * index + 0.01 * np.arange(samples)[:, None] + 0.001 * np.arange(dof)
    return Episode(
        state=state,
        timestamp=time,
        action=np.full((samples, dof), 0.1 * index),
        task=task,
        extras={"belief": np.tile([0.25, 0.75], (samples, 1)), "assist.alpha": np.full((samples, 1), 0.5)},
    )


def make_demonstrations(episodes: int = 3) -> Demonstrations:
    goal = Goal("cup", np.array([0.1, 1 / 3, -0.2]), Pose(np.array([0.5, 0.1, 1 / 7]), np.eye(3)))
    return Demonstrations(
        episodes=tuple(make_episode(index, samples=5 + index) for index in range(episodes)),
        rate_hz=10.0,
        joint_names=("shoulder", "elbow", "wrist"),
        robot="planar",
        goals=(goal,),
    )


def same(left: Demonstrations, right: Demonstrations) -> bool:
    """Equal to single precision, with goals, rate and words exact."""
    return (
        (left.rate_hz, left.joint_names, left.robot) == (right.rate_hz, right.joint_names, right.robot)
        and len(left.goals) == len(right.goals)
        and all(
            one.name == other.name
            and np.array_equal(one.configuration, other.configuration)
            and np.array_equal(one.pose.position, other.pose.position)
            and np.array_equal(one.pose.rotation, other.pose.rotation)
            for one, other in zip(left.goals, right.goals, strict=True)
        )
        and len(left.episodes) == len(right.episodes)
        and all(map(same_episode, left.episodes, right.episodes))
    )


def same_episode(left: Episode, right: Episode) -> bool:
    def close(one: np.ndarray | None, other: np.ndarray | None) -> bool:
        if one is None or other is None:
            return one is other
        return one.dtype == other.dtype == np.float64 and np.array_equal(
            one.astype(np.float32), other.astype(np.float32)
        )

    return (
        left.task == right.task
        and close(left.state, right.state)
        and close(left.timestamp, right.timestamp)
        and close(left.action, right.action)
        and left.extras.keys() == right.extras.keys()
        and all(close(left.extras[name], right.extras[name]) for name in left.extras)
    )


@pytest.fixture
def demonstrations() -> Demonstrations:
    return make_demonstrations()


@pytest.fixture(scope="session")
def episode_of() -> Callable[..., Episode]:
    return make_episode


@pytest.fixture(scope="session")
def equal() -> Callable[[Demonstrations, Demonstrations], bool]:
    return same


@pytest.fixture
def real() -> Path:
    """Folder of the real Panda recordings, where they lie beside the project."""
    if not SHARED.is_dir():
        pytest.skip("the real recordings are not beside the project")
    return SHARED


@pytest.fixture(scope="session")
def so101(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    path = tmp_path_factory.mktemp("robot") / "so101.xml"
    path.write_text(SO101)
    return load_robot(str(path))


@pytest.fixture
def panda_limits() -> JointLimits:
    return JointLimits(
        lower=np.array([-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973]),
        upper=np.array([2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973]),
        velocity=np.array([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61]),
        acceleration=np.array([15, 7.5, 10, 12.5, 15, 20, 20]),
        jerk=np.array([7500, 3750, 5000, 6250, 7500, 10000, 10000]),
    )
