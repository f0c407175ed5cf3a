"""Poses of things by tags against the truth in rendered pictures, beside a loop, and calibration.

MuJoCo renders; set ``MUJOCO_GL=egl`` where there is no screen.
"""

import os
import tempfile
import time
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Final

import av
import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.errors import UserError
from latentarm.core.punctuality import ask_for_priority
from latentarm.core.types import FloatArray, Row
from latentarm.surroundings.process import Inbox, SourceProcess
from latentarm.surroundings.tags.detecting import Detector
from latentarm.surroundings.tags.files import CameraEntry, write_cameras
from latentarm.surroundings.tags.frames import frame, inverse, shifted
from latentarm.surroundings.tags.hand_eye import HandEye, Shot, calibrate_hand_eye
from latentarm.surroundings.tags.source import sightings
from latentarm_research.measurements.catalogue import Tags
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.measurements.rendered_tags import (
    BOARD,
    FAMILY,
    HIGH,
    LENS,
    WIDE,
    Room,
    tags_on_things,
)

PERIOD_S: Final = 0.01
WORK_S: Final = 0.001  # of each period, as a step of the arm takes
PLACES: Final = {"bowl": (0.45, 0.12), "cup": (0.4, -0.2), "spoon": (0.65, -0.05)}  # m, on the table
CONDITIONS: Final = ("clear", "noise and blur", "dim from one side", "hidden in part", "one camera")
CALIBRATIONS: Final[Mapping[str, Mapping[str, Any]]] = {
    "12 poses": {},
    "arm errs by 0.5 mm and 0.03°": {"arm": 0.0005},
    "6 poses": {"poses": 6},
    "turned alike": {"turn": 0.08},
    "board slips by 30 mm": {"slip": 0.03},
    "squares stated 5 % too small": {"scale": 0.95},
}


def measure(options: Tags, work: Work) -> Outcome:
    """Errors in each condition, rates and ages beside a loop, and what calibrations find or refuse."""
    rng, room = np.random.default_rng(work.seed), Room()
    rows = [row for name in CONDITIONS for row in _errors(room, name, options.scenes, rng)]
    with tempfile.TemporaryDirectory() as folder:
        source = f"tags:{_written(Path(folder), room, rng)}"
        for name, texts in (("the loop alone", []), ("with tags", [source])):
            rows += line("tags", name, 1, _beside(texts, options.seconds), "beside a loop at 100 Hz")
    refused: list[str] = []
    for name, kind in CALIBRATIONS.items():
        try:
            figures = _calibrated(room, rng, **kind)
            rows += line("tags", name, 1, figures, "a camera placed by a board in the gripper")
        except UserError as error:
            refused.append(f"- {name}: “{error}”")
    return Outcome(rows, note="Calibrations that are refused, and what is said:\n\n" + "\n".join(refused))


def scene(rng: np.random.Generator) -> dict[str, FloatArray]:
    """Poses (4, 4) of the things, anywhere about their places and a little tilted."""
    return {
        name: frame(
            Rotation.from_rotvec([*rng.normal(0, 0.1, 2), rng.uniform(-3, 3)]).as_matrix(),
            np.array([x, y, 0.02]) + rng.uniform(-0.05, 0.05, 3) * [1, 1, 0.4],
        )
        for name, (x, y) in PLACES.items()
    }


def spoilt(picture: FloatArray, condition: str, rng: np.random.Generator) -> Any:
    """The picture (H, W) as a camera would give it in a condition, bytes."""
    if condition != "clear":
        picture = np.asarray(cv2.GaussianBlur(picture, (0, 0), rng.uniform(0.5, 1.3)), np.float64)
    if condition == "dim from one side":
        picture = picture * np.linspace(0.15, 0.6, WIDE)
    noise = 0.0 if condition == "clear" else 4.0
    return np.clip(picture + rng.normal(0, noise, picture.shape), 0, 255).astype(np.uint8)


def exact_cameras(room: Room, addresses: list[str]) -> dict[str, CameraEntry]:
    """The room's cameras by name, calibrated without error."""
    lens = CameraEntry.of_lens("testsrc", LENS)
    exact = [lens.at(HandEye(pose, 0.0, 0.0, 0.0, 0.0), "base") for pose in room.cameras]
    return {
        f"c{number}": entry.model_copy(update={"address": addresses[number]})
        for number, entry in enumerate(exact)
    }


def _errors(room: Room, condition: str, scenes: int, rng: np.random.Generator) -> list[Row]:
    """Rows for each thing in a condition."""
    detector, tags = Detector(FAMILY), {tag.id: tag for tag in tags_on_things()}
    cameras = exact_cameras(room, ["testsrc"] * 2)
    off: dict[str, list[tuple[float, float, bool]]] = {name: [] for name in PLACES}
    spent_s = 0.0
    for _ in range(scenes):
        true = scene(rng)
        arm = frame(Rotation.from_rotvec(rng.normal(0, 0.4, 3)).as_matrix(), np.array([0.6, 0.0, 0.0]))
        arm[:2, 3] += rng.uniform(-0.2, 0.2, 2)
        room.put(true | ({"arm": arm} if condition == "hidden in part" else {}))
        used = range(1 if condition == "one camera" else 2)
        pictures = [spoilt(room.picture(camera), condition, rng) for camera in used]
        began_s = time.process_time()
        found = sightings(cameras, {f"c{k}": detector.find(pictures[k]) for k in used}, tags, 0.0)
        spent_s += time.process_time() - began_s
        for one in found:
            away = one.pose.position - true[one.name][:3, 3]
            turn = Rotation.from_matrix(one.pose.rotation @ true[one.name][:3, :3].T).magnitude()
            stated = np.abs(away).max() <= 2.0 * one.position_sd_m
            off[one.name].append(
                (1000.0 * float(np.linalg.norm(away)), float(np.degrees(turn)), bool(stated))
            )
    rows: list[Row] = []
    for name, all_off in off.items():
        figures: dict[str, float] = {"seen_percent": 100.0 * len(all_off) / scenes}
        mm, deg, stated = np.array(all_off or [(0.0, 0.0, 0.0)]).T
        figures |= (
            {}
            if not all_off
            else {
                "median_mm": np.median(mm),
                "p95_mm": np.quantile(mm, 0.95),
                "median_deg": np.median(deg),
                "p95_deg": np.quantile(deg, 0.95),
                "within_2_sd_percent": 100.0 * stated.mean(),
                "processor_ms": 1000.0 * spent_s / scenes,  # of all things together
            }
        )
        rows += line("tags", condition, scenes, figures, name)
    return rows


