"""Poses of things from ROS, over the rosbridge protocol."""

import math
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from rosbridge_server import RosbridgeServer

from latentarm.core.errors import UserError
from latentarm.robots.planar import planar
from latentarm.surroundings.catalogue import open_source
from latentarm.surroundings.contract import Sighting, Source

QUARTER = {"x": 0.0, "y": 0.0, "z": math.sqrt(0.5), "w": math.sqrt(0.5)}
LEVEL = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
CAMERA = {"child_frame_id": "camera", "header": {"frame_id": "base_link", "stamp": {"sec": 0, "nanosec": 0}}}


@pytest.fixture(scope="module")
def ros() -> Iterator[RosbridgeServer]:
    with RosbridgeServer(planar()) as server:
        yield server


def header(frame: str, age_s: float = 0.0) -> dict[str, Any]:
    at_s = time.time() - age_s
    return {"frame_id": frame, "stamp": {"sec": int(at_s), "nanosec": int(1e9 * (at_s % 1.0))}}


def posed(frame: str, x: float, age_s: float = 0.0) -> dict[str, Any]:
    pose = {"position": {"x": x, "y": 0.0, "z": 0.1}, "orientation": LEVEL}
    return {"header": header(frame, age_s), "pose": pose}


def opened(ros: RosbridgeServer, query: str) -> Source:
    return open_source(f"ros2:127.0.0.1:{ros.port}?{query}", ["bowl", "cup"])


def heard(source: Source, ros: RosbridgeServer, *messages: tuple[str, dict[str, Any]]) -> Sighting:
    """The first sighting while messages are published again and again."""
    until_s = time.monotonic() + 5.0
    while time.monotonic() < until_s:
        for topic, message in messages:
            ros.publish(topic, message)
        time.sleep(0.05)
        if found := source.read():
            return found[0]
    raise AssertionError("nothing was seen")


def transform(x: float, turn: dict[str, float]) -> dict[str, Any]:
    return {"translation": {"x": x, "y": 0.0, "z": 0.0}, "rotation": turn}


def test_a_pose_in_the_base_frame_is_as_old_as_its_stamp(ros: RosbridgeServer) -> None:
    source = opened(ros, "bowl=/bowl")
    found = heard(source, ros, ("/bowl", posed("base_link", 0.4, age_s=0.3)))
    source.close()
    assert found.name == "bowl"
    assert found.pose.position == pytest.approx([0.4, 0.0, 0.1])
    assert 0.3 <= time.monotonic() - found.time_s < 1.5
    assert found.position_sd_m == 0.01


def test_a_pose_in_another_frame_is_moved_by_tf(ros: RosbridgeServer) -> None:
    source = opened(ros, "cup=/cup")
    tf = {"transforms": [CAMERA | {"transform": transform(1.0, QUARTER)}]}
    found = heard(source, ros, ("/tf_static", tf), ("/cup", posed("camera", 0.5)))
    source.close()
    assert found.pose.position == pytest.approx([1.0, 0.5, 0.1])


def test_a_thing_may_be_a_frame_of_tf(ros: RosbridgeServer) -> None:
    source = opened(ros, "cup=tf:cup_link")
    cup = {"child_frame_id": "cup_link", "header": header("base_link")}
    tf = {"transforms": [cup | {"transform": transform(0.3, QUARTER)}]}
    found = heard(source, ros, ("/tf", tf))
    source.close()
    assert found.pose.position == pytest.approx([0.3, 0.0, 0.0])
    assert found.pose.rotation[:2, :2] == pytest.approx(np.array([[0.0, -1.0], [1.0, 0.0]]))


def test_a_detection_counts_by_its_likeliest_class_and_its_covariance(ros: RosbridgeServer) -> None:
    def result(name: str, score: float, x: float) -> dict[str, Any]:
        covariance = np.diag([4e-4, 1e-6, 1e-6, 0.01, 0.01, 0.01]).ravel().tolist()
        pose = {"pose": posed("", x)["pose"], "covariance": covariance}
        return {"hypothesis": {"class_id": name, "score": score}, "pose": pose}

    detection = {
        "header": header("base_link"),
        "results": [result("cup", 0.2, 9.0), result("bowl", 0.7, 0.6)],
    }
    source = opened(ros, "detections=/things")
    found = heard(source, ros, ("/things", {"header": header("base_link"), "detections": [detection]}))
    source.close()
    assert (found.name, found.pose.position[0]) == ("bowl", pytest.approx(0.6))
    assert (found.position_sd_m, found.orientation_sd_rad) == pytest.approx((0.02, 0.1))


def test_a_frame_that_nothing_joins_to_the_base_is_not_used(
    ros: RosbridgeServer, capfd: pytest.CaptureFixture[str]
) -> None:
    source = opened(ros, "bowl=/bowl&cup=/cup")
    for _ in range(2):  # by the second time both topics are heard
        found = heard(source, ros, ("/bowl", posed("nowhere", 0.4)), ("/cup", posed("base_link", 0.2)))
        assert found.name == "cup"
    source.close()
    said = capfd.readouterr().err
    assert said.count("the pose of bowl is in the frame nowhere, which /tf does not join to base_link") == 1


def test_another_clock_is_said_once_and_poses_count_from_when_they_arrive(
    ros: RosbridgeServer, capfd: pytest.CaptureFixture[str]
) -> None:
    source = opened(ros, "bowl=/bowl")
    before_s = time.monotonic()
    for _ in range(3):
        found = heard(source, ros, ("/bowl", posed("base_link", 0.4, age_s=3600.0)))
    source.close()
    assert before_s <= found.time_s <= time.monotonic()
    assert capfd.readouterr().err.count("the clock of ROS is not that of this computer") == 1


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("spoon=/spoon", "names spoon, and the model looks at bowl, cup"),
        ("bowl=/a&bowl=/b", "a thing twice"),
        ("bowl", "cannot be read"),
        ("bowl=/bowl&sd_m=-1", "sd_m=-1: it must be a number above zero"),
    ],
)
def test_what_cannot_be_asked_for_is_refused(ros: RosbridgeServer, query: str, said: str) -> None:
    with pytest.raises(UserError, match=said):
        opened(ros, query)
