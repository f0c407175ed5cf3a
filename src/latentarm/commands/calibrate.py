"""`latentarm calibrate`: the optics of a camera, and where it is, from pictures of a printed board."""

import json as json_format
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal

import numpy as np
from tyro.conf import Positional, arg

from latentarm.commands.output import say
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.core.untrusted.opening import is_missing
from latentarm.runs.options import EndEffector, Json
from latentarm.surroundings.tags import check_installed

if TYPE_CHECKING:
    from latentarm.cameras.sources import CameraSource
    from latentarm.robots.robot import Robot
    from latentarm.surroundings.tags.board import Board

Squares = Annotated[str, arg(metavar="COLUMNSxROWS", help="Squares of the board along its sides.")]
SquareMm = Annotated[float, arg(metavar="MM", help="Side of a square, measured on the printed board.")]
Cameras = Annotated[Path, arg(metavar="FILE", help="The cameras file, which is written.")]
LET_GO_S: Final = 2.0  # between the person's key and the picture: a hand leaves the arm
_USUAL: Final = ("7x5", 30.0, Path("cameras.toml"))


def print_board(
    out: Annotated[Path, arg(metavar="FILE", help="A PDF file, which is written.")],
    squares: Squares = _USUAL[0],
    square_mm: SquareMm = _USUAL[1],
    json: Json = False,
) -> int:
    """Write a board to print at its true size; measure a square, and glue it to something flat.

    For example: latentarm calibrate board --out board.pdf
    """
    from matplotlib.figure import Figure

    from latentarm.core.files import written_whole

    board = _board(squares, square_mm)
    size_inch = np.array([board.columns, board.rows]) * square_mm / 25.4
    page = Figure(figsize=tuple(size_inch * 1.1))
    axes = page.add_axes((1 / 22, 1 / 22, 10 / 11, 10 / 11))
    axes.axis("off")
    pixels = board.made.generateImage((board.columns * 100, board.rows * 100))
    axes.imshow(pixels, cmap="gray", interpolation="none", aspect="auto")
    with written_whole(out) as part:
        page.savefig(part, format="pdf")
    wide_mm, high_mm = (25.4 * size_inch).tolist()
    last = f"Print {out} at 100 % on something flat, and measure a square."
    _tell({"wide_mm": wide_mm, "high_mm": high_mm}, last, json)
    return 0


def intrinsics(
    camera: Annotated[Positional[str], arg(metavar="NAME=ADDRESS", help="The camera, as for `teleop`.")],
    pictures: Annotated[
        Path, arg(metavar="DIR", help="Pictures of the board; a missing folder starts taking them.")
    ],
    squares: Squares = _USUAL[0],
    square_mm: SquareMm = _USUAL[1],
    cameras: Cameras = _USUAL[2],
    json: Json = False,
) -> int:
    """Find the optics of a camera from 10 or more pictures of a board.

    For example: latentarm calibrate intrinsics front=/dev/video0 --pictures front-lens
    """
    check_installed("latentarm calibrate")
    from latentarm.cameras.sources import parse_cameras
    from latentarm.surroundings.tags.files import CameraEntry, read_cameras, write_cameras
    from latentarm.surroundings.tags.intrinsics import calibrate_intrinsics
    from latentarm.surroundings.tags.pictures import picture_files, read_grey

    board = _board(squares, square_mm)
    source = parse_cameras([camera])[0]
    if is_missing(pictures):
        how = "Hold the board still, tilted another way and in another part of the picture than before."
        _take(source, pictures, board, lambda prompt: _entered(f"{prompt} {how}"), lambda _: None)
    grey = [read_grey(path) for path in picture_files(pictures)]
    sizes = {one.shape for one in grey}
    if len(sizes) > 1:
        raise UserError(f"The pictures in {pictures} have different sizes: take them with one camera.")
    views = [view for view in map(board.find, grey) if view is not None]
    found = calibrate_intrinsics(views, grey[0].shape[::-1])
    known = {} if is_missing(cameras) else read_cameras(cameras)
    write_cameras(cameras, known | {source.name: CameraEntry.of_lens(source.address, found.lens)})
    figures = {"pictures": len(views), "rms_px": found.rms_px, "focal_sd_percent": 100 * found.focal_sd}
    _tell(figures, f"Written to {cameras}. Next: latentarm calibrate hand-eye {source.name}", json)
    return 0


