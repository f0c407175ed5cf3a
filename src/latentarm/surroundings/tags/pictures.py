"""Pictures of a board in a folder, and the joints of the arm at each."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from latentarm.core.errors import UserError
from latentarm.core.files import write_text, written_whole
from latentarm.core.types import FloatArray
from latentarm.core.untrusted.documents import read_object
from latentarm.core.untrusted.opening import read_bytes

JOINTS: Final = "joints.json"  # by the picture's file name: positions of the arm's joints, rad
MOST_PICTURES: Final = 200
_MOST_BYTES: Final = 1 << 25
_MOST_PIXELS: Final = 8192 * 8192


def picture_files(folder: Path) -> list[Path]:
    """The pictures of a folder, by name."""
    found = sorted(folder.glob("*.png"))
    if not found:
        raise UserError(f"{folder} has no pictures: they must be PNG files.")
    if len(found) > MOST_PICTURES:
        raise UserError(f"{folder} has {len(found)} pictures, and {MOST_PICTURES} are the most.")
    return found


def read_grey(path: Path) -> NDArray[np.uint8]:
    """A PNG file in grey, (H, W)."""
    content = read_bytes(path, _MOST_BYTES)
    width, height = int.from_bytes(content[16:20]), int.from_bytes(content[20:24])
    if not content.startswith(b"\x89PNG") or not 0 < width * height <= _MOST_PIXELS:
        raise UserError(f"{path} is not a picture in PNG of a usual size.")
    grey = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_GRAYSCALE)
    if grey is None:
        raise UserError(f"{path} is damaged: take the picture again.")
    return np.asarray(grey, np.uint8)


def write_grey(path: Path, grey: NDArray[np.uint8]) -> None:
    """Write a picture as PNG."""
    with written_whole(path) as part:
        part.write_bytes(cv2.imencode(".png", grey)[1].tobytes())


def read_joints(folder: Path, dof: int) -> dict[str, FloatArray]:
    """Joint positions (n,), rad, by the name of the picture."""
    path = folder / JOINTS
    joints: dict[str, FloatArray] = {}
    for name, figures in read_object(path).items():
        try:
            joints[name] = np.array(figures, np.float64)
        except (TypeError, ValueError):
            joints[name] = np.zeros(0)
        if joints[name].shape != (dof,):
            raise UserError(f"{path}: {name} must have {dof} positions of joints, in rad.")
    return joints


def write_joints(folder: Path, joints: Mapping[str, Sequence[float]]) -> None:
    """Write joint positions, rad, by the name of the picture."""
    write_text(folder / JOINTS, json.dumps(dict(joints), indent=1))
