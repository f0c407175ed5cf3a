"""Lenses and places of cameras from pictures of a board: what is found, and what is refused."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np
import pytest
from rosbridge_server import RosbridgeServer
from scipy.spatial.transform import Rotation

from drawn_planes import LENS, drawn, looking, projected, write_video
from latentarm.cli import main
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.panda import panda
from latentarm.surroundings.tags.board import Board, BoardView
from latentarm.surroundings.tags.files import CameraEntry, read_cameras, write_cameras
from latentarm.surroundings.tags.frames import frame, inverse, moved, shifted
from latentarm.surroundings.tags.hand_eye import Mount, Shot, calibrate_hand_eye
from latentarm.surroundings.tags.intrinsics import calibrate_intrinsics
from latentarm.surroundings.tags.pictures import read_grey

BOARD = Board(7, 5, 0.03)
POINTS = np.asarray(BOARD.made.getChessboardCorners(), float)
MIDDLE_M = np.array([0.105, 0.075, 0.0])  # of the board in its frame
MIDDLE_Q = np.array([0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.8])
NOISE_PX = 0.1
BOARD_ENDS = np.array([(0, 0, 0), (0.21, 0, 0), (0.21, 0.15, 0), (0, 0.15, 0)])


def tool(q: FloatArray) -> FloatArray:
    pose = panda().chain.forward(q)
    return frame(pose.rotation, pose.position)


def ahead(distance_m: float, turns: Sequence[float] = (0.0, 0.0, 0.0)) -> FloatArray:
    """The pose of the board in a camera's frame with its middle straight ahead."""
    turn = Rotation.from_euler("xyz", turns).as_matrix()
    return frame(turn, np.array([0.0, 0.0, distance_m]) - turn @ MIDDLE_M)


def view_of(board: FloatArray, rng: np.random.Generator) -> BoardView | None:
    """The board at a pose in the camera's frame; None where not all of it is in the picture."""
    at = moved(board, POINTS)
    if board[2, 2] < 0.3 or np.abs(at[:, :2] / at[:, 2:]).max() > 0.8:
        return None
    pixels = projected(at)
    if pixels.min() < 5 or (pixels > np.array(LENS.size_px) - 5).any():
        return None
    return BoardView(POINTS, pixels + rng.normal(0, NOISE_PX, pixels.shape))


def place(mount: Mount) -> tuple[FloatArray, FloatArray]:
    """The camera in what it is fixed to, and the board in what that is fixed to."""
    if mount == "tool":
        camera = frame(Rotation.from_euler("xyz", [0.1, -0.05, 0.3]).as_matrix(), np.array([0.05, 0.02, 0]))
        return camera, tool(MIDDLE_Q) @ camera @ ahead(0.45)
    held = tool(MIDDLE_Q)
    camera = looking(held[:3, 3] + [0.5, 0.2, 0.2], held[:3, 3])
    return camera, inverse(held) @ camera @ ahead(0.5)


def shots(
    mount: Mount,
    count: int = 12,
    *,
    turns: float = 0.6,  # of the board against the camera, at most, rad
    arm: float = 0.0,  # SD of what the arm says of itself, m and rad
    slip: float = 0.0,  # of the board before the sixth picture, for that one, m
    scale: float = 1.0,  # of the board as stated
) -> list[Shot]:
    """Pictures at random poses."""
    rng = np.random.default_rng(3)
    camera, board = place(mount)
    taken: list[Shot] = []
    while len(taken) < count:
        seen = ahead(rng.uniform(0.35, 0.6), rng.uniform(-turns, turns, 3))
        ends = (camera, board) if mount == "base" else (board, camera)
        pose = ends[0] @ (seen if mount == "base" else inverse(seen)) @ inverse(ends[1])
        slipped = seen @ frame(np.eye(3), np.array([slip * (len(taken) == 5), 0, 0]))
        view = view_of(slipped, rng)
        if view is not None:
            stated = BoardView(view.points * scale, view.pixels)
            taken.append(Shot(f"{len(taken) + 1:03}.png", shifted(pose, rng.normal(0, arm, 6)), stated))
    return taken


@pytest.mark.parametrize("mount", ["base", "tool"])
def test_a_camera_is_found_to_within_what_is_stated(mount: Mount) -> None:
    found = calibrate_hand_eye(shots(mount, arm=0.0005), LENS, mount)
    camera, _ = place(mount)
    off_m = np.linalg.norm(found.camera[:3, 3] - camera[:3, 3])
    off_rad = Rotation.from_matrix(found.camera[:3, :3] @ camera[:3, :3].T).magnitude()
    assert off_m < 0.003
    assert off_m < 4 * found.position_sd_m
    assert off_rad < 4 * found.orientation_sd_rad
    assert found.residual_mm < 2.0


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda: shots("base", 6), "visible at 6 poses, and 10 are needed"),
        (
            lambda: shots("base", turns=0.05),
            r"turned too much alike: by [12]° .* 10° are needed",
        ),
        (lambda: shots("base", slip=0.03), r"the worst is 006.png\. Fix the board so that it cannot slip"),
        (lambda: shots("base", scale=1.05), r"is 95\.. % as large as stated: measure a square"),
        (lambda: shots("base", arm=0.02), r"check that the arm's model is the arm"),
    ],
)
def test_poor_poses_are_refused_with_what_to_do(made: Callable[[], list[Shot]], said: str) -> None:
    with pytest.raises(UserError, match=said):
        calibrate_hand_eye(made(), LENS, "base")


