"""Sources of where things are for simulated drives: faithful, faulty, or tags in rendered pictures."""

from collections import deque
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Final, final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.scene.scene import Scene
from latentarm.surroundings.contract import Sighting
from latentarm.surroundings.surroundings import Surroundings
from latentarm.surroundings.tags.detecting import Detector
from latentarm.surroundings.tags.files import CameraEntry, TagEntry
from latentarm.surroundings.tags.frames import frame, inverse
from latentarm.surroundings.tags.source import sightings
from latentarm.tasks.eating.marshmallows import NAMES
from latentarm.tasks.scene_task import Beginning
from latentarm.tasks.serving.counter import TOP_M
from latentarm_research.measurements.rendered_tags import FAMILY, PARTS, Room, tags_on_things
from latentarm_research.measurements.tags import exact_cameras, spoilt

TRUE, TOUCH, TAGS, SEEN, SILENT, JUMPS, SWAPS = SOURCES = (
    "true-poses",
    "touch",
    "tags",
    "detector",
    "detector-silent-for-2-s",
    "detector-jumps-by-10-cm",
    "detector-swaps-two-things",
)
EVERY_S: Final = 0.1  # between two looks of a detector, s
CAMERAS_EVERY_S: Final = 0.3  # as beside a busy loop, see the measurement `tags`
AGE_TICKS: Final = 6  # of what is seen
SD_M: Final = 0.002  # of the detector's errors
SD_RAD: Final = 0.02
HAND_SD_M: Final = 0.008  # how far beside a thing's middle a person brings the tool
FINER: Final = 2  # of pictures, see `Room`: rendering takes most of the time of a drive
FAULT_S: Final = (3.0, 6.0)  # when a fault begins
SILENT_S: Final = 2.0
JUMP_M: Final = 0.1


def touched(about: Surroundings, begun: Beginning, rng: np.random.Generator) -> None:
    """Show each thing with the tool, nearly over its middle."""
    for name in begun.objects:
        beside = np.append(rng.normal(0.0, HAND_SD_M, 2), 0.1)
        tool = Pose(begun.scene.thing(name).pose.position + beside, np.eye(3))
        about.update(tool, None, 0.0)
        about.touch(name, "place", 0.0)


@final
class Detections:
    """The sightings of one source in one drive; a fault stays but for a silence."""

    def __init__(self, source: str, begun: Beginning, rng: np.random.Generator) -> None:
        self._source = source
        self._names = begun.objects
        self._rng = rng
        self._fault_s = rng.uniform(*FAULT_S)
        self._wrong = begun.steps[-1].thing
        bearing = rng.uniform(-np.pi, np.pi)
        self._shift = JUMP_M * np.array([np.cos(bearing), np.sin(bearing), 0.0])
        self._past: deque[Mapping[str, Pose]] = deque(maxlen=AGE_TICKS + 1)
        self._due_s = 0.0
        self._cameras = TagCameras(begun.scene, rng) if source == TAGS else None

    def look(self, now_s: float, poses: Mapping[str, Pose], tool: Pose) -> list[Sighting]:
        """New ones, taken `AGE_TICKS` ago; to be called every tick. Their time is left at zero."""
        self._past.append({**poses, "arm": tool})
        silent = self._source == SILENT and 0.0 <= now_s - self._fault_s < SILENT_S
        if self._source in (TRUE, TOUCH) or silent or now_s < self._due_s or len(self._past) <= AGE_TICKS:
            return []
        self._due_s = now_s + (EVERY_S if self._cameras is None else CAMERAS_EVERY_S)
        if self._cameras is not None:
            return self._cameras.look(self._past[0])
        return [self._detect(name, self._past[0], faulty=now_s >= self._fault_s) for name in self._names]

    def _detect(self, name: str, poses: Mapping[str, Pose], *, faulty: bool) -> Sighting:
        other = next(one for one in self._names if one != self._wrong)
        swapped = {self._wrong: other, other: self._wrong} if faulty and self._source == SWAPS else {}
        pose = poses[swapped.get(name, name)]
        position = pose.position + self._rng.normal(0.0, SD_M, 3)
        if faulty and self._source == JUMPS and name == self._wrong:
            position = position + self._shift
        turn = Rotation.from_rotvec(self._rng.normal(0.0, SD_RAD, 3)).as_matrix()
        return Sighting(name, Pose(position, turn @ pose.rotation), 0.0, SD_M, SD_RAD)


@final
class TagCameras:
    """Two cameras that see tags, with noise and blur, and the hand in between.

    A cup and a bowl have tags of their own. The plate has twelve on its tray, and where its marshmallows lie
    is known when a drive begins.
    """

    def __init__(self, scene: Scene, rng: np.random.Generator) -> None:
        self._rng = rng
        self._plate = "plate" in scene.names
        self._up = np.array([0.0, 0.0, 0.0 if self._plate else TOP_M])
        tags = plate_tags() if self._plate else tags_on_things()
        if self._plate:
            fixed = _matrix(scene.thing("plate").pose)
            tags = [_seen_from(tag, fixed, scene, NAMES[tag.id % len(NAMES)]) for tag in tags]
        self._tags = {tag.id: tag for tag in tags if tag.thing in scene.names}

    def look(self, poses: Mapping[str, Pose]) -> list[Sighting]:
        """The things whose tags agree on a pose."""
        room, cameras, detector = _room(plate=self._plate)
        shown = {name: _matrix(pose, -self._up) for name, pose in poses.items() if name in room.names}
        # The rod stands for the hand, from some way behind its fingers or its fork.
        shown["arm"] = shown["arm"] @ frame(np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, -0.08]))
        room.put(shown)
        pictures = [spoilt(room.picture(camera), "noise and blur", self._rng) for camera in range(2)]
        seen = {f"c{number}": detector.find(picture) for number, picture in enumerate(pictures)}
        found = sightings(cameras, seen, self._tags, 0.0)
        return [replace(one, pose=Pose(one.pose.position + self._up, one.pose.rotation)) for one in found]


def plate_tags() -> list[TagEntry]:
    """Twelve tags on a ring of the plate's tray."""
    turns = [Rotation.from_euler("z", 30 * k, degrees=True) for k in range(12)]
    return [
        TagEntry(
            id=k,
            thing="plate",
            size_m=0.04,
            position_m=turn.apply([0.14, 0.0, 0.0]),
            quaternion_wxyz=turn.as_quat(scalar_first=True),
            most_tilt_deg=45.0,
        )
        for k, turn in enumerate(turns)
    ]


@cache
def _room(*, plate: bool) -> tuple[Room, dict[str, CameraEntry], Detector]:
    parts = {"plate": PARTS["bowl"][:1], "arm": PARTS["arm"]}
    room = Room(parts, plate_tags(), FINER) if plate else Room(finer=FINER)
    return room, exact_cameras(room, ["testsrc"] * 2), Detector(FAMILY)


def _seen_from(tag: TagEntry, plate: FloatArray, scene: Scene, thing: str) -> TagEntry:
    """A tag of the plate as one of what lies on it."""
    at = inverse(_matrix(scene.thing(thing).pose)) @ plate @ tag.pose
    turn = Rotation.from_matrix(at[:3, :3]).as_quat(scalar_first=True)
    placed = {"thing": thing, "position_m": tuple(at[:3, 3]), "quaternion_wxyz": tuple(turn)}
    return tag.model_copy(update=placed)


def _matrix(pose: Pose, shift: FloatArray | float = 0.0) -> FloatArray:
    return frame(pose.rotation, pose.position + shift)
