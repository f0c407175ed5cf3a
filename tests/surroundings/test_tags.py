"""Poses of things from their tags: laws of the geometry, and pictures that are drawn."""

import threading
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from documentation import ROOT, blocks
from drawn_planes import LENS, drawn, looking, projected, tag_image, write_video
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.surroundings.catalogue import open_source
from latentarm.surroundings.contract import Sighting
from latentarm.surroundings.tags.detecting import Detector
from latentarm.surroundings.tags.files import CameraEntry, read_tags, write_cameras
from latentarm.surroundings.tags.frames import frame, inverse, moved
from latentarm.surroundings.tags.solving import CORNER_PX, SeenTag, corners_on_tag, solve

MIDDLE = np.array([0.45, 0.0, 0.0])
LEFT, RIGHT = (looking(np.array([0.95, y, 0.5]), MIDDLE) for y in (-0.45, 0.45))
SIZE_M = 0.05
PLATE = [frame(np.eye(3), np.array([x, y, 0.0])) for x, y in ((0.08, 0.08), (-0.08, 0.08), (-0.08, -0.08))]


def seen(pose: FloatArray, camera: FloatArray, on_thing: FloatArray, off_px: object = 0.0) -> SeenTag:
    corners = projected(moved(inverse(camera) @ pose @ on_thing, corners_on_tag(SIZE_M)))
    return SeenTag(corners + off_px, LENS, camera, SIZE_M, on_thing)


def off(found: FloatArray, true: FloatArray) -> FloatArray:
    turn = Rotation.from_matrix(found[:3, :3] @ true[:3, :3].T).as_rotvec()
    return np.concatenate([found[:3, 3] - true[:3, 3], turn])


angle = st.floats(-0.5, 0.5)


@given(turns=st.tuples(angle, angle, st.floats(-3, 3)), at=st.tuples(*[st.floats(-0.12, 0.12)] * 3))
def test_a_pose_is_found_again_from_where_its_corners_are(
    turns: tuple[float, ...], at: tuple[float, ...]
) -> None:
    pose = frame(Rotation.from_euler("xyz", turns).as_matrix(), MIDDLE + at)
    found = solve([seen(pose, camera, PLATE[0]) for camera in (LEFT, RIGHT)])
    assert found is not None
    assert np.abs(off(found.pose, pose)).max() < 1e-5


def test_the_stated_deviations_are_those_of_the_errors() -> None:
    rng = np.random.default_rng(0)
    squares = []
    for _ in range(60):
        pose = frame(Rotation.from_euler("z", rng.uniform(-3, 3)).as_matrix(), MIDDLE)
        tags = [
            seen(pose, camera, tag, rng.normal(0, CORNER_PX, (4, 2)))
            for camera in (LEFT, RIGHT)
            for tag in PLATE
        ]
        found = solve(tags)
        assert found is not None
        error = off(found.pose, pose)
        squares.append(error @ np.linalg.solve(found.covariance, error))
    # Chi-squared with 6 degrees of freedom: the mean of 60 has an SD of 0.45.
    assert 4.5 < np.mean(squares) < 7.5


def test_a_tag_that_contradicts_the_others_is_left_out() -> None:
    pose = frame(Rotation.from_euler("z", 1.0).as_matrix(), MIDDLE)
    tags = [seen(pose, camera, tag) for camera in (LEFT, RIGHT) for tag in PLATE]
    tags[2] = seen(pose, LEFT, PLATE[2], np.array([9.0, -4.0]))
    found = solve(tags)
    assert found is not None
    assert found.used == 5
    assert np.abs(off(found.pose, pose)).max() < 1e-5


def test_two_tags_that_contradict_each_other_give_no_pose() -> None:
    pose = frame(np.eye(3), MIDDLE)
    assert solve([seen(pose, LEFT, PLATE[0]), seen(pose, LEFT, PLATE[1], np.array([15.0, 9.0]))]) is None


def test_a_square_that_fits_two_poses_needs_a_second_view() -> None:
    pose = frame(Rotation.from_euler("z", 0.4).as_matrix(), MIDDLE)
    far = looking(np.array([1.6, -1.2, 1.2]), MIDDLE)
    assert solve([seen(pose, far, np.eye(4))]) is None
    assert solve([seen(pose, far, np.eye(4)), seen(pose, RIGHT, np.eye(4))]) is not None


def test_of_two_poses_the_one_that_would_lean_too_far_is_left_out() -> None:
    pose = frame(Rotation.from_euler("z", 0.4).as_matrix(), MIDDLE)
    found = solve([seen(pose, looking(np.array([1.6, -1.2, 1.2]), MIDDLE), np.eye(4))], np.radians(30))
    assert found is not None
    assert np.abs(off(found.pose, pose)).max() < 1e-4


def picture(pose: FloatArray, camera: FloatArray) -> np.ndarray:
    planes = [
        (tag_image(number), moved(inverse(camera) @ pose @ tag, corners_on_tag(SIZE_M * 10 / 8)))
        for number, tag in enumerate(PLATE)
    ]
    return drawn(planes)


