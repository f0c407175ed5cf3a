"""Tracks several things by sightings of all sources, by touch, and with the tool that carries them."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal, final

import numpy as np

from latentarm.core.types import NO_OBJECTS, FloatArray, Pose
from latentarm.robots.kinematics.pose_rows import object_rows
from latentarm.robots.kinematics.rotations import angle_between
from latentarm.surroundings.contract import Sighting
from latentarm.surroundings.pose_estimate import PoseEstimate

Seen = Literal["unseen", "seen", "doubted", "carried", "lost"]
"""*doubted*: sightings elsewhere are not believed yet. *carried*: it moves with the tool. *lost*: its last
sighting is too old to count."""

CONFIRMATIONS: Final = 3  # later sightings that agree with one that was not believed
CONFIRMED_S: Final = 1.5  # and the time that they must span where the thing is believed to be elsewhere, s
FOUND_S: Final = 0.3  # the same where nothing counts any more
PAUSE_S: Final = 1.0  # after a longer pause between sightings, confirming begins anew
AHEAD_S: Final = 0.05  # a sighting from farther in the future has a wrong time

JUMP_M: Final = 0.02
JUMP_RAD: Final = 0.2
"""A pose that changes by more at once is a jump: a held stick would mean something else."""

RELEASED_SD_M: Final = 0.01
RELEASED_SD_RAD: Final = 0.1  # a thing may slip as it is let go


@final
@dataclass(frozen=True, eq=False)
class Whereabouts:
    """Tracking state and pose of a thing."""

    seen: Seen
    pose: Pose | None = None  # where it is, or was last; None where it has not been seen
    age_s: float = 0.0  # of the newest sighting; 0 while it is carried
    source: str = ""  # of that sighting

    @property
    def known(self) -> bool:
        """Whether the pose may be used."""
        return self.seen in ("seen", "doubted", "carried")


@final
@dataclass(eq=False)
class _Track:
    """One thing."""

    estimate: PoseEstimate | None = None
    # sightings elsewhere, as a estimate of their own, since when, and how many have confirmed the first
    other: PoseEstimate | None = None
    other_since_s: float = 0.0
    confirmed: int = 0
    in_tool: Pose | None = None  # pose in the tool's frame while it is carried
    sensed: bool = False  # whether the gripper says that it is carried
    newest_s: dict[str, float] = field(default_factory=dict[str, float])  # of each source
    before: list[PoseEstimate | None] = field(default_factory=list[PoseEstimate | None])  # the person's words
    fed: Pose | None = None


@final
class Tracker:
    """Follows things of known names.

    A sighting that agrees with the estimate updates it (see `PoseEstimate.joined`). One farther off than its
    error and a plausible motion allow is not used until `CONFIRMATIONS` later ones agree with it over
    `CONFIRMED_S` and none with the estimate. Of sources that contradict each other the first one stays. A
    sighting nearer to another thing's place than to the thing's own is doubted too; while two things seem to
    have changed places, neither is followed before both are lost, or a person says so.

    A thing counts for as long as its newest sighting holds, and is then lost; where a lost or a new thing is
    seen several times, it is found. A thing in the gripper moves with the tool, whatever sources say; food
    on a fork too, until sightings elsewhere are confirmed.

    All times are on one clock, s.
    """

    def __init__(self, names: Iterable[str]) -> None:
        self._tracks = {name: _Track() for name in names}
        self._tool: Pose | None = None
        self.jumped: frozenset[str] = frozenset()
        """Things whose pose jumped between the last two calls of `update`."""

    @property
    def names(self) -> tuple[str, ...]:
        """The things."""
        return tuple(self._tracks)

    def saw(self, sighting: Sighting, source: str, hold_s: float, now_s: float) -> None:
        """Take a sighting, with its time on the tracker's clock; one of an unknown thing says nothing."""
        track = self._tracks.get(sighting.name)
        age_s = now_s - sighting.time_s
        if track is None or not -AHEAD_S <= age_s <= hold_s:
            return
        if sighting.time_s <= track.newest_s.get(source, -math.inf):
            return
        track.newest_s[source] = sighting.time_s
        if track.in_tool is not None:
            self._saw_carried(track, sighting, source, hold_s)
        elif (
            track.estimate is not None
            and track.estimate.counts(now_s)
            and track.estimate.agrees(sighting)
            and not self._elsewhere(track.estimate, sighting, now_s)
        ):
            track.estimate = track.estimate.joined(sighting, source, hold_s)
            track.other = None
        elif self._confirms(track, sighting, source, hold_s, now_s) and not self._swapped(sighting, now_s):
            track.estimate, track.other = track.other, None

    def place(self, sighting: Sighting, source: str, hold_s: float) -> None:
        """Believe a person, at once."""
        track = self._tracks[sighting.name]
        track.before.append(self._current(track, sighting.time_s))
        track.estimate = PoseEstimate.of(sighting, source, hold_s)
        track.other = track.in_tool = None

    def take_back(self, name: str) -> bool:
        """Undo the newest `place` of a thing; False where there is none."""
        track = self._tracks.get(name)
        if track is None or not track.before:
            return False
        track.estimate, track.other = track.before.pop(), None
        return True

    def carry(self, name: str, *, sensed: bool) -> None:
        """From now on a thing moves with the tool; ``sensed``: whether the gripper says so."""
        track = self._tracks[name]
        if self._tool is not None and track.estimate is not None:
            track.in_tool = within(self._tool, track.estimate.pose)
            track.sensed, track.other = sensed, None

    def let_go(self, name: str, now_s: float) -> None:
        """A thing no longer moves with the tool: it is where it was let go."""
        track = self._tracks[name]
        track.estimate, track.in_tool = self._current(track, now_s), None

    @property
    def carried(self) -> Mapping[str, bool]:
        """The things that move with the tool, each with whether the gripper says so."""
        return {name: track.sensed for name, track in self._tracks.items() if track.in_tool is not None}

    @property
    def in_tool(self) -> Mapping[str, Pose]:
        """Poses of these things in the tool's frame, as they were taken."""
        return {name: track.in_tool for name, track in self._tracks.items() if track.in_tool is not None}

    def update(self, tool: Pose | None, now_s: float) -> None:
        """Take where the tool is, once a tick; None where it is unknown, which leaves it where it was."""
        if tool is not None:
            self._tool = tool
        found: set[str] = set()
        for name, track in self._tracks.items():
            here = self.look(name, now_s)
            pose = here.pose if here.known else None
            if pose is not track.fed and here.seen != "carried" and _jumps(track.fed, pose):
                found.add(name)
            # What was lost and is found elsewhere has jumped as well.
            track.fed = pose or track.fed
        self.jumped = frozenset(found)

    def look(self, name: str, now_s: float) -> Whereabouts:
        """State and pose of one thing."""
        track = self._tracks[name]
        if track.estimate is None:
            return Whereabouts("unseen")
        source = track.estimate.source
        if track.in_tool is not None and self._tool is not None:
            return Whereabouts("carried", _placed(self._tool, track.in_tool), 0.0, source)
        age_s = max(now_s - track.estimate.time_s, 0.0)
        if not track.estimate.counts(now_s):
            return Whereabouts("lost", track.estimate.pose, age_s, source)
        doubted = track.other is not None and now_s - track.other.time_s <= PAUSE_S
        return Whereabouts("doubted" if doubted else "seen", track.estimate.pose, age_s, source)

    def unknown(self, names: Sequence[str], now_s: float) -> tuple[str, ...]:
        """The things among these without a valid pose."""
        return tuple(name for name in names if not self.look(name, now_s).known)

    def rows(self, names: Sequence[str], now_s: float) -> FloatArray:
        """Poses (K, 9) for decoders, see `Context.objects`; `NO_OBJECTS` where one is unknown."""
        found = {name: self.look(name, now_s) for name in names}
        poses = {name: one.pose for name, one in found.items() if one.known and one.pose is not None}
        return object_rows(poses, names) if len(poses) == len(names) else NO_OBJECTS

    def _saw_carried(self, track: _Track, sighting: Sighting, source: str, hold_s: float) -> None:
        now_s = sighting.time_s
        current = self._current(track, now_s)
        if track.sensed or current is None or current.agrees(sighting):
            track.other = None
        elif self._confirms(track, sighting, source, hold_s, now_s):
            track.estimate, track.other, track.in_tool = track.other, None, None

    def _current(self, track: _Track, now_s: float) -> PoseEstimate | None:
        estimate = track.estimate
        if estimate is None or track.in_tool is None or self._tool is None:
            return estimate
        sd_m = math.hypot(estimate.position_sd_m, RELEASED_SD_M)
        sd_rad = math.hypot(estimate.orientation_sd_rad, RELEASED_SD_RAD)
        return PoseEstimate(
            _placed(self._tool, track.in_tool), sd_m, sd_rad, now_s, estimate.hold_s, estimate.source
        )

    def _elsewhere(self, own: PoseEstimate, sighting: Sighting, now_s: float) -> bool:
        """Whether a sighting is nearer to where another thing is than to the thing's own place."""
        others = [
            track.estimate
            for name, track in self._tracks.items()
            if name != sighting.name and track.estimate is not None and track.estimate.counts(now_s)
        ]
        return any(other.away(sighting.pose) < own.away(sighting.pose) for other in others)

    def _confirms(self, track: _Track, sighting: Sighting, source: str, hold_s: float, now_s: float) -> bool:
        """Count a sighting that is not believed; whether there are enough of them now."""
        other = track.other
        if other is None or not other.agrees(sighting) or abs(sighting.time_s - other.time_s) > PAUSE_S:
            track.other, track.confirmed = PoseEstimate.of(sighting, source, hold_s), 0
            track.other_since_s = sighting.time_s
            return False
        track.other = other.joined(sighting, source, hold_s)
        track.confirmed += 1
        since_s, span_s = track.other_since_s, FOUND_S
        if track.estimate is not None:
            # It is lost for a while before it is found elsewhere, so that nobody goes on without knowing.
            lost = not track.estimate.counts(now_s) and track.in_tool is None
            since_s = max(since_s, track.estimate.time_s + track.estimate.hold_s) if lost else since_s
            span_s = FOUND_S if lost else CONFIRMED_S
        return track.confirmed >= CONFIRMATIONS and track.other.time_s - since_s >= span_s

    def _swapped(self, sighting: Sighting, now_s: float) -> bool:
        """Whether a thing and another one are seen at each other's place, and either still counts."""
        own = self._tracks[sighting.name]
        if own.estimate is None or own.other is None:
            return False
        for name, track in self._tracks.items():
            if name == sighting.name or track.estimate is None or track.other is None:
                continue
            there = track.estimate.away(own.other.pose) < own.estimate.away(own.other.pose)
            here = own.estimate.away(track.other.pose) < track.estimate.away(track.other.pose)
            if there and here and (own.estimate.counts(now_s) or track.estimate.counts(now_s)):
                return True
        return False


def _jumps(before: Pose | None, after: Pose | None) -> bool:
    if before is None or after is None:
        return False
    moved_m = float(np.linalg.norm(after.position - before.position))
    return moved_m > JUMP_M or float(angle_between(after.rotation, before.rotation)) > JUMP_RAD


def within(tool: Pose, pose: Pose) -> Pose:
    """A pose in the base frame, in the tool's."""
    return Pose((pose.position - tool.position) @ tool.rotation, tool.rotation.T @ pose.rotation)


def _placed(tool: Pose, inside: Pose) -> Pose:
    return Pose(tool.position + tool.rotation @ inside.position, tool.rotation @ inside.rotation)
