"""The source ``tags``: it looks for tags in the pictures of calibrated cameras, in threads of its own."""

import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, final

import cv2
import numpy as np

from latentarm.cameras.newest import NewestPicture, brightness_of
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, Pose
from latentarm.surroundings.contract import LEAST_SD_M, LEAST_SD_RAD, Newest, Sighting, Source
from latentarm.surroundings.tags.detecting import Detector
from latentarm.surroundings.tags.files import CameraEntry, TagEntry, read_cameras, read_tags
from latentarm.surroundings.tags.solving import SeenTag, solve

TOGETHER_S: Final = 0.05  # pictures of different cameras that count as one moment, s
_END_WITHIN_S: Final = 1.0
EVERY_S: Final = 0.06  # shortest time between two looks, s: a camera gives more than is needed


@final
class TagSource(Source):
    """Sees things by their tags.

    Raises UserError where the files cannot be used, or a camera gives no picture that they fit.
    """

    def __init__(self, path: Path, names: Sequence[str]) -> None:
        stated = read_tags(path)
        self.hold_s = stated.hold_s
        self._tags = {tag.id: tag for tag in stated.tags if tag.thing in names}
        if not self._tags:
            known = ", ".join(sorted({tag.thing for tag in stated.tags}))
            raise UserError(f"{path} has tags on {known}, and the model looks at {', '.join(names)}.")
        placed = read_cameras(path.parent / stated.cameras)
        for name, entry in placed.items():
            if entry.mount != "base":
                why = (
                    "is on the wrist, and only fixed ones can be used" if entry.mount else "is not placed yet"
                )
                raise UserError(
                    f"{stated.cameras}: the camera {name} {why}: fix it in the room and run latentarm"
                    f" calibrate hand-eye {name}, or leave it out."
                )
        self._detector = Detector(stated.family)
        self._newest = Newest()
        self._closing = threading.Event()
        self._placed = placed
        self._cameras = {
            name: NewestPicture(entry.source(name), self._closing) for name, entry in placed.items()
        }
        self._thread = threading.Thread(target=self._work, name="tags", daemon=True)
        try:
            for name, camera in self._cameras.items():
                high, wide = brightness_of(camera.first()).shape
                if (wide, high) != placed[name].size_px:
                    raise UserError(
                        f"Camera {name} gives pictures of {wide} by {high}, and was calibrated with others:"
                        f" run latentarm calibrate intrinsics {name}=ADDRESS again."
                    )
        except UserError:
            self.close()
            raise
        cv2.setNumThreads(1)  # the other cores are the arm's
        self._thread.start()

    def read(self) -> Sequence[Sighting]:
        return self._newest.take()

    def close(self) -> None:
        self._closing.set()
        for camera in self._cameras.values():
            camera.end()
        if self._thread.is_alive():
            self._thread.join(_END_WITHIN_S)

    def _work(self) -> None:
        seen: dict[str, tuple[float, Mapping[int, FloatArray]]] = {}
        while not self._closing.wait(EVERY_S):
            fresh = False
            for name, camera in self._cameras.items():
                picture = camera.picture
                if picture is not None and (name not in seen or picture.captured_s > seen[name][0]):
                    grey = brightness_of(picture)
                    # A camera on the network may change the size of its pictures at any time.
                    fits = grey.shape[::-1] == self._placed[name].size_px
                    seen[name] = (picture.captured_s, self._detector.find(grey) if fits else {})
                    fresh = True
            if not fresh:
                continue
            newest_s = max(taken_s for taken_s, _ in seen.values())
            together = {name: one for name, one in seen.items() if newest_s - one[0] <= TOGETHER_S}
            oldest_s = min(taken_s for taken_s, _ in together.values())
            tags = {name: found for name, (_, found) in together.items()}
            self._newest.put(sightings(self._placed, tags, self._tags, oldest_s))


def sightings(
    cameras: Mapping[str, CameraEntry],
    seen: Mapping[str, Mapping[int, FloatArray]],  # corners (4, 2), px, by camera and number of the tag
    tags: Mapping[int, TagEntry],
    time_s: float,  # when the oldest of the pictures was taken
) -> list[Sighting]:
    """The things of which the tags agree on a pose."""
    found: list[Sighting] = []
    for thing in dict.fromkeys(tag.thing for tag in tags.values()):
        mine = [
            (cameras[camera], corners, tags[number])
            for camera, numbers in seen.items()
            for number, corners in numbers.items()
            if number in tags and tags[number].thing == thing
        ]
        solved = solve(
            [SeenTag(corners, by.lens, by.pose, tag.size_m, tag.pose) for by, corners, tag in mine],
            np.radians(min((tag.most_tilt_deg for _, _, tag in mine), default=180.0)),
        )
        if solved is None:
            continue
        position = solved.pose[:3, 3]
        # Where the cameras are is not known exactly either, which moves all that they see.
        away = [(by, float(np.linalg.norm(position - by.pose[:3, 3]))) for by, _, _ in mine]
        shift = max(np.hypot(by.position_sd_m, by.orientation_sd_rad * far_m) for by, far_m in away)
        turn = max(by.orientation_sd_rad for by, _ in away)
        found.append(
            Sighting(
                thing,
                Pose(position, solved.pose[:3, :3]),
                time_s,
                max(LEAST_SD_M, float(np.hypot(solved.position_sd_m, shift))),
                min(np.pi, max(LEAST_SD_RAD, float(np.hypot(solved.orientation_sd_rad, turn)))),
            )
        )
    return found