def held_about(count: int, tilt: float, distance_m: tuple[float, float] = (0.35, 0.6)) -> list[BoardView]:
    """The board in many parts of the picture, tilted to both sides by up to ``tilt``, rad."""
    rng = np.random.default_rng(5)
    taken: list[BoardView] = []
    while len(taken) < count:
        far = rng.uniform(*distance_m)
        board = ahead(far, [*rng.uniform(-tilt, tilt, 2), rng.uniform(-0.5, 0.5)])
        board[:2, 3] += rng.uniform(-0.35, 0.35, 2) * far
        view = view_of(board, rng)
        if view is not None:
            taken.append(view)
    return taken


def test_a_lens_is_found() -> None:
    found = calibrate_intrinsics(held_about(20, 0.7), LENS.size_px)
    assert np.abs(found.lens.matrix - LENS.matrix).max() < 3.0
    assert found.rms_px < 2 * NOISE_PX
    assert np.abs(found.lens.matrix[0, 0] / LENS.matrix[0, 0] - 1.0) < 4 * found.focal_sd


@pytest.mark.parametrize(
    ("views", "said"),
    [
        (lambda: held_about(6, 0.7), "in 6 pictures, and 10 are needed"),
        (lambda: held_about(12, 0.0), "Tilt the board by 30° or more"),
        (lambda: held_about(12, 0.7, (1.5, 1.6))[:1] * 12, "hold it near all four edges"),
    ],
)
def test_poor_pictures_of_a_board_are_refused(views: Callable[[], list[BoardView]], said: str) -> None:
    with pytest.raises(UserError, match=said):
        calibrate_intrinsics(views(), LENS.size_px)


def test_a_folder_of_pictures_places_a_camera(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rng = np.random.default_rng(7)
    camera, board = place("base")
    folder, joints = tmp_path / "place", {}
    folder.mkdir()
    image = BOARD.made.generateImage((700, 500))
    while len(joints) < 16:
        q = MIDDLE_Q + rng.normal(0, 0.25, 7)
        to_camera = inverse(camera) @ tool(q) @ board
        if view_of(to_camera, rng) is not None:
            name = f"{len(joints):03}.png"
            cv2.imwrite(str(folder / name), drawn([(image, moved(to_camera, BOARD_ENDS))]))
            joints[name] = q.tolist()
    (folder / "joints.json").write_text(json.dumps(joints))
    cameras = tmp_path / "cameras.toml"
    write_cameras(cameras, {"front": CameraEntry.of_lens("testsrc", LENS)})
    words = ["--pictures", str(folder), "--robot", "panda", "--cameras", str(cameras), "--json"]
    assert main(["calibrate", "hand-eye", "front", *words]) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures["poses"] >= 12
    assert figures["residual_mm"] < 2.0
    found = read_cameras(cameras)["front"]
    assert found.mount == "base"
    assert np.abs(found.pose - camera).max() < 0.002


def test_a_board_is_written_to_print(tmp_path: Path) -> None:
    assert main(["calibrate", "board", "--out", str(tmp_path / "board.pdf")]) == 0
    assert (tmp_path / "board.pdf").read_bytes().startswith(b"%PDF")


def test_pictures_are_taken_at_poses_of_the_arm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    camera, board = place("base")
    corners = moved(inverse(camera) @ tool(MIDDLE_Q) @ board, BOARD_ENDS)
    image = drawn([(BOARD.made.generateImage((700, 500)), corners)])
    write_video(tmp_path / "front.mp4", image)
    cameras, folder = tmp_path / "cameras.toml", tmp_path / "place"
    write_cameras(cameras, {"front": CameraEntry.of_lens(str(tmp_path / "front.mp4"), LENS)})
    typed = iter(["", "", "done"])
    monkeypatch.setattr("builtins.input", lambda _: next(typed))
    monkeypatch.setattr("latentarm.commands.calibrate.LET_GO_S", 0.0)
    with RosbridgeServer(panda()) as server:
        words = ["--pictures", str(folder), "--robot", "panda", "--cameras", str(cameras)]
        words += ["--arm", server.address]
        assert main(["calibrate", "hand-eye", "front", *words]) == 2  # two are too few
    joints = json.loads((folder / "joints.json").read_text())
    assert sorted(path.name for path in folder.glob("*.png")) == sorted(joints) == ["001.png", "002.png"]
    assert joints["001.png"] == pytest.approx(panda().home.tolist(), abs=0.01)
    assert np.abs(read_grey(folder / "001.png").astype(float) - image).mean() < 30  # YUV has another range
