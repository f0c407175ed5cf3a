"""Draw ``docs/figures/tags.jpg``: tags as two cameras see them, and the poses of things that they give."""

import os
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")  # before MuJoCo is imported

import cv2
import numpy as np

from latentarm.surroundings.tags.detecting import Detector
from latentarm.surroundings.tags.frames import frame, inverse
from latentarm.surroundings.tags.source import sightings
from latentarm_research.measurements.rendered_tags import FAMILY, LENS, Room, tags_on_things
from latentarm_research.measurements.tags import exact_cameras, scene, spoilt

OUT = Path(__file__).resolve().parents[1] / "docs" / "figures" / "tags.jpg"
AXIS_M = 0.08


def main() -> None:
    """Draw a scene of the measurement `tags`."""
    rng = np.random.default_rng(4)
    room, detector = Room(), Detector(FAMILY)
    room.put(scene(rng))
    pictures = [spoilt(room.picture(camera), "noise and blur", rng) for camera in range(2)]
    seen = [detector.find(picture) for picture in pictures]
    found = sightings(
        exact_cameras(room, ["testsrc"] * 2),
        {f"c{number}": tags for number, tags in enumerate(seen)},
        {tag.id: tag for tag in tags_on_things()},
        0.0,
    )
    drawn = []
    for camera, picture in enumerate(pictures):
        shown = cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR)
        for corners in seen[camera].values():
            cv2.polylines(shown, [np.round(corners).astype(np.int32)], True, (0, 200, 255), 1, cv2.LINE_AA)
        for one in found:
            at = inverse(room.cameras[camera]) @ frame(one.pose.rotation, one.pose.position)
            turn, _ = cv2.Rodrigues(at[:3, :3])
            cv2.drawFrameAxes(shown, LENS.matrix, LENS.distortion, turn, at[:3, 3], AXIS_M, 2)
            pixel, _ = cv2.projectPoints(at[:3, 3], np.zeros(3), np.zeros(3), LENS.matrix, LENS.distortion)
            said = f"{one.name} +- {1000 * one.position_sd_m:.1f} mm"
            where = (int(pixel.ravel()[0]) - 60, int(pixel.ravel()[1]) + 28)
            cv2.putText(shown, said, where, cv2.FONT_HERSHEY_SIMPLEX, 0.5, (255, 255, 255), 1, cv2.LINE_AA)
        drawn.append(shown)
    cv2.imwrite(str(OUT), np.hstack(drawn), [cv2.IMWRITE_JPEG_QUALITY, 85])


if __name__ == "__main__":
    main()
