"""Poses of the things around an arm for pages, models and recordings, simulated or tracked."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Final, final

import numpy as np

from latentarm.arms.contract import SceneArm
from latentarm.core.types import FloatArray, Pose, StepRecord
from latentarm.robots.kinematics.pose_rows import thing_rows
from latentarm.surroundings.catalogue import SCENE
from latentarm.surroundings.held_things import HeldThings
from latentarm.surroundings.surroundings import Surroundings
from latentarm.surroundings.touch import TouchKind
from latentarm.surroundings.tracker import Whereabouts, within
from latentarm.web.protocol.notice import Notice
from latentarm.web.protocol.report import SeenThing, Things
from latentarm.web.protocol.scene import things_at

if TYPE_CHECKING:
    from latentarm.web.arm_process.drive_setup import DriveSetup

SOON_S: Final = 0.03
"""Learned motions end three periods before a thing is lost: a late tick gives no model what is too old."""

_EVERY: Final = 4  # ticks between two looks: 25 looks per second; pages interpolate


def follow(
    setup: "DriveSetup", known: Surroundings | None, sightings: Connection | None
) -> Surroundings | None:
    """The followed things of a setup: those ``known`` from before if they are the same; None for none."""
    if not (things := setup.tracked):
        return None
    if known is not None and known.tracker.names == tuple(thing.name for thing in things):
        return known
    return Surroundings(things, stand=setup.stand, sightings=sightings)


@final
class ThingPoses:
    """The things about an arm: followed, true in a simulation, or none."""

    def __init__(
        self,
        setup: "DriveSetup",
        arm: SceneArm | None,
        followed: Surroundings | None,
        now_s: Callable[[], float],
    ) -> None:
        self._scene = setup.scene
        self._arm = arm
        self._needed = setup.controller.objects
        self._chain = setup.task.robot.chain
        self._followed = followed
        self._now_s = now_s
        self._sources = setup.sources
        self._recorded: tuple[str, ...] = ()
        self._newest: dict[str, tuple[Pose, int, float]] = {}
        self._carried: Mapping[str, Pose] = {}  # by the newest look, in the tool's frame
        known = () if self._scene is None or not setup.stand else self._scene.things
        self.held = HeldThings([thing for thing in known if not thing.fixed], setup.spec.gripped)

    def surroundings(self, setup: "DriveSetup", arm: SceneArm | None) -> Callable[[], FloatArray] | None:
        """A function that gives a `Step` the poses of the things in its context."""
        if self._followed is None or not self._needed:
            return setup.surroundings(arm)
        return self._followed.rows(self._needed, self._now_s)

    def update(self, record: StepRecord, q: FloatArray) -> bool:
        """Follow things, once a tick; whether others are held now. ``q``: (n,), newest joints, rad."""
        if self._followed is not None:
            tool = None if np.isnan(record.state[0]) else self._chain.forward(q)
            self._followed.update(tool, record.gripper, self._now_s())
            self._carried = self._followed.tracker.in_tool
        return self.held.update(self._carried, record.gripper)

    @property
    def unknown(self) -> Notice | None:
        """Why a model that looks at things must not be driven from the next tick on; None if it may be."""
        for name in () if self._followed is None else self._needed:
            where = self._where(name, self._now_s() + SOON_S)
            if not where.known:
                code = "thing_unseen" if where.pose is None else "thing_lost"
                return Notice(code=code, parameters={"thing": name})
        return None

    @property
    def moved(self) -> Notice | None:
        """The news that a thing which the model looks at is suddenly elsewhere; None for none."""
        jumped = () if self._followed is None else self._followed.tracker.jumped.intersection(self._needed)
        return Notice(code="thing_moved", parameters={"thing": min(jumped)}) if jumped else None

    def touch(self, thing: str, kind: TouchKind) -> bool:
        """Take a person's word about a thing, see `Surroundings.touch`."""
        return self._followed is not None and self._followed.touch(thing, kind, self._now_s())

    def begin(self) -> tuple[str, ...]:
        """The things that a recording which begins now holds: those that have been seen."""
        self._recorded = () if self._scene is None else self._take(self._now_s())
        return self._recorded

    def recorded(self, record: StepRecord) -> StepRecord:
        """The record of a step with their poses, and where these are from.

        A thing whose touch was taken back, so that nobody knows where it is, stays where it was.
        """
        if not self._recorded:
            return record
        now_s = self._now_s()
        self._take(now_s)
        rows = thing_rows({name: pose for name, (pose, _, _) in self._newest.items()}, self._recorded)
        newest = [self._newest[name] for name in self._recorded]
        sightings = np.array([(source, now_s - taken_s) for _, source, taken_s in newest])
        return replace(record, things=rows, sightings=sightings)

    def believed(self) -> Mapping[str, Pose] | None:
        """Latest poses of the tracked things; None while one has not been seen."""
        found = {name: where.pose for name, where in self._all()}
        return None if None in found.values() else {name: pose for name, pose in found.items() if pose}

    def look(self, tick: int) -> Things | None:
        """Where everything is; None in ticks without a look."""
        if self._scene is None or (self._arm is None and self._followed is None) or tick % _EVERY:
            return None
        begun = {thing.name: thing.pose for thing in self._scene.things}
        grains = {} if self._arm is None else self._arm.scene_state().grains
        seen = [
            SeenThing(name=name, seen=where.seen, age_s=int(where.age_s), source=where.source)
            for name, where in self._all()
        ]
        return things_at(self._scene, begun | self._poses(), grains, seen)

    def _take(self, now_s: float) -> tuple[str, ...]:
        """Keep where everything is; the names of the things that somebody knows the place of."""
        poses, told = self._poses(), dict(self._all())
        for name, pose in poses.items():
            where = told.get(name, Whereabouts("seen", source=SCENE))
            kind = where.source.partition(":")[0]
            source = self._sources.index(kind) if kind in self._sources else -1
            self._newest[name] = pose, source, now_s - where.age_s
        return tuple(poses)

    def _where(self, name: str, now_s: float) -> Whereabouts:
        return Whereabouts("unseen") if self._followed is None else self._followed.tracker.look(name, now_s)

    def _all(self) -> list[tuple[str, Whereabouts]]:
        names = () if self._followed is None else self._followed.tracker.names
        return [(name, self._where(name, self._now_s())) for name in names]

    def _poses(self) -> dict[str, Pose]:
        poses = dict[str, Pose]()
        if self._arm is not None:
            state = self._arm.scene_state()
            poses = dict(state.poses)
            self._carried = {name: within(state.tool, poses[name]) for name in state.stabbed | state.gripped}
        for name, where in self._all():
            poses.pop(name, None)
            if where.pose is not None:
                poses[name] = where.pose
        return poses