def test_corners_in_a_picture_are_found_to_a_fifth_of_a_pixel() -> None:
    rng = np.random.default_rng(1)
    pose = frame(Rotation.from_euler("z", 0.7).as_matrix(), MIDDLE)
    grey = np.clip(0.6 * picture(pose, LEFT) + rng.normal(0, 4, (480, 640)), 0, 255).astype(np.uint8)
    found = Detector("apriltag_36h11").find(grey)
    assert sorted(found) == [0, 1, 2]
    for number, corners in found.items():
        assert np.abs(corners - seen(pose, LEFT, PLATE[number]).corners).max() < 0.2


@pytest.fixture(scope="module")
def videos(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("videos")
    for name, camera in (("left", LEFT), ("right", RIGHT)):
        write_video(folder / f"{name}.mp4", picture(frame(np.eye(3), MIDDLE), camera))
    return folder


@pytest.fixture
def tags_file(tmp_path: Path, videos: Path) -> Path:
    cameras = {}
    for name, camera in (("left", LEFT), ("right", RIGHT)):
        turn = Rotation.from_matrix(camera[:3, :3]).as_quat(scalar_first=True)
        cameras[name] = CameraEntry.of_lens(str(videos / f"{name}.mp4"), LENS).model_copy(
            update={"mount": "base", "position_m": tuple(camera[:3, 3]), "quaternion_wxyz": tuple(turn)}
        )
    write_cameras(tmp_path / "cameras.toml", cameras)
    lines = ['cameras = "cameras.toml"', 'family = "apriltag_36h11"']
    for number, tag in enumerate(PLATE):
        lines += ["[[tags]]", f"id = {number}", 'thing = "bowl"', f"size_m = {SIZE_M}"]
        lines += [f"position_m = {tag[:3, 3].tolist()}"]
    (tmp_path / "tags.toml").write_text("\n".join(lines))
    return tmp_path / "tags.toml"


def first_sighting(text: str) -> Sighting:
    source = open_source(text, ["bowl", "cup"])
    try:
        until_s = time.monotonic() + 10.0
        while not (found := source.read()):
            assert time.monotonic() < until_s, "nothing was seen"
            time.sleep(0.02)
        return found[0]
    finally:
        source.close()


def test_a_thing_is_seen_by_two_cameras_at_once(tags_file: Path) -> None:
    before_s = time.monotonic()
    found = first_sighting(f"tags:{tags_file}")
    assert found.name == "bowl"
    assert np.abs(found.pose.position - MIDDLE).max() < 0.001
    assert np.degrees(np.linalg.norm(off(frame(found.pose.rotation, MIDDLE), frame(np.eye(3), MIDDLE)))) < 0.5
    assert found.position_sd_m < 0.001
    assert before_s <= found.time_s <= time.monotonic()


def test_how_well_a_camera_is_placed_counts(tags_file: Path) -> None:
    cameras = tags_file.parent / "cameras.toml"
    cameras.write_text(cameras.read_text().replace("position_sd_m = 0.0", "position_sd_m = 0.004"))
    assert first_sighting(f"tags:{tags_file}").position_sd_m > 0.004


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("id = 1", "id = 0", "the tag 0 is there twice"),
        ("size_m = 0.05", "size_m = 5", "tags.0.size_m: "),
        ("36h11", "36h12", "the family must be one of"),
        ("id = 1", "number = 1", "tags.1.id: "),
    ],
)
def test_a_wrong_entry_is_named(tags_file: Path, old: str, new: str, said: str) -> None:
    tags_file.write_text(tags_file.read_text().replace(old, new, 1))
    with pytest.raises(UserError, match=said):
        read_tags(tags_file)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('mount = "base"', 'mount = "tool"', "is on the wrist, and only fixed ones can be used"),
        ("[640, 480]", "[1280, 720]", "was calibrated with others"),
        ("left.mp4", "gone.mp4", "the file does not exist"),
    ],
)
def test_a_camera_that_does_not_fit_is_refused(tags_file: Path, old: str, new: str, said: str) -> None:
    cameras = tags_file.parent / "cameras.toml"
    cameras.write_text(cameras.read_text().replace(old, new))
    with pytest.raises(UserError, match=said):
        open_source(f"tags:{tags_file}", ["bowl"])
    assert not [one for one in threading.enumerate() if one.name == "tags"]


def test_tags_on_other_things_are_refused(tags_file: Path) -> None:
    with pytest.raises(UserError, match="has tags on bowl, and the model looks at cup"):
        open_source(f"tags:{tags_file}", ["cup"])


def test_the_tags_file_of_the_page_can_be_read(tmp_path: Path) -> None:
    (written,) = [one for one in blocks(ROOT / "docs" / "objects-with-tags.md") if one.language == "toml"]
    (tmp_path / "tags.toml").write_text(written.code)
    assert read_tags(tmp_path / "tags.toml").tags[0].thing == "bowl"
