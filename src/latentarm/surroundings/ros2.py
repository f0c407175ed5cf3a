"""The source ``ros2``: poses that ROS publishes, over rosbridge.

``ros2:HOST[:PORT]?base=FRAME&NAME=TOPIC...`` takes the pose of a thing from a topic of PoseStamped,
``NAME=tf:FRAME`` from ``/tf``, and ``detections=TOPIC`` things of a Detection3DArray by their class.
"""

import math
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Final, final
from urllib.parse import parse_qsl, urlsplit

import numpy as np

from latentarm.arms.ros2.link import Link, check_installed
from latentarm.arms.ros2.options import PORT
from latentarm.arms.ros2.transforms import MOST_FRAMES, TOPICS, frame_name, placed, pose_of, transforms_in
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, Pose
from latentarm.core.untrusted.terminal import one_line
from latentarm.surroundings.contract import FARTHEST_M, LEAST_SD_M, LEAST_SD_RAD, Newest, Sighting, Source

OLDEST_S: Final = 5.0  # a stamp that is older, or lies ahead by `AHEAD_S`, is from another clock
AHEAD_S: Final = 0.05
_OWN: Final = {"base": "base_link", "detections": "", "sd_m": "0.01", "sd_rad": "0.1"}  # options, not things
_FORM: Final = "write ros2:HOST:PORT?base=FRAME&bowl=TOPIC&cup=tf:FRAME"


@final
class Ros2Source(Source):
    """Hears poses; roslibpy's thread writes.

    Raises UserError where ``rest`` is malformed or nothing answers there.
    """

    hold_s = 2.0

    def __init__(self, rest: str, names: Sequence[str]) -> None:
        host, port, given = _parsed(rest)
        self._base = frame_name(given["base"])
        self._usual_sd = tuple(_figure(key, given[key]) for key in ("sd_m", "sd_rad"))
        self._names = frozenset(names)
        self._lock = threading.Lock()
        self._newest = Newest()
        self._frames: dict[str, tuple[str, FloatArray]] = {}
        self._said: set[str] = set()
        things = {name: topic for name, topic in given.items() if name not in _OWN}
        unknown = sorted(set(things) - self._names)
        if unknown:
            raise UserError(
                f"--objects ros2 names {unknown[0]}, and the model looks at {', '.join(names)}: {_FORM}."
            )
        self._by_frame = {
            frame_name(topic.removeprefix("tf:")): name
            for name, topic in things.items()
            if topic.startswith("tf:")
        }
        self._link = Link(host, port)
        for topic, kind in TOPICS.items():
            self._listen(topic, kind, self._transforms)
        for name, topic in things.items():
            if not topic.startswith("tf:"):
                self._listen(topic, "geometry_msgs/msg/PoseStamped", partial(self._posed, name))
        if given["detections"]:
            self._listen(given["detections"], "vision_msgs/msg/Detection3DArray", self._detected)

    def read(self) -> Sequence[Sighting]:
        """The newest sighting of each thing since the last call; UserError once the connection is lost."""
        if not self._link.connected:
            raise UserError("the connection to rosbridge is lost")
        return self._newest.take()

    def close(self) -> None:
        self._link.close()

    def _listen(self, topic: str, kind: str, hear: Callable[[Mapping[str, Any]], None]) -> None:
        def heard(message: Mapping[str, Any]) -> None:
            try:
                hear(message)
            except (KeyError, TypeError, ValueError, IndexError, UserError) as error:
                self._say_once(f"a message of {topic} cannot be used ({error!r})")

        self._link.subscribe(topic, kind, heard)

    def _posed(self, name: str, message: Mapping[str, Any]) -> None:
        pose = message["pose"]
        self._see(name, message["header"], pose_of(pose["position"], pose["orientation"]), self._usual_sd)

    def _detected(self, message: Mapping[str, Any]) -> None:
        for detection in message["detections"]:
            # The likeliest class of each.
            result = max(detection["results"], key=lambda one: float(one["hypothesis"]["score"]))
            name = str(result["hypothesis"]["class_id"])
            if name in self._names:
                pose = result["pose"]["pose"]
                header = detection["header"] if detection["header"]["frame_id"] else message["header"]
                sd = _sd_of(result["pose"].get("covariance"), self._usual_sd)
                self._see(name, header, pose_of(pose["position"], pose["orientation"]), sd)

    def _transforms(self, message: Mapping[str, Any]) -> None:
        heard = transforms_in(message)
        with self._lock:
            if len(self._frames) + len(heard) <= MOST_FRAMES:
                self._frames |= heard
        for one in message["transforms"]:
            name = self._by_frame.get(frame_name(one["child_frame_id"]))
            if name is not None:
                self._see(name, one["header"], heard[frame_name(one["child_frame_id"])][1], self._usual_sd)

    def _see(self, name: str, header: Mapping[str, Any], pose: FloatArray, sd: tuple[float, ...]) -> None:
        where = frame_name(header["frame_id"])
        with self._lock:
            of_frame = np.eye(4) if where == self._base else placed(where, self._base, self._frames)
        if of_frame is None:
            self._say_once(
                f"the pose of {name} is in the frame {where}, which /tf does not join to {self._base}:"
                " publish that transform, or name the arm's base frame with base=FRAME"
            )
            return
        at = of_frame @ pose
        stamp_s = int(header["stamp"]["sec"]) + 1e-9 * int(header["stamp"]["nanosec"])
        seen = Sighting(
            name,
            Pose(at[:3, 3], at[:3, :3]),
            time.monotonic() - self._age_s(stamp_s),
            min(max(sd[0], LEAST_SD_M), FARTHEST_M),
            min(max(sd[1], LEAST_SD_RAD), math.pi),
        )
        self._newest.put([seen])

    def _age_s(self, stamp_s: float) -> float:
        """The age of what is stamped, s; none is known where ROS has another clock."""
        age_s = time.time() - stamp_s
        if -AHEAD_S <= age_s <= OLDEST_S:
            return max(age_s, 0.0)
        self._say_once(
            "the clock of ROS is not that of this computer, or its poses are old: they count as new when they"
            " arrive; set both clocks by NTP"
        )
        return 0.0

    def _say_once(self, sentence: str) -> None:
        if sentence not in self._said and len(self._said) < 20:
            self._said.add(sentence)
            sys.stderr.write(f"latentarm: --objects ros2: {one_line(sentence)}.\n")