def hand_eye(
    name: Annotated[Positional[str], arg(metavar="NAME", help="A camera of the cameras file.")],
    pictures: Annotated[
        Path,
        arg(
            metavar="DIR", help="Pictures of the board and joints.json; a missing folder starts taking them."
        ),
    ],
    robot: Annotated[str, arg(help="The arm: a robot's name, or the path of an MJCF or URDF file.")],
    mount: Annotated[
        Literal["base", "tool"],
        arg(
            help="base: the camera is fixed in the room and the gripper holds the board. tool: on the wrist."
        ),
    ] = "base",
    end_effector: EndEffector = None,
    arm: Annotated[str | None, arg(metavar="URL", help="The arm to read, where pictures are taken.")] = None,
    squares: Squares = _USUAL[0],
    square_mm: SquareMm = _USUAL[1],
    cameras: Cameras = _USUAL[2],
    json: Json = False,
) -> int:
    """Find where a camera is, from pictures of the board at 12 or more poses of the arm.

    For example: latentarm calibrate hand-eye front --pictures place --robot fr3 --arm franka://172.16.0.2
    """
    check_installed("latentarm calibrate")
    from latentarm.robots.catalogue import load_robot
    from latentarm.surroundings.tags.files import read_cameras, write_cameras
    from latentarm.surroundings.tags.frames import frame
    from latentarm.surroundings.tags.hand_eye import Shot, calibrate_hand_eye
    from latentarm.surroundings.tags.pictures import picture_files, read_grey, read_joints, write_joints

    board, known, driven = _board(squares, square_mm), read_cameras(cameras), load_robot(robot, end_effector)
    if name not in known:
        raise UserError(f"{cameras} has no camera {name}: run latentarm calibrate intrinsics first.")
    entry = known[name]
    if is_missing(pictures):
        if arm is None:
            raise UserError(f"{pictures} is not there: name the arm with --arm to take pictures.")
        joints: dict[str, list[float]] = {}

        def keep(file: str) -> None:
            joints[file] = _read_joints(arm, driven).tolist()
            write_joints(pictures, joints)

        _take(entry.source(name), pictures, board, lambda prompt: _guided(arm, driven, prompt), keep)
    shots: list[Shot] = []
    at = read_joints(pictures, driven.dof)
    for path in picture_files(pictures):
        grey = read_grey(path)
        if grey.shape[::-1] != entry.size_px:
            raise UserError(f"{path} has another size than the pictures that {name} was calibrated with.")
        view = board.find(grey)
        if view is not None and path.name in at:
            tool = driven.chain.forward(at[path.name])
            shots.append(Shot(path.name, frame(tool.rotation, tool.position), view))
    found = calibrate_hand_eye(shots, entry.lens, mount)
    write_cameras(cameras, known | {name: entry.at(found, mount)})
    figures = {
        "poses": len(shots),
        "residual_mm": found.residual_mm,
        "residual_deg": found.residual_deg,
        "position_sd_mm": 1000 * found.position_sd_m,
        "orientation_sd_deg": float(np.degrees(found.orientation_sd_rad)),
    }
    _tell(figures, f"Written to {cameras}.", json)
    return 0


def _board(squares: str, square_mm: float) -> "Board":
    check_installed("latentarm calibrate")
    from latentarm.surroundings.tags.board import Board

    columns, _, rows = squares.partition("x")
    if not (columns.isdecimal() and rows.isdecimal()):
        raise UserError(f"--squares {squares} is not of the form 7x5.")
    return Board(int(columns), int(rows), square_mm / 1000)


def _take(
    source: "CameraSource",
    folder: Path,
    board: "Board",
    ask: Callable[[str], str],
    keep: Callable[[str], None],
) -> None:
    """Take pictures until the person is done.

    ``ask`` says that a picture is next and returns what the person types; ``keep`` is called with the name of
    its file before that is written.
    """
    from latentarm.cameras.newest import NewestPicture, brightness_of
    from latentarm.surroundings.tags.pictures import write_grey

    closing = threading.Event()
    newest = NewestPicture(source, closing)
    number = 1
    try:
        newest.first()
        while ask(f"Picture {number}.") != "done":
            grey = brightness_of(newest.first())
            if board.find(grey) is None:
                say("Too little of the board is in the picture, or it is dark or blurred: not taken.", False)
                continue
            keep(f"{number:03}.png")
            write_grey(folder / f"{number:03}.png", grey)
            number += 1
    finally:
        closing.set()
        newest.end()


def _entered(prompt: str) -> str:
    try:
        return input(f"{prompt} Press Enter to take it, or type done: ").strip().lower()
    except EOFError as error:
        raise UserError("Pictures are taken with a person: run it in a terminal.") from error


def _guided(address: str, robot: "Robot", prompt: str) -> str:
    """Let the person move the arm, which then holds its position."""
    from latentarm.arms.catalogue import make_real_arm
    from latentarm.commands.guided_check import released
    from latentarm.control.clock import MonotonicClock

    arm = make_real_arm(address, robot, MonotonicClock().now_s)
    try:
        said = _entered(f"{prompt} {released(arm)} Tilt and twist the gripper another way than before.")
    finally:
        arm.close()
    time.sleep(LET_GO_S)
    return said


def _read_joints(address: str, robot: "Robot") -> FloatArray:
    """Joint positions (n,), rad; the arm gets no command."""
    from latentarm.arms.catalogue import make_real_arm
    from latentarm.control.clock import MonotonicClock

    arm = make_real_arm(address, robot, MonotonicClock().now_s)
    try:
        arm.watch()
        return arm.read().q
    finally:
        arm.close()


def _tell(figures: dict[str, float], last: str, json: bool) -> None:
    if json:
        print(json_format.dumps(figures, indent=2))
    for name, figure in figures.items():
        say(f"{name}: {figure:.3g}", json)
    say(last, json)