def _written(folder: Path, room: Room, rng: np.random.Generator) -> Path:
    """A tags file with cameras that are videos of one scene."""
    room.put(scene(rng))
    addresses = [str(folder / f"{camera}.mp4") for camera in range(2)]
    for camera, address in enumerate(addresses):
        clear = room.picture(camera)
        with av.open(address, "w") as container:
            stream = container.add_stream("libx264", rate=30, options={"crf": "15"})
            stream.width, stream.height, stream.pix_fmt = WIDE, HIGH, "yuv420p"
            for _ in range(60):
                shown = spoilt(clear, "noise and blur", rng)
                container.mux(stream.encode(av.VideoFrame.from_ndarray(shown, format="gray")))
            container.mux(stream.encode(None))
    write_cameras(folder / "cameras.toml", exact_cameras(room, addresses))
    lines = ['cameras = "cameras.toml"', f'family = "{FAMILY}"']
    for tag in tags_on_things():
        lines += ["[[tags]]", *(f"{key} = {value!r}" for key, value in tag.model_dump(mode="json").items())]
    (folder / "tags.toml").write_text("\n".join(lines))
    return folder / "tags.toml"


def _beside(texts: list[str], seconds: float) -> dict[str, float]:
    """A loop with the arm's priority and a source's process at work, and what they cost."""
    before = os.times()
    process = SourceProcess(texts, tuple(PLACES))
    with ThreadPoolExecutor(1) as thread:  # the priority is that of a thread
        late, ages_s = thread.submit(_loop, Inbox(process.sightings), seconds).result()
    process.end()
    after = os.times()
    spent_s = after.children_user + after.children_system - before.children_user - before.children_system
    figures = {"late_ticks_percent": 100.0 * late, "processor_of_one_core_percent": 100.0 * spent_s / seconds}
    if not ages_s:
        return figures
    return {
        "sightings_of_each_per_s": len(ages_s) / len(PLACES) / seconds,
        "age_median_ms": 1000.0 * float(np.median(ages_s)),
        "age_p95_ms": 1000.0 * float(np.quantile(ages_s, 0.95)),
        **figures,
    }


def _loop(inbox: Inbox, seconds: float) -> tuple[float, list[float]]:
    """Works 1 ms of every 10; the share of late ticks, and the age of each sighting when it is read, s."""
    ask_for_priority()
    late, ages_s, ticks, began_s = 0, list[float](), round(seconds / PERIOD_S), time.monotonic()
    for tick in range(1, ticks + 1):
        due_s = began_s + tick * PERIOD_S
        time.sleep(max(0.0, due_s - time.monotonic()))
        ages_s += [time.monotonic() - seen.time_s for seen, _, _ in inbox.read(time.monotonic())]
        while time.monotonic() < due_s + WORK_S:
            pass
        late += time.monotonic() > due_s + PERIOD_S
    return late / ticks, ages_s


def _calibrated(
    room: Room,
    rng: np.random.Generator,
    poses: int = 12,
    turn: float = 0.6,  # of the board against the camera, at most, rad
    arm: float = 0.0,  # SD of the arm's stated pose, m and rad
    slip: float = 0.0,  # of the board at the sixth pose, m
    scale: float = 1.0,  # of the board as stated
) -> dict[str, float]:
    camera = room.cameras[0]
    held = frame(np.eye(3), np.array([-0.1, -0.07, 0.1]))  # the board in the gripper
    middle = np.array([BOARD.columns, BOARD.rows, 0.0]) * BOARD.square_m / 2.0
    shots: list[Shot] = []
    while len(shots) < poses:
        facing = Rotation.from_euler("xyz", rng.uniform(-turn, turn, 3)).as_matrix()
        seen = frame(facing, np.array([0.0, 0.0, rng.uniform(0.35, 0.55)]) - facing @ middle)
        slipped = seen @ frame(np.eye(3), np.array([slip * (len(shots) == 5), 0.0, 0.0]))
        room.put({"board": camera @ slipped})
        view = BOARD.find(spoilt(room.picture(0), "noise and blur", rng))
        if view is not None:
            tool = shifted(camera @ seen @ inverse(held), rng.normal(0, arm, 6))
            shots.append(Shot(f"{len(shots) + 1:03}.png", tool, type(view)(scale * view.points, view.pixels)))
    found = calibrate_hand_eye(shots, LENS, "base")
    turned = Rotation.from_matrix(found.camera[:3, :3] @ camera[:3, :3].T).magnitude()
    return {
        "residual_mm": found.residual_mm,
        "residual_deg": found.residual_deg,
        "camera_off_mm": 1000.0 * float(np.linalg.norm(found.camera[:3, 3] - camera[:3, 3])),
        "camera_off_deg": float(np.degrees(turned)),
        "stated_sd_mm": 1000.0 * found.position_sd_m,
    }