def open_ros2(rest: str, names: Sequence[str]) -> Ros2Source:
    """Open the source; ``rest`` is ``HOST[:PORT]?...``, see above."""
    check_installed("--objects ros2")
    return Ros2Source(rest, names)


def _parsed(rest: str) -> tuple[str, int, dict[str, str]]:
    try:
        parts = urlsplit(f"ros2://{rest}")
        options = parse_qsl(parts.query, strict_parsing=True)
        host, port = parts.hostname, parts.port or PORT
    except ValueError as error:
        raise UserError(f"--objects ros2:{rest} cannot be read ({error}): {_FORM}.") from error
    if not host or len(dict(options)) < len(options):
        raise UserError(f"--objects ros2:{rest} names no host, or a thing twice: {_FORM}.")
    return host, port, _OWN | dict(options)


def _figure(key: str, text: str) -> float:
    try:
        figure = float(text)
    except ValueError:
        figure = math.nan
    if not 0.0 < figure <= FARTHEST_M:
        raise UserError(f"--objects ros2 has {key}={text}: it must be a number above zero.")
    return figure


def _sd_of(covariance: object, usual: tuple[float, ...]) -> tuple[float, ...]:
    """SDs of position, m, and turn, rad, along the worst axes; the usual ones where it is all zeros."""
    if not isinstance(covariance, list) or len(covariance) != 36:
        return usual
    figures = np.array(covariance, np.float64).reshape(6, 6)
    worst = [float(np.linalg.eigvalsh(figures[k : k + 3, k : k + 3])[-1]) for k in (0, 3)]
    return tuple(math.sqrt(one) if one > 0.0 else other for one, other in zip(worst, usual, strict=True))
